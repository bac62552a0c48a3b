// The step to a new stop, told by the operator.
#pragma once

#include "ui/panels/odometry_page.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QToolButton;

namespace tiltmap::ui {

class Preferences;

// Distance and turn (straight ahead, then turned on the spot), or x, y and turn. The numbers are those of
// parseStep().
class TypedOdometryPage : public OdometryPage {
  Q_OBJECT

 public:
  explicit TypedOdometryPage(Preferences& preferences, QWidget* parent = nullptr);
  Result<Pose> step() const override;
  void stopCaptured() override;
  void setFirstStop(bool first) override { setEnabled(!first); }

 private:
  bool byDistance() const;
  void showKind();

  Preferences& preferences_;
  QComboBox* kind_;
  QLabel *right_label_, *right_unit_, *forward_label_;
  QLineEdit *right_, *forward_, *turn_;
};

// Each press adds to the step, in the frame of where the vehicle is by then.
class NudgedOdometryPage : public OdometryPage {
  Q_OBJECT

 public:
  explicit NudgedOdometryPage(QWidget* parent = nullptr);
  Result<Pose> step() const override;
  void stopCaptured() override;
  void setFirstStop(bool first) override { setEnabled(!first); }

 private:
  void nudge(const Pose& by);

  Pose step_;
  bool pressed_ = false;
  QToolButton* reset_;
};

}  // namespace tiltmap::ui
