// The next stop: where it is by odometry, and how it is to be swept.
#pragma once

#include <QWidget>
#include <optional>

#include "core/geometry/pose.h"
#include "ui/panels/panel.h"

class QLabel;

namespace tiltmap::ui {

class CaptureModel;
class OdometryForm;

class CaptureStopPage : public QWidget {
  Q_OBJECT

 public:
  CaptureStopPage(CaptureModel& model, const PanelContext& context, QWidget* parent = nullptr);

  // What start() is given; nothing where none is needed.
  std::optional<Pose> lastFromNext() const;
  // Why the next stop cannot begin yet; empty where it can.
  QString missing() const;

 Q_SIGNALS:
  void changed();

 private:
  void refresh();

  CaptureModel& model_;
  OdometryForm* odometry_;
  QLabel* own_;        // of drives that bring their own odometry
  QLabel* known_rig_;  // what it takes over from stops before
  int captured_ = 0;   // number of the last sweep that became a stop
};

}  // namespace tiltmap::ui
