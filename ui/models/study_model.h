// What lies inside a registration, for teaching: the kD-tree's search, and slices beside whole scans.
#pragma once

#include <QObject>
#include <memory>
#include <optional>
#include <vector>

#include "core/registration/slice_registration.h"
#include "core/scan/kd_tree_view.h"
#include "ui/models/background_worker.h"

namespace tiltmap::ui {

class StepperModel;

// Follows the stepper. No widgets.
class StudyModel : public QObject {
  Q_OBJECT

 public:
  // The one that belongs to the stepper, made when first asked for.
  static StudyModel& of(StepperModel& stepper);

  // The tree over the fixed scan's elements, searched from the picked pair's moving element, where the step's
  // pairs were found. Nothing before a step is taken.
  bool treeShown() const { return tree_shown_; }
  void setTreeShown(bool shown);
  int treeDepth() const { return tree_depth_; }  // of the cells shown
  void setTreeDepth(int depth);
  std::vector<KdCell> cells() const;
  const std::optional<KdVisit>& visit() const { return visit_; }
  const Eigen::Vector3d& query() const { return query_; }  // fixed scan's frame
  QString treeSentence() const;

  // Horizontal slices of both scans, matched in the plane from the stepper's start (thesis 4.1).
  const SliceSettings& sliceSettings() const { return slice_settings_; }
  void setSliceHeight(double height_m);
  void matchSlices();
  bool slicesBusy() const { return worker_.busy(); }
  const std::optional<SliceResult>& slices() const { return slices_; }
  // Against the stepper's result, or where it stands now.
  std::optional<SliceComparison> comparison() const;
  QString sliceSentence() const;

 Q_SIGNALS:
  void treeChanged();
  void slicesChanged();
  void failed(const tiltmap::Error& error);

 private:
  explicit StudyModel(StepperModel& stepper);
  const KdTree* tree() const;
  void search();
  void forget();

  StepperModel& stepper_;
  bool tree_shown_ = false;
  int tree_depth_ = 4;
  std::optional<KdVisit> visit_;
  Eigen::Vector3d query_ = Eigen::Vector3d::Zero();
  mutable PreparedScanPtr tree_of_;
  mutable std::shared_ptr<KdTree> own_tree_;  // where the method searches none
  SliceSettings slice_settings_;
  std::optional<SliceResult> slices_;
  BackgroundWorker worker_;
};

}  // namespace tiltmap::ui
