// The tilt by hand: jog, go to an angle, home, park; and the live line.
#pragma once

#include <QWidget>

class QDoubleSpinBox;
class QLabel;
class QPushButton;

namespace tiltmap::ui {

class CaptureModel;

class CaptureTiltPage : public QWidget {
  Q_OBJECT

 public:
  explicit CaptureTiltPage(CaptureModel& model, QWidget* parent = nullptr);

 private:
  QPushButton* button(const QString& name, const QString& text, const QString& accessible,
                      const QString& tip);
  void refresh();

  CaptureModel& model_;
  QLabel* angle_;
  QDoubleSpinBox* target_;
  QList<QPushButton*> moving_;  // what needs instruments
  QPushButton* live_;
};

}  // namespace tiltmap::ui
