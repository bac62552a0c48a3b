// The ICP stepper: which two scans, how, and one iteration after the other.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QComboBox;
class QLabel;
class QPushButton;
class QToolButton;

namespace tiltmap::ui {

class StepperModel;
class StepperTransport;

class StepperPanel : public QWidget {
  Q_OBJECT

 public:
  explicit StepperPanel(const PanelContext& context, QWidget* parent = nullptr);

 private:
  QWidget* buildChoice();
  QWidget* buildParameters();
  QWidget* buildDecision();
  void fillScans();
  void chooseFromBoxes();
  void refreshChoice();
  void refreshState();

  PanelContext context_;
  StepperModel& model_;
  QComboBox *fixed_, *moving_, *preset_;
  QToolButton* swap_;
  QLabel* roles_;
  QWidget* parameters_ = nullptr;
  StepperTransport* transport_ = nullptr;
  QPushButton *accept_, *discard_;
  QLabel* hint_;
};

}  // namespace tiltmap::ui
