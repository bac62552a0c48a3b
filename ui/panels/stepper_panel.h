// The ICP stepper: which two scans, how, and one iteration after the other.
#pragma once

#include <QWidget>
#include <map>

#include "ui/panels/panel.h"

class QComboBox;
class QGridLayout;
class QLabel;
class QPushButton;
class QSlider;
class QToolButton;

namespace tiltmap::ui {

class StepperModel;

class StepperPanel : public QWidget {
  Q_OBJECT

 public:
  explicit StepperPanel(const PanelContext& context, QWidget* parent = nullptr);

 private:
  QWidget* buildChoice();
  QWidget* buildParameters();
  QWidget* buildTransport();
  QWidget* buildNumbers();
  QWidget* buildMotion();
  QWidget* buildDecision();
  void addNumber(QGridLayout* grid, const QString& name, const QString& title, const QString& tip);
  void fillScans();
  void chooseFromBoxes();
  void refreshChoice();
  void refreshPosition();
  void refreshState();
  void showNumber(const QString& name, const QString& text);

  PanelContext context_;
  StepperModel& model_;
  QComboBox *fixed_, *moving_, *preset_;
  QToolButton* swap_;
  QLabel* roles_;
  QWidget* parameters_ = nullptr;
  QToolButton *first_, *back_, *step_, *last_;
  QPushButton* run_;
  QSlider* slider_;
  QLabel *iteration_, *state_, *attempt_;
  std::map<QString, QLabel*> numbers_;
  QLabel* motion_[3][4];
  QLabel* motion_text_;
  QPushButton *accept_, *discard_;
  QLabel* hint_;
};

}  // namespace tiltmap::ui
