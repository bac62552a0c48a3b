// Setting the start of a registration by hand: numbers, nudges, point pairs, headings.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QCheckBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace tiltmap::ui {

class StartModel;
class StepperModel;

class StepperStartBox : public QWidget {
  Q_OBJECT

 public:
  explicit StepperStartBox(const PanelContext& context, QWidget* parent = nullptr);

 private:
  QWidget* buildNumbers();
  QWidget* buildPoints();
  QWidget* buildSweep();
  void takeNumbers();
  void refreshStart();
  void refreshGhost();
  void refreshPoints();
  void refreshSweep();

  PanelContext context_;
  StepperModel& stepper_;
  StartModel& model_;
  QDoubleSpinBox *x_, *y_, *z_, *heading_;
  QPushButton* reset_;
  QCheckBox* ghost_;
  QLabel* ghost_text_;
  QTableWidget* points_;
  QLabel* points_text_;
  QPushButton *use_points_, *remove_point_, *sweep_, *use_sweep_;
  QLabel* sweep_text_;
  bool showing_ = false;
};

}  // namespace tiltmap::ui
