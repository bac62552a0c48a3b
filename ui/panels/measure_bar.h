// Distances between two points of the 3D view.
#pragma once

#include <QWidget>

#include <Eigen/Core>

#include "ui/models/preferences.h"

class QLabel;
class QToolButton;

namespace tiltmap::ui {

class Scene;

class MeasureBar : public QWidget {
  Q_OBJECT

 public:
  MeasureBar(Scene& scene, const Preferences& preferences, QWidget* parent = nullptr);

  void setActive(bool active);
  bool isActive() const { return active_; }
  // The first place, the second, then the first of another measurement.
  void take(const Eigen::Vector3d& place);
  void clear();
  QString reading() const;

 Q_SIGNALS:
  void changed();

 private:
  void refresh();

  Scene& scene_;
  const Preferences& preferences_;
  bool active_ = false;
  QLabel* reading_;
  QToolButton* copy_;
  QToolButton* clear_;
};

}  // namespace tiltmap::ui
