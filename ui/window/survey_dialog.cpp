#include "ui/window/survey_dialog.h"

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLineEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

QLineEdit* field(const QString& name, const QString& label, const QString& help, QWidget* parent) {
  auto* line = new QLineEdit(parent);
  line->setObjectName(name);
  line->setAccessibleName(label);
  line->setToolTip(help);
  return line;
}

}  // namespace

SurveyDialog::SurveyDialog(Workspace& workspace, QWidget* parent)
    : QDialog(parent),
      workspace_(workspace),
      site_(field("survey-site", "Site", "Where the survey was taken", this)),
      operator_(field("survey-operator", "Operator", "By whom", this)),
      device_(field("survey-device", "Device", "With which scanner", this)),
      date_(field("survey-date", "Date", "When; 2031-04-05 is understood everywhere", this)),
      store_(new QPushButton("Store", this)) {
  setObjectName("survey");
  setWindowTitle("Survey data");
  auto* form = new QFormLayout;
  form->setHorizontalSpacing(16);
  form->setVerticalSpacing(8);
  form->addRow("&Site", site_);
  form->addRow("&Operator", operator_);
  form->addRow("De&vice", device_);
  form->addRow("D&ate", date_);
  date_->setPlaceholderText("2031-04-05");
  store_->setObjectName("survey-store");
  store_->setToolTip("Store what is entered in the project; undo takes it back");
  store_->setDefault(true);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  buttons->addButton(store_, QDialogButtonBox::AcceptRole);
  buttons->button(QDialogButtonBox::Close)->setToolTip("Close this form; what was not stored is dropped");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(16);
  layout->addLayout(form);
  layout->addStretch();
  layout->addWidget(buttons);
  setMinimumWidth(420);

  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  connect(store_, &QPushButton::clicked, this, &SurveyDialog::store);
  connect(&workspace.jobs(), &JobQueue::busyChanged, this, &SurveyDialog::refresh);
  connect(&workspace.session(), &ProjectSession::closed, this, &QDialog::close);
  for (QLineEdit* line : {site_, operator_, device_, date_})
    connect(line, &QLineEdit::textChanged, this, &SurveyDialog::refresh);
  if (const SnapshotPtr snapshot = workspace.snapshot()) {
    const SurveyInfo& survey = snapshot->survey();
    site_->setText(qt(survey.site));
    operator_->setText(qt(survey.operator_name));
    device_->setText(qt(survey.device));
    date_->setText(qt(survey.date));
  }
  refresh();
}

SurveyInfo SurveyDialog::entered() const {
  SurveyInfo survey = workspace_.snapshot()->survey();
  survey.site = utf8(site_->text().trimmed());
  survey.operator_name = utf8(operator_->text().trimmed());
  survey.device = utf8(device_->text().trimmed());
  survey.date = utf8(date_->text().trimmed());
  return survey;
}

void SurveyDialog::refresh() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  store_->setEnabled(snapshot && workspace_.session().isWritable() && !workspace_.jobs().busy() &&
                     !(entered() == snapshot->survey()));
}

void SurveyDialog::store() {
  if (workspace_.session().apply(surveyEdit(entered()))) close();
}

}  // namespace tiltmap::ui
