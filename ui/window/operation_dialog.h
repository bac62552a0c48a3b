// The non-modal form of an operation: preset, parameters, Run.
#pragma once

#include <QDialog>

#include "core/project/operation.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;

namespace tiltmap::ui {

class ParameterForm;
class ParameterModel;
class Theme;
class Workspace;

// Begins with the values it was last started with. What the operation's check refuses is said in the form,
// and Run closes it only when the work has begun.
class OperationDialog : public QDialog {
  Q_OBJECT

 public:
  OperationDialog(const Operation& operation, Workspace& workspace, const Theme& theme,
                  QWidget* parent = nullptr);

  ParameterModel& model() { return *model_; }
  ParameterForm& form() { return *form_; }
  void setValues(const ParameterValues& values);
  void run();

 Q_SIGNALS:
  void proposalStarted();  // the result waits for a decision when it comes

 private:
  void refresh();
  void refreshCheck();

  const Operation& operation_;
  Workspace& workspace_;
  const Theme& theme_;
  ParameterModel* model_;
  ParameterForm* form_;
  QComboBox* preset_;
  QLabel* preset_help_;
  QLabel* check_;
  QPushButton* reset_;
  QPushButton* run_;
};

}  // namespace tiltmap::ui
