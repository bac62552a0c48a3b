// The 3D view's comparison of two stages: a divider that is drawn over the picture, or one after the other.
#pragma once

#include <QTimer>
#include <QWidget>

#include "core/project/project_snapshot.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;

namespace tiltmap::ui {

class Scene;

class CompareBar : public QWidget {
  Q_OBJECT

 public:
  explicit CompareBar(Scene& scene, QWidget* parent = nullptr);

  // What there is to compare the shown stage with.
  void setStages(const SnapshotPtr& snapshot, Stage shown);
  void setActive(bool active);
  // As if somebody had chosen so. A stage that there is no choice of is left out.
  void choose(Stage before, bool blink);

 Q_SIGNALS:
  void changed();       // draw again
  void sidesChanged();  // other stages are compared

 private:
  void apply();

  Scene& scene_;
  bool active_ = false;
  QComboBox* before_;
  QComboBox* how_;
  QDoubleSpinBox* period_;
  QLabel* hint_;
  QTimer blink_;
};

}  // namespace tiltmap::ui
