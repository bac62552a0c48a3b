// Site, operator, device and date of the survey.
#pragma once

#include <QDialog>

#include "core/project/project_snapshot.h"

class QLineEdit;
class QPushButton;

namespace tiltmap::ui {

class Workspace;

class SurveyDialog : public QDialog {
  Q_OBJECT

 public:
  explicit SurveyDialog(Workspace& workspace, QWidget* parent = nullptr);

 private:
  SurveyInfo entered() const;
  void refresh();
  void store();

  Workspace& workspace_;
  QLineEdit* site_;
  QLineEdit* operator_;
  QLineEdit* device_;
  QLineEdit* date_;
  QPushButton* store_;
};

}  // namespace tiltmap::ui
