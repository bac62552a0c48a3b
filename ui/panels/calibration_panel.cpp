#include "ui/panels/calibration_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QTabWidget>
#include <QVBoxLayout>

#include "ui/models/calibration_table_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/fold_box.h"
#include "ui/panels/table_view.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kErrors = "calibrate";
constexpr const char* kBody = "body-mask";

QPushButton* pushButton(QWidget* parent, const QString& name, const QString& text, const QString& tip) {
  auto* button = new QPushButton(text, parent);
  describe(button, name, text, tip);
  return button;
}

}  // namespace

CalibrationPage::CalibrationPage(const PanelContext& context, const std::string& operation,
                                 const QString& needs, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new CalibrationModel(context.workspace, operation, this)),
      rows_(new CalibrationTableModel(*model_, this)) {
  const QString prefix = qt(operation) + "-";
  auto* what = wrappedLabel(this, prefix + "needs");
  what->setText(needs);
  scans_ = new QLineEdit(this);
  describe(scans_, prefix + "scans", "Scans to take it from",
           "The scans to take it from, by their numbers, such as 0-13 or 0,2,7; empty for all");
  scans_->setPlaceholderText("all");
  auto* scans_label = new QLabel("Fr&om scans", this);
  scans_label->setBuddy(scans_);
  selected_ = pushButton(this, prefix + "selected", "Take the selected",
                         "The scans that are selected in the project tree or in the 3D view");
  run_ = pushButton(this, prefix + "run", "Find",
                    "Compute it from the scans; nothing is stored before it is applied");
  cancel_ = pushButton(this, prefix + "cancel", "Cancel", "Stop computing; the project stays as it is");
  progress_ = new QProgressBar(this);
  describe(progress_, prefix + "progress", "Progress", "How much of it is done");
  progress_->setRange(0, 1000);
  progress_->setMaximumHeight(fontMetrics().height() + 4);
  sentence_ = wrappedLabel(this, prefix + "sentence");
  summary_ = wrappedLabel(this, prefix + "summary");
  auto* form = new ParameterForm(model_->parameters(), context.workspace.preferences(), context.theme, this);
  form->setObjectName(prefix + "form");
  form->leaveOut(CalibrationModel::notAsked());
  auto* fold = new FoldBox("Parameters", prefix + "parameters", this);
  fold->content()->addWidget(form);
  table_ = new TableView(this);
  describe(table_, prefix + "table", "What was found",
           "What was found, with one standard deviation; Ctrl+C copies the selected rows");
  table_->setModel(rows_);
  table_->setWordWrap(true);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table_->horizontalHeader()->setSectionResizeMode(CalibrationTableModel::Reason, QHeaderView::Stretch);
  table_->verticalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table_->setMinimumHeight(fontMetrics().height() * 5);
  apply_ = pushButton(this, prefix + "apply", "Apply",
                      "Store it in the project, as the command line does with --apply; undo takes it back");
  discard_ = pushButton(this, prefix + "discard", "Discard", "Leave the project as it is");

  auto* choice = new QHBoxLayout;
  choice->setSpacing(8);
  choice->addWidget(scans_label);
  choice->addWidget(scans_, 1);
  choice->addWidget(selected_);
  auto* bar = new QHBoxLayout;
  bar->setSpacing(8);
  bar->addWidget(run_);
  bar->addWidget(cancel_);
  bar->addWidget(progress_, 1);
  bar->addWidget(apply_);
  bar->addWidget(discard_);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 8, 8, 8);
  column->setSpacing(8);
  column->addWidget(what);
  column->addLayout(choice);
  column->addLayout(bar);
  column->addWidget(sentence_);
  column->addWidget(fold);
  column->addWidget(table_, 1);
  column->addWidget(summary_);
  column->addStretch(0);
  // Parameters take the room of the table, which has nothing to show before they are set.
  connect(fold, &FoldBox::toggled, table_, [this](bool open) { table_->setVisible(!open); });
  connect(run_, &QPushButton::clicked, this, [this, fold] {
    fold->setOpen(false);
    model_->run();
  });
  connect(cancel_, &QPushButton::clicked, model_, &CalibrationModel::cancel);
  connect(apply_, &QPushButton::clicked, model_, &CalibrationModel::apply);
  connect(discard_, &QPushButton::clicked, model_, &CalibrationModel::discard);
  connect(scans_, &QLineEdit::textEdited, model_, &CalibrationModel::useScans);
  connect(scans_, &QLineEdit::returnPressed, run_, &QPushButton::click);
  connect(selected_, &QPushButton::clicked, model_, &CalibrationModel::useSelected);
  connect(model_, &CalibrationModel::changed, this, &CalibrationPage::refresh);
  setFocusProxy(run_);
  refresh();
}

void CalibrationPage::refresh() {
  const FindingState state = model_->state();
  const bool running = state == FindingState::Running, proposal = state == FindingState::Proposal;
  const QString why_not = model_->whyNotRun();
  run_->setEnabled(why_not.isEmpty());
  const bool free = !running && !proposal;
  scans_->setEnabled(free);
  if (!scans_->hasFocus() && scans_->text() != model_->scansText()) scans_->setText(model_->scansText());
  selected_->setEnabled(free && model_->canUseSelected());
  cancel_->setEnabled(running);
  progress_->setVisible(running);
  if (const JobStatus* job = model_->job(); running && job) {
    progress_->setRange(0, job->fraction < 0.0 ? 0 : 1000);
    progress_->setValue(static_cast<int>(1000.0 * std::max(0.0, job->fraction)));
  }
  apply_->setVisible(!running);
  discard_->setVisible(!running);
  apply_->setEnabled(proposal);
  discard_->setEnabled(proposal);
  QString text = model_->sentence();
  if (!why_not.isEmpty() && !running && !proposal) text = why_not;
  sentence_->setText(text);
  QString summary = model_->summary();
  for (const QString& warning : model_->warnings()) summary += (summary.isEmpty() ? "" : "\n") + warning;
  summary_->setText(summary);
  summary_->setVisible(!summary.isEmpty());
}

CalibrationPanel::CalibrationPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), tabs_(new QTabWidget(this)) {
  errors_ = new CalibrationPage(
      context, kErrors,
      "Needs three or more overlapping scans that have been registered, better ten with turns between them; "
      "finds tilt zero, lever arm, mounting and range offset together with the poses.",
      tabs_);
  body_ = new CalibrationPage(context, kBody,
                              "Needs scans of one sweep from several places; cells that are near and the "
                              "same in all of them show the "
                              "machine itself, and are left out of map and registration once applied.",
                              tabs_);
  tabs_->setObjectName("calibration-tabs");
  tabs_->setDocumentMode(true);
  tabs_->addTab(scrolled(errors_, "calibrate-page", tabs_), "&Scanner errors");
  tabs_->addTab(scrolled(body_, "body-mask-page", tabs_), "&Machine's body");
  tabs_->setTabToolTip(0, "Errors of the scanner itself, estimated from scans that overlap");
  tabs_->setTabToolTip(1, "Cells in which the scanner sees the machine that carries it");
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(tabs_);
  setFocusProxy(errors_);
}

void CalibrationPanel::showPage(const QString& operation) {
  tabs_->setCurrentIndex(operation == kBody ? 1 : 0);
}

}  // namespace tiltmap::ui
