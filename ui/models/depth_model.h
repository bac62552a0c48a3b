// The range matrix of the current scan and the pictures of it, read and computed in the background.
#pragma once

#include <QObject>
#include <QTimer>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/products/depth_image.h"
#include "core/project/project_snapshot.h"
#include "ui/models/background_worker.h"
#include "ui/models/residuals.h"
#include "ui/models/selection.h"

namespace tiltmap::ui {

class Workspace;

// Two sides, each with a quantity of the same scan. What is shown stays until what takes its place is there;
// all answers below are of what is shown.
class DepthModel : public QObject {
  Q_OBJECT

 public:
  explicit DepthModel(Workspace& workspace, QObject* parent = nullptr);

  // Nothing: the side is not looked at.
  void setQuantity(std::size_t side, std::optional<DepthQuantity> quantity);

  bool hasScan() const { return wanted_scan_.has_value(); }  // there is one to show, now or soon
  std::optional<ScanId> scan() const { return matrix_ ? std::optional(matrix_->scan) : std::nullopt; }
  std::size_t index() const;                  // of scan() in the survey
  bool hasCell(const CellPlace& cell) const;  // one of scan()
  std::shared_ptr<const DepthImage> image(std::size_t side) const { return sides_[side].image; }
  // Instead of an image: what is awaited, or why there is none.
  QString trouble(std::size_t side) const;
  // Row, column, angles, range, point, normal of a beam of scan().
  QString readout(const CellPlace& cell) const;
  // What the filter changed, or the residual's median, or that another scan is being read; empty else.
  QString summary() const;
  bool isReading() const { return worker_.busy(); }

 Q_SIGNALS:
  void scanChanged();    // scan() is another, or its matrix
  void imagesChanged();  // or troubles
  void wantedChanged();  // hasScan()

 private:
  struct Matrix {
    ScanId scan = 0;
    std::int64_t matrix = 0, geometry_id = 0;
    int lines = 0;  // it grows while it is captured
    ScannerGeometry geometry;
    RangeImagePtr image;
    std::vector<Eigen::Vector3d> points, normals;
  };
  struct Side {
    std::optional<DepthQuantity> wanted;
    std::shared_ptr<const DepthImage> image;
    ResidualsPtr residuals;  // that the image shows
    QString trouble;
  };
  struct Work;
  void refreshScan();
  void update();
  static void perform(Work& work, const std::stop_token& stop);
  void take(const Work& work);
  void clear();

  Workspace& workspace_;
  std::optional<ScanId> wanted_scan_;
  std::optional<ScanId> worked_on_;  // by the worker
  bool again_ = false;               // something changed while it works
  std::shared_ptr<const Matrix> matrix_;
  std::array<Side, 2> sides_;
  QTimer long_;  // fires when it takes more than a moment
  bool is_long_ = false;
  BackgroundWorker worker_;
};

}  // namespace tiltmap::ui
