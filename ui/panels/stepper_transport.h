// Forward, back, run, pause, any iteration; and in words where the registration stands.
#pragma once

#include <QWidget>

class QLabel;
class QPushButton;
class QSlider;
class QToolButton;

namespace tiltmap::ui {

class StepperModel;

class StepperTransport : public QWidget {
  Q_OBJECT

 public:
  explicit StepperTransport(StepperModel& model, QWidget* parent = nullptr);

 private:
  void refreshPosition();
  void refreshState();

  StepperModel& model_;
  QToolButton *first_, *back_, *step_, *last_;
  QPushButton* run_;
  QSlider* slider_;
  QLabel *iteration_, *state_, *attempt_;
};

}  // namespace tiltmap::ui
