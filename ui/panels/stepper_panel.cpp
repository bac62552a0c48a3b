#include "ui/panels/stepper_panel.h"

#include <QComboBox>
#include <QFontDatabase>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/fold_box.h"
#include "ui/panels/stepper_start_box.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::ui {

namespace {

void describe(QWidget* widget, const QString& name, const QString& accessible, const QString& tip) {
  widget->setObjectName(name);
  widget->setAccessibleName(accessible);
  widget->setToolTip(tip);
}

QLabel* wrapped(QWidget* parent, const QString& name) {
  auto* label = new QLabel(parent);
  label->setObjectName(name);
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  return label;
}

QToolButton* tool(QWidget* parent, const QString& name, const QString& image, const QString& text,
                  const QString& tip) {
  auto* button = new QToolButton(parent);
  describe(button, name, text, tip);
  button->setIcon(icon(image));
  button->setIconSize(QSize(20, 20));
  button->setFocusPolicy(Qt::StrongFocus);
  return button;
}

}  // namespace

StepperPanel::StepperPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), model_(context.workspace.stepper()) {
  auto* body = new QWidget(this);
  auto* column = new QVBoxLayout(body);
  column->setContentsMargins(8, 8, 8, 8);
  column->setSpacing(8);
  column->addWidget(buildChoice());
  column->addWidget(buildParameters());
  column->addWidget(new StepperStartBox(context, body));
  column->addWidget(buildTransport());
  column->addWidget(buildNumbers());
  column->addWidget(buildMotion());
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
  setFocusProxy(step_);

  connect(&context.workspace.session(), &ProjectSession::snapshotReplaced, this, &StepperPanel::fillScans);
  connect(&model_, &StepperModel::choiceChanged, this, &StepperPanel::refreshChoice);
  connect(&model_, &StepperModel::positionChanged, this, &StepperPanel::refreshPosition);
  connect(&model_, &StepperModel::stepsChanged, this, &StepperPanel::refreshPosition);
  connect(&model_, &StepperModel::stateChanged, this, &StepperPanel::refreshState);
  connect(&model_.parameters(), &ParameterModel::presetChanged, this, &StepperPanel::refreshChoice);
  connect(&context.theme, &Theme::changed, this, &StepperPanel::refreshChoice);
  fillScans();
  refreshPosition();
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
  swap_ = tool(box, "stepper-swap", "document-swap", "Swap the scans", "Let the other one move");
  connect(swap_, &QToolButton::clicked, &model_, &StepperModel::swapScans);
  roles_ = wrapped(box, "stepper-roles");
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

QWidget* StepperPanel::buildTransport() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(8);
  auto* row = new QHBoxLayout;
  row->setSpacing(4);
  first_ = tool(box, "stepper-first", "go-first", "To the start", "Back to the start (nothing is lost)");
  back_ = tool(box, "stepper-back", "go-previous", "Back", "One iteration back (Shift+F8)");
  step_ = tool(box, "stepper-step", "go-next", "Step", "One iteration forward (F8)");
  last_ = tool(box, "stepper-last", "go-last", "To the last", "Forward to the last iteration so far");
  run_ = new QPushButton("Run", box);
  describe(run_, "stepper-run", "Run", "Iterate to the end (F9)");
  for (QToolButton* button : {first_, back_, step_, last_}) {
    button->setMinimumSize(36, 32);
    row->addWidget(button);
  }
  row->addSpacing(4);
  row->addWidget(run_, 1);
  connect(first_, &QToolButton::clicked, this, [this] { model_.goTo(0); });
  connect(back_, &QToolButton::clicked, &model_, &StepperModel::back);
  connect(step_, &QToolButton::clicked, &model_, &StepperModel::step);
  connect(last_, &QToolButton::clicked, this, [this] { model_.goTo(model_.count()); });
  connect(run_, &QPushButton::clicked, this, [this] { model_.isRunning() ? model_.pause() : model_.run(); });
  slider_ = new QSlider(Qt::Horizontal, box);
  describe(slider_, "stepper-slider", "Iteration shown", "Any iteration computed so far; 0 is the start");
  slider_->setPageStep(5);
  connect(slider_, &QSlider::valueChanged, &model_, &StepperModel::goTo);
  iteration_ = new QLabel(box);
  iteration_->setObjectName("stepper-iteration");
  state_ = wrapped(box, "stepper-state");
  attempt_ = wrapped(box, "stepper-attempt");
  column->addLayout(row);
  column->addWidget(slider_);
  column->addWidget(iteration_);
  column->addWidget(state_);
  column->addWidget(attempt_);
  return box;
}

void StepperPanel::addNumber(QGridLayout* grid, const QString& name, const QString& title,
                             const QString& tip) {
  const int at = static_cast<int>(numbers_.size());
  auto* label = new QLabel(title, this);
  label->setToolTip(tip);
  auto* value = new QLabel(this);
  value->setObjectName("stepper-" + name);
  value->setAccessibleName(title);
  value->setToolTip(tip);
  value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  value->setTextInteractionFlags(Qt::TextSelectableByMouse);
  grid->addWidget(label, at, 0);
  grid->addWidget(value, at, 1);
  numbers_[name] = value;
}

QWidget* StepperPanel::buildNumbers() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(4);
  grid->setColumnStretch(1, 1);
  addNumber(grid, "rms", "RMS residual",
            "Root mean square of the kept pairs' residuals before the step, weighted by the loss");
  addNumber(grid, "change", "Change", "Of the mean squared residual against the step before");
  addNumber(grid, "pairs", "Pairs kept", "Pairs used for the motion, of all that were sought");
  addNumber(grid, "overlap", "Overlap", "Share of the moving scan in the common field that fits");
  addNumber(grid, "agreement", "Agreement", "Share of the kept pairs within three deviations");
  addNumber(grid, "elements", "Elements", "What is paired: points or plane patches of both scans");
  addNumber(grid, "step", "This step", "How far it moved and turned the moving scan");
  auto* scale = wrapped(box, "stepper-scale");
  scale->setToolTip("How far a residual may be off before the loss takes its weight");
  grid->addWidget(scale, static_cast<int>(numbers_.size()), 0, 1, 2);
  numbers_["scale"] = scale;
  return box;
}

QWidget* StepperPanel::buildMotion() {
  auto* fold = new FoldBox("Motion of this step", "stepper-motion", this, true);
  fold->setToolTip("Rotation (3 x 3) and translation (m) that the step applied, in the fixed scan's frame");
  auto* matrix = new QWidget(fold);
  auto* grid = new QGridLayout(matrix);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(2);
  QFont mono = QFontDatabase::systemFont(QFontDatabase::FixedFont);
  mono.setPointSizeF(font().pointSizeF() - 1.0);
  auto* rotation = new QLabel("Rotation R", matrix);
  auto* translation = new QLabel("t (m)", matrix);
  translation->setAlignment(Qt::AlignRight);
  grid->addWidget(rotation, 0, 0, 1, 3);
  grid->addWidget(translation, 0, 3);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) {
      auto* cell = new QLabel(matrix);
      cell->setObjectName(QString("stepper-motion-%1%2").arg(r).arg(c));
      cell->setFont(mono);
      cell->setAlignment(Qt::AlignRight);
      cell->setTextInteractionFlags(Qt::TextSelectableByMouse);
      grid->addWidget(cell, r + 1, c);
      motion_[r][c] = cell;
    }
  motion_text_ = wrapped(fold, "stepper-pose");
  fold->content()->addWidget(matrix);
  fold->content()->addWidget(motion_text_);
  return fold;
}

QWidget* StepperPanel::buildDecision() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(8, 4, 8, 8);
  column->setSpacing(4);
  hint_ = wrapped(box, "stepper-hint");
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

void StepperPanel::showNumber(const QString& name, const QString& text) {
  numbers_.at(name)->setText(text);
}

void StepperPanel::refreshPosition() {
  {
    const QSignalBlocker quiet(slider_);
    slider_->setRange(0, model_.count());
    slider_->setValue(model_.position());
  }
  const TraceStep* step = model_.current();
  iteration_->setText(step ? QString("Iteration %1 of %2").arg(model_.position()).arg(model_.count())
                           : QString("Start"));
  const bool several = model_.attempts().size() > 1;
  attempt_->setVisible(several);
  if (several && step)
    attempt_->setText(QString("Attempt %1 of %2. %3")
                          .arg(step->attempt + 1)
                          .arg(model_.attempts().size())
                          .arg(qt(attemptSentence(model_.attempt()->what))));
  else if (several)
    attempt_->setText(QString("%1 attempts in all.").arg(model_.attempts().size()));
  const Pose motion = step ? step->report.motion : Pose();
  const Eigen::Matrix3d rotation = motion.rotation();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) motion_[r][c]->setText(QString::number(rotation(r, c), 'f', 5));
    motion_[r][3]->setText(QString::number(motion.translation()[r], 'f', 4));
  }
  const Pose pose = model_.pose();
  const Eigen::Vector3d h = pose.heading();
  motion_text_->setText(
      QString("The moving scan now stands at x %1, y %2, z %3 m of the fixed one, turned %4°.")
          .arg(pose.translation().x(), 0, 'f', 3)
          .arg(pose.translation().y(), 0, 'f', 3)
          .arg(pose.translation().z(), 0, 'f', 3)
          .arg(std::atan2(-h.x(), h.y()) / kDegree, 0, 'f', 2));
  const QString none = "–";
  for (const auto& [name, label] : numbers_) label->setText(name == "scale" ? QString() : none);
  if (step) {
    const StepReport& report = step->report;
    const PoseDifference moved = difference(report.motion, Pose());
    const auto percent = [](double share) { return QString("%1 %").arg(100.0 * share, 0, 'f', 0); };
    showNumber("rms", smallLengthText(report.rms_m, context_.workspace.preferences().lengthUnit()));
    showNumber("change",
               report.iteration == 1 ? none : QString("%1 %").arg(100.0 * report.change, 0, 'f', 2));
    showNumber("pairs", QString("%1 of %2")
                            .arg(groupedNumber(static_cast<long long>(report.pairs)),
                                 groupedNumber(static_cast<long long>(step->pairs.size()))));
    showNumber("overlap", percent(report.overlap));
    showNumber("agreement", percent(report.agreement));
    const TraceAttempt& attempt = *model_.attempt();
    showNumber("elements", QString("%1 + %2 %3")
                               .arg(groupedNumber(static_cast<long long>(attempt.fixed->elements.size())),
                                    groupedNumber(static_cast<long long>(attempt.moving->elements.size())),
                                    attempt.moving->elements.arePatches() ? "plane patches" : "points"));
    showNumber("step", QString("%1, %2°")
                           .arg(smallLengthText(moved.translation_m, LengthUnit::Millimetre))
                           .arg(moved.rotation_rad / kDegree, 0, 'f', 4));
    showNumber("scale", "Loss scale: " + qt(lossSentence(attempt, report.loss)) + ".");
  }
  refreshState();
}

void StepperPanel::refreshState() {
  first_->setEnabled(model_.position() > 0);
  back_->setEnabled(model_.canGoBack());
  step_->setEnabled(model_.canStep());
  last_->setEnabled(model_.position() < model_.count());
  slider_->setEnabled(model_.count() > 0);
  run_->setEnabled(model_.isRunning() || model_.canStep());
  run_->setText(model_.isRunning() ? "Pause" : "Run");
  run_->setIcon(icon(model_.isRunning() ? "media-playback-pause" : "media-playback-start"));
  state_->setText(model_.isReady() ? model_.stateSentence() : QString());
  state_->setVisible(model_.isReady());
  accept_->setEnabled(model_.canAccept());
  accept_->setToolTip(model_.acceptHint());
  hint_->setText(model_.isEnded() ? model_.acceptHint() + "." : QString());
  hint_->setVisible(model_.isEnded());
  discard_->setEnabled(model_.count() > 0 || model_.isWorking());
}

}  // namespace tiltmap::ui
