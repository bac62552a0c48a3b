#include "ui/window/operation_dialog.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/look/theme.h"
#include "ui/models/parameter_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::ui {

namespace {

// Fewer are seen at a glance.
constexpr std::size_t kManyParameters = 10;

QString verb(const Operation& operation) {
  return qt(operation.title()).section(' ', 0, 0);
}

// Its result is looked at before it is stored: every scan may move, or change.
bool endsAsProposal(const Operation& operation) {
  return operation.id() == "relax" || operation.id() == "calibrate" || operation.id() == "body-mask";
}

// Where it says whether the result is stored, the one who looks at the proposal says so instead.
constexpr const char* kApply = "apply";
bool asksWhetherToApply(const Operation& operation) {
  return endsAsProposal(operation) && std::ranges::find(operation.parameters(), kApply,
                                                        &ParameterInfo::name) != operation.parameters().end();
}

}  // namespace

OperationDialog::OperationDialog(const Operation& operation, Workspace& workspace, const Theme& theme,
                                 QWidget* parent)
    : QDialog(parent),
      operation_(operation),
      workspace_(workspace),
      theme_(theme),
      model_(new ParameterModel(operation, this)),
      form_(nullptr),
      preset_(new QComboBox(this)),
      preset_help_(new QLabel(this)),
      check_(new QLabel(this)),
      reset_(new QPushButton("Reset all", this)),
      run_(new QPushButton(verb(operation), this)) {
  setObjectName("operation:" + qt(operation.id()));
  setWindowTitle(qt(operation.title()));
  setModal(false);
  model_->restore(workspace.preferences().lastParameters(qt(operation.id())));
  form_ = new ParameterForm(*model_, workspace.preferences(), theme, this);
  if (asksWhetherToApply(operation)) form_->leaveOut({kApply});

  auto* help = new QLabel(qt(operation.help()).remove('`'), this);
  help->setWordWrap(true);
  auto* top = new QHBoxLayout;
  top->setSpacing(8);
  auto* preset_label = new QLabel("&Preset", this);
  preset_label->setBuddy(preset_);
  preset_->setObjectName("preset");
  preset_->setAccessibleName("Preset");
  preset_->setToolTip("A set of values to begin with; choosing one sets every parameter");
  for (const ParameterPreset& preset : operation.presets()) {
    preset_->addItem(qt(preset.name));
    preset_->setItemData(preset_->count() - 1, qt(preset.help), Qt::ToolTipRole);
  }
  preset_help_->setWordWrap(true);
  top->addWidget(preset_label);
  top->addWidget(preset_);
  top->addWidget(preset_help_, 1);
  const bool presets = operation.presets().size() > 1;
  for (QWidget* widget : {static_cast<QWidget*>(preset_label), static_cast<QWidget*>(preset_),
                          static_cast<QWidget*>(preset_help_)})
    widget->setVisible(presets);

  auto* search = new QLineEdit(this);
  search->setObjectName("parameter-filter");
  search->setPlaceholderText("Show parameters with …");
  search->setAccessibleName("Filter of the parameters");
  search->setToolTip("Show only parameters whose name or help holds this text");
  search->setClearButtonEnabled(true);
  search->setVisible(operation.parameters().size() > kManyParameters);
  auto* scroll = new QScrollArea(this);
  scroll->setWidget(form_);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::StyledPanel);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setFocusPolicy(Qt::NoFocus);

  auto* proposal = new QLabel("The result is a proposal: nothing is stored before it is accepted.", this);
  proposal->setObjectName("proposal");
  proposal->setWordWrap(true);
  proposal->setVisible(endsAsProposal(operation));
  check_->setObjectName("check");
  check_->setWordWrap(true);
  reset_->setToolTip("Every parameter back to what the preset says");
  reset_->setAutoDefault(false);
  run_->setObjectName("run");
  run_->setDefault(true);
  run_->setToolTip(qt(operation.help()));
  auto* close = new QPushButton("Close", this);
  close->setToolTip("Close this form; nothing is run");
  close->setAutoDefault(false);
  auto* buttons = new QHBoxLayout;
  buttons->setSpacing(8);
  buttons->addWidget(reset_);
  buttons->addStretch();
  buttons->addWidget(close);
  buttons->addWidget(run_);

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(12, 12, 12, 12);
  layout->setSpacing(8);
  layout->addWidget(help);
  layout->addLayout(top);
  layout->addWidget(search);
  layout->addWidget(scroll, 1);
  layout->addWidget(proposal);
  layout->addWidget(check_);
  layout->addLayout(buttons);

  std::vector<QWidget*> order = form_->focusOrder();
  order.insert(order.begin(), {preset_, search});
  order.insert(order.end(), {reset_, close, run_});
  for (std::size_t k = 1; k < order.size(); ++k) setTabOrder(order[k - 1], order[k]);

  connect(preset_, qOverload<int>(&QComboBox::activated), this,
          [this](int row) { model_->setPreset(preset_->itemText(row)); });
  connect(search, &QLineEdit::textChanged, form_, &ParameterForm::filter);
  connect(reset_, &QPushButton::clicked, model_, &ParameterModel::resetAll);
  connect(close, &QPushButton::clicked, this, &QDialog::close);
  connect(run_, &QPushButton::clicked, this, &OperationDialog::run);
  connect(model_, &ParameterModel::valueChanged, this, &OperationDialog::refresh);
  connect(model_, &ParameterModel::presetChanged, this, &OperationDialog::refresh);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &OperationDialog::refresh);
  connect(&workspace.session(), &ProjectSession::closed, this, &QDialog::close);
  refresh();
  const int height = form_->sizeHint().height() + help->sizeHint().height() + 150;
  resize(520, std::min(height, 620));
}

void OperationDialog::setValues(const ParameterValues& values) {
  for (const auto& [name, value] : values) model_->setValue(qt(name), value);
}

void OperationDialog::refresh() {
  const int row = preset_->findText(model_->preset());
  preset_->setCurrentIndex(row);
  preset_help_->setText(preset_->itemData(row, Qt::ToolTipRole).toString());
  reset_->setEnabled(model_->changedCount() > 0);
  refreshCheck();
}

void OperationDialog::refreshCheck() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  ParameterValues values = model_->values();
  if (asksWhetherToApply(operation_)) values[kApply] = true;
  QString problem;
  if (model_->hasErrors()) {
    problem = "Some values are not allowed: see above.";
  } else if (!snapshot) {
    problem = "No project is open.";
  } else if (const Status status = operation_.check(*snapshot, values); !status) {
    problem = qt(status.error().what) + ": " + qt(status.error().remedy) + ".";
    problem[0] = problem[0].toUpper();
  }
  check_->setText(problem);
  check_->setVisible(!problem.isEmpty());
  run_->setEnabled(problem.isEmpty());
}

void OperationDialog::run() {
  if (!run_->isEnabled()) return;
  JobRequest request;
  request.operation = &operation_;
  request.preset = model_->preset();
  request.values = model_->changes();
  if (asksWhetherToApply(operation_)) request.values[kApply] = true;
  request.ask = endsAsProposal(operation_);
  workspace_.preferences().setLastParameters(qt(operation_.id()), model_->last());
  if (!workspace_.start(request)) return;
  if (request.ask) Q_EMIT proposalStarted();
  close();
}

}  // namespace tiltmap::ui
