// What the iteration shown found and did: residual, pairs, overlap, its motion as matrix and vector, and
// in the end whether the result can be trusted.
#pragma once

#include <QWidget>
#include <map>

#include "ui/panels/panel.h"

class QGridLayout;
class QLabel;

namespace tiltmap::ui {

class StepperModel;

class StepperFigures : public QWidget {
  Q_OBJECT

 public:
  explicit StepperFigures(const PanelContext& context, QWidget* parent = nullptr);

 private:
  QWidget* buildNumbers();
  QWidget* buildMotion();
  QWidget* buildJudgement();
  void refreshJudgement();
  void addNumber(QGridLayout* grid, const QString& name, const QString& title, const QString& tip);
  void showNumber(const QString& name, const QString& text);
  void refresh();

  PanelContext context_;
  StepperModel& model_;
  std::map<QString, QLabel*> numbers_;
  QLabel* motion_[3][4];
  QLabel* motion_text_;
  QLabel* verdict_;
  QLabel* judgement_;
};

}  // namespace tiltmap::ui
