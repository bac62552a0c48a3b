// The relaxation job runner: start, watch, pause, cancel, compare, decide.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QComboBox;
class QFrame;
class QLabel;
class QPlainTextEdit;
class QProgressBar;
class QPushButton;
class QTabWidget;
class QToolButton;

namespace tiltmap::ui {

class JobListModel;
class MovementPlot;
class RelaxationModel;
class RelaxationTableModel;
class TableView;

class RelaxationPanel : public QWidget {
  Q_OBJECT

 public:
  explicit RelaxationPanel(const PanelContext& context, QWidget* parent = nullptr);

  RelaxationTableModel& model() const { return *model_; }
  TableView* table() const { return table_; }
  MovementPlot& plot() const { return *plot_; }
  // With the parameters that a relaxation was last started with, under the preset that is chosen here.
  void run();

 private:
  QWidget* makeBar();
  QWidget* makeDecision();
  QWidget* makeScans();
  QWidget* makeJobs();
  QWidget* makeLog();
  void refresh();
  void refreshJobs();
  void takeSelection();
  void showSelection();

  PanelContext context_;
  RelaxationModel& relaxation_;
  RelaxationTableModel* model_;
  JobListModel* jobs_model_;
  QComboBox* preset_ = nullptr;
  QPushButton* run_ = nullptr;
  QToolButton* pause_ = nullptr;
  QToolButton* step_ = nullptr;
  QToolButton* cancel_ = nullptr;
  QLabel* state_ = nullptr;
  QLabel* doing_ = nullptr;
  QProgressBar* progress_ = nullptr;
  QFrame* decision_ = nullptr;
  QLabel* decision_text_ = nullptr;
  QToolButton* before_ = nullptr;
  QToolButton* after_ = nullptr;
  QToolButton* wipe_ = nullptr;
  QToolButton* blink_ = nullptr;
  QTabWidget* tabs_ = nullptr;
  QLabel* summary_ = nullptr;
  TableView* table_ = nullptr;
  MovementPlot* plot_ = nullptr;
  TableView* jobs_ = nullptr;
  QToolButton* job_cancel_ = nullptr;
  QPlainTextEdit* log_ = nullptr;
  bool following_ = false;
};

}  // namespace tiltmap::ui
