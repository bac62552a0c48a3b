// Horizontal slices of two scans matched in the plane, beside what the whole scans give.
#pragma once

#include "ui/panels/stepper_plots.h"

class QDoubleSpinBox;
class QLabel;
class QPushButton;

namespace tiltmap::ui {

class StudyModel;

class SlicePlot : public StepperPlot {
  Q_OBJECT

 public:
  explicit SlicePlot(const PanelContext& context, QWidget* parent = nullptr);

 protected:
  void refresh() override;

 private:
  StudyModel& study_;
  int fixed_, by_scan_, by_slice_;
};

class SlicesTab : public QWidget {
  Q_OBJECT

 public:
  explicit SlicesTab(const PanelContext& context, QWidget* parent = nullptr);

 private:
  void refresh();

  StepperModel& stepper_;
  StudyModel& study_;
  QDoubleSpinBox* height_;
  QPushButton* match_;
  QLabel* text_;
};

}  // namespace tiltmap::ui
