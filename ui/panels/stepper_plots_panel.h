// Plots and table of the stepper, under tabs.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QTabWidget;

namespace tiltmap::ui {

class StepperModel;
class StepTableModel;
class TableView;

class StepperPlotsPanel : public QWidget {
  Q_OBJECT

 public:
  explicit StepperPlotsPanel(const PanelContext& context, QWidget* parent = nullptr);

 private:
  void showPosition();

  StepperModel& model_;
  StepTableModel* rows_;
  TableView* table_;
  QTabWidget* tabs_;
};

}  // namespace tiltmap::ui
