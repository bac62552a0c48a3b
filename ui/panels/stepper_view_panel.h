// The two scans of the stepper in 3D, with their pairs.
#pragma once

#include <QWidget>
#include <map>
#include <memory>
#include <set>

#include "ui/models/background_worker.h"
#include "ui/panels/panel.h"
#include "ui/scene/registration_layer.h"
#include "ui/scene/scene.h"

class QCheckBox;
class QImage;
class QLabel;
class QStackedLayout;
class QSpinBox;
class QToolButton;

namespace tiltmap::ui {

class StepperModel;
class StudyModel;
class StepperSceneWidget;

class StepperViewPanel : public QWidget {
  Q_OBJECT

 public:
  explicit StepperViewPanel(const PanelContext& context, QWidget* parent = nullptr);
  ~StepperViewPanel() override;

  Scene& scene() { return *scene_; }
  RegistrationLayer& layer() { return *layer_; }
  QWidget* view() const;
  QImage picture();

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  QWidget* buildBar();
  QWidget* buildLegend();
  void loadScans();
  void showStep();
  void showGhost();
  void showMarks();
  void showPicked();
  void showTree();
  void applyTheme();
  void paintLegend();
  void clicked(const QPointF& place);
  std::set<RejectReason> shownFates() const;

  PanelContext context_;
  StepperModel& model_;
  StudyModel& study_;
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<RegistrationLayer> layer_;
  StepperSceneWidget* view_;
  QWidget* empty_;
  QStackedLayout* pages_;
  QLabel *title_, *sentence_;
  QToolButton *points_, *patches_, *found_, *tree_, *adjust_, *pick_points_;
  QSpinBox* depth_;
  std::map<RejectReason, QCheckBox*> fates_;
  const void* loaded_ = nullptr;  // the scans whose points are drawn
  BackgroundWorker loader_;
};

}  // namespace tiltmap::ui
