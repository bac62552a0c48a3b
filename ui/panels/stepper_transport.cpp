#include "ui/panels/stepper_transport.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/models/stepper_model.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

StepperTransport::StepperTransport(StepperModel& model, QWidget* parent) : QWidget(parent), model_(model) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(8);
  auto* row = new QHBoxLayout;
  row->setSpacing(4);
  first_ =
      iconButton(this, "stepper-first", "go-first", "To the start", "Back to the start (nothing is lost)");
  back_ = iconButton(this, "stepper-back", "go-previous", "Back", "One iteration back (Shift+F8)");
  step_ = iconButton(this, "stepper-step", "go-next", "Step", "One iteration forward (F8)");
  last_ = iconButton(this, "stepper-last", "go-last", "To the last", "Forward to the last iteration so far");
  run_ = new QPushButton("Run", this);
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
  slider_ = new QSlider(Qt::Horizontal, this);
  describe(slider_, "stepper-slider", "Iteration shown", "Any iteration computed so far; 0 is the start");
  slider_->setPageStep(5);
  connect(slider_, &QSlider::valueChanged, &model_, &StepperModel::goTo);
  iteration_ = new QLabel(this);
  iteration_->setObjectName("stepper-iteration");
  state_ = wrappedLabel(this, "stepper-state");
  attempt_ = wrappedLabel(this, "stepper-attempt");
  column->addLayout(row);
  column->addWidget(slider_);
  column->addWidget(iteration_);
  column->addWidget(state_);
  column->addWidget(attempt_);
  setFocusProxy(step_);
  connect(&model_, &StepperModel::choiceChanged, this, &StepperTransport::refreshState);
  connect(&model_, &StepperModel::positionChanged, this, &StepperTransport::refreshPosition);
  connect(&model_, &StepperModel::stepsChanged, this, &StepperTransport::refreshPosition);
  connect(&model_, &StepperModel::stateChanged, this, &StepperTransport::refreshState);
  refreshPosition();
}

void StepperTransport::refreshPosition() {
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
  refreshState();
}

void StepperTransport::refreshState() {
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
}

}  // namespace tiltmap::ui
