#include "ui/panels/stepper_panel.h"

#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/fold_box.h"
#include "ui/panels/stepper_figures.h"
#include "ui/panels/stepper_start_box.h"
#include "ui/panels/stepper_transport.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::ui {

StepperPanel::StepperPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), model_(context.workspace.stepper()) {
  auto* body = new QWidget(this);
  auto* column = new QVBoxLayout(body);
  column->setContentsMargins(8, 8, 8, 8);
  column->setSpacing(8);
  column->addWidget(buildChoice());
  column->addWidget(buildParameters());
  column->addWidget(new StepperStartBox(context, body));
  transport_ = new StepperTransport(model_, body);
  column->addWidget(transport_);
  column->addWidget(new StepperFigures(context, body));
  column->addStretch(1);
  auto* scroll = new QScrollArea(this);
  scroll->setObjectName("stepper-scroll");
  scroll->setWidget(body);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setFocusPolicy(Qt::NoFocus);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setMinimumWidth(280);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(scroll, 1);
  layout->addWidget(buildDecision());
  setFocusProxy(transport_);

  connect(&context.workspace.session(), &ProjectSession::snapshotReplaced, this, &StepperPanel::fillScans);
  connect(&model_, &StepperModel::choiceChanged, this, &StepperPanel::refreshChoice);
  connect(&model_, &StepperModel::stateChanged, this, &StepperPanel::refreshState);
  connect(&model_.parameters(), &ParameterModel::presetChanged, this, &StepperPanel::refreshChoice);
  connect(&context.theme, &Theme::changed, this, &StepperPanel::refreshChoice);
  fillScans();
}

QWidget* StepperPanel::buildChoice() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(8);
  grid->setColumnStretch(1, 1);
  fixed_ = new QComboBox(box);
  describe(fixed_, "stepper-fixed", "Fixed scan", "The fixed scan: it stays where it is");
  moving_ = new QComboBox(box);
  describe(moving_, "stepper-moving", "Moving scan", "The moving scan: it comes to the fixed one");
  for (QComboBox* combo : {fixed_, moving_}) {
    combo->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    combo->setMinimumContentsLength(8);
    connect(combo, qOverload<int>(&QComboBox::activated), this, &StepperPanel::chooseFromBoxes);
  }
  swap_ = iconButton(box, "stepper-swap", "document-swap", "Swap the scans", "Let the other one move");
  connect(swap_, &QToolButton::clicked, &model_, &StepperModel::swapScans);
  roles_ = wrappedLabel(box, "stepper-roles");
  auto* fixed_label = new QLabel("Fi&xed", box);
  fixed_label->setBuddy(fixed_);
  auto* moving_label = new QLabel("&Moving", box);
  moving_label->setBuddy(moving_);
  grid->addWidget(fixed_label, 0, 0);
  grid->addWidget(fixed_, 0, 1);
  grid->addWidget(moving_label, 1, 0);
  grid->addWidget(moving_, 1, 1);
  grid->addWidget(swap_, 0, 2, 2, 1, Qt::AlignVCenter);
  grid->addWidget(roles_, 2, 0, 1, 3);
  return box;
}

QWidget* StepperPanel::buildParameters() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(8);
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  preset_ = new QComboBox(box);
  describe(preset_, "stepper-preset", "Preset",
           "A set of parameters to begin with; choosing one starts over");
  ParameterModel& parameters = model_.parameters();
  for (const ParameterPreset& preset : parameters.operation().presets()) {
    preset_->addItem(qt(preset.name));
    preset_->setItemData(preset_->count() - 1, qt(preset.help), Qt::ToolTipRole);
  }
  connect(preset_, qOverload<int>(&QComboBox::activated), this,
          [this](int index) { model_.parameters().setPreset(preset_->itemText(index)); });
  auto* label = new QLabel("&Preset", box);
  label->setBuddy(preset_);
  row->addWidget(label);
  row->addWidget(preset_, 1);
  column->addLayout(row);

  auto* fold = new FoldBox("Parameters", "stepper-parameters", box);
  fold->setToolTip("All parameters of the registration; changing one starts over");
  auto* search = new QLineEdit(fold);
  describe(search, "stepper-parameter-filter", "Filter of the parameters",
           "Show only parameters whose name or help holds this text");
  search->setPlaceholderText("Show parameters with …");
  search->setClearButtonEnabled(true);
  auto* form = new ParameterForm(parameters, context_.workspace.preferences(), context_.theme, fold);
  form->leaveOut({"pairs", "threads"});
  connect(search, &QLineEdit::textChanged, form, &ParameterForm::filter);
  auto* scroll = new QScrollArea(fold);
  scroll->setWidget(form);
  scroll->setWidgetResizable(true);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setMinimumHeight(220);
  scroll->setFocusPolicy(Qt::NoFocus);
  auto* reset = new QPushButton("Reset all", fold);
  describe(reset, "stepper-parameters-reset", "Reset all parameters",
           "Every parameter back to what the preset says");
  connect(reset, &QPushButton::clicked, &parameters, &ParameterModel::resetAll);
  fold->content()->addWidget(search);
  fold->content()->addWidget(scroll);
  fold->content()->addWidget(reset, 0, Qt::AlignLeft);
  column->addWidget(fold);
  return box;
}

QWidget* StepperPanel::buildDecision() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(8, 4, 8, 8);
  column->setSpacing(4);
  hint_ = wrappedLabel(box, "stepper-hint");
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  accept_ = new QPushButton("Accept", box);
  accept_->setObjectName("stepper-accept");
  accept_->setAccessibleName("Accept the result");
  discard_ = new QPushButton("Discard", box);
  describe(discard_, "stepper-discard", "Discard the iterations",
           "Throw the iterations away; the project is not touched");
  row->addWidget(accept_, 1);
  row->addWidget(discard_, 1);
  connect(accept_, &QPushButton::clicked, this, [this] {
    const QString link = QString("Accepted: %1 on %2.").arg(model_.scanName(false), model_.scanName(true));
    if (model_.accept()) context_.workspace.messages().note(link);
  });
  connect(discard_, &QPushButton::clicked, &model_, &StepperModel::discard);
  column->addWidget(hint_);
  column->addLayout(row);
  return box;
}

void StepperPanel::fillScans() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  for (QComboBox* combo : {fixed_, moving_}) {
    const QSignalBlocker quiet(combo);
    combo->clear();
    if (!snapshot) continue;
    for (std::size_t i = 0; i < snapshot->scans().size(); ++i)
      combo->addItem(QString("%1 · %2").arg(i).arg(qt(snapshot->scans()[i].name)),
                     static_cast<qlonglong>(snapshot->scans()[i].id));
  }
  refreshChoice();
}

void StepperPanel::chooseFromBoxes() {
  const auto id = [](const QComboBox* combo) -> std::optional<ScanId> {
    if (combo->currentIndex() < 0) return {};
    return combo->currentData().toLongLong();
  };
  model_.choose(id(fixed_), id(moving_));
}

void StepperPanel::refreshChoice() {
  const auto select = [](QComboBox* combo, std::optional<ScanId> id) {
    const QSignalBlocker quiet(combo);
    combo->setCurrentIndex(id ? combo->findData(static_cast<qlonglong>(*id)) : -1);
  };
  select(fixed_, model_.fixed());
  select(moving_, model_.moving());
  const QSignalBlocker quiet(preset_);
  preset_->setCurrentIndex(preset_->findText(model_.parameters().preset()));
  QString roles = model_.problem();
  if (roles.isEmpty())
    roles = QString("The moving %1 (orange) comes to the fixed %2 (grey), which stays.")
                .arg(model_.scanName(false), model_.scanName(true));
  roles_->setText(roles);
  const bool any = fixed_->count() > 0;
  for (QWidget* widget :
       {static_cast<QWidget*>(fixed_), static_cast<QWidget*>(moving_), static_cast<QWidget*>(swap_)})
    widget->setEnabled(any);
  refreshState();
}

void StepperPanel::refreshState() {
  accept_->setEnabled(model_.canAccept());
  accept_->setToolTip(model_.acceptHint());
  hint_->setText(model_.isEnded() ? model_.acceptHint() + "." : QString());
  hint_->setVisible(model_.isEnded());
  discard_->setEnabled(model_.count() > 0 || model_.isWorking());
}

}  // namespace tiltmap::ui
