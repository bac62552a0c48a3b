// What the scans tell about their scanner: its own errors, and where the machine stands in its view.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QTabWidget;

namespace tiltmap::ui {

class CalibrationModel;
class CalibrationTableModel;
class TableView;

// One of the two: what it needs, its parameters, Run and Cancel, what was found, Apply and Discard.
class CalibrationPage : public QWidget {
  Q_OBJECT

 public:
  // `needs`: one sentence.
  CalibrationPage(const PanelContext& context, const std::string& operation, const QString& needs,
                  QWidget* parent = nullptr);

  CalibrationModel& model() { return *model_; }
  TableView* table() const { return table_; }

 private:
  void refresh();

  PanelContext context_;
  CalibrationModel* model_;
  CalibrationTableModel* rows_;
  QLineEdit* scans_;
  QPushButton *selected_, *run_;
  QPushButton* cancel_;
  QProgressBar* progress_;
  QLabel *sentence_, *summary_;
  TableView* table_;
  QPushButton *apply_, *discard_;
};

class CalibrationPanel : public QWidget {
  Q_OBJECT

 public:
  explicit CalibrationPanel(const PanelContext& context, QWidget* parent = nullptr);

  CalibrationPage& errors() { return *errors_; }
  CalibrationPage& body() { return *body_; }
  // "calibrate" or "body-mask": its page comes to the front.
  void showPage(const QString& operation);

 private:
  QTabWidget* tabs_;
  CalibrationPage *errors_, *body_;
};

}  // namespace tiltmap::ui
