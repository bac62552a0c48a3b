#include "ui/models/stepper_model.h"

#include <algorithm>

#include "core/project/operations/pair_links.h"
#include "ui/models/project_session.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr int kPace_ms = 60;
const char* const kPreferences = "stepper";

// The operation's own parameters, which the registration of one pair does not have.
const char* const kNotOfOnePair[] = {"pairs", "threads"};

}  // namespace

StepperModel::StepperModel(ProjectSession& session, Preferences& preferences, QObject* parent)
    : QObject(parent),
      session_(session),
      preferences_(preferences),
      parameters_(*operations().find("register")),
      trace_(std::make_shared<std::optional<RegistrationTrace>>()) {
  parameters_.restore(preferences.lastParameters(kPreferences));
  pace_.setSingleShot(true);
  pace_.setInterval(kPace_ms);
  connect(&pace_, &QTimer::timeout, this, &StepperModel::tick);
  connect(&parameters_, &ParameterModel::valueChanged, this, &StepperModel::parametersChanged);
  connect(&parameters_, &ParameterModel::presetChanged, this, &StepperModel::parametersChanged);
  connect(&start_, &StartModel::startChanged, this, &StepperModel::startOver);
  connect(&start_, &StartModel::failed, this, &StepperModel::failed);
  connect(&session, &ProjectSession::closed, this, [this] { choose({}, {}); });
  connect(&session, &ProjectSession::snapshotReplaced, this, [this] {
    refreshScans();
    Q_EMIT stateChanged();
  });
  refreshProblem();
}

void StepperModel::choose(std::optional<ScanId> fixed, std::optional<ScanId> moving) {
  if (fixed == fixed_ && moving == moving_) return;
  fixed_ = fixed;
  moving_ = moving;
  identity_.clear();
  refreshScans();
}

QString StepperModel::scanName(bool of_fixed) const {
  const SnapshotPtr snapshot = session_.snapshot();
  const auto id = of_fixed ? fixed_ : moving_;
  if (!snapshot || !id) return {};
  const ScanEntry* scan = snapshot->find(*id);
  if (!scan) return {};
  return QString("scan %1 (%2)").arg(*snapshot->indexOf(*id)).arg(qt(scan->name));
}

std::optional<RegistrationSettings> StepperModel::settings(QString* problem) const {
  if (parameters_.hasErrors()) {
    *problem = "Some parameters are not allowed: see the form.";
    return {};
  }
  ParameterValues values = parameters_.values();
  for (const char* name : kNotOfOnePair) values.erase(name);
  RegistrationSettings settings;
  Status status = registrationParameters().apply(values, settings);
  if (status) status = checkSettings(settings);
  if (status) return settings;
  *problem = qt(status.error().what) + ": " + qt(status.error().remedy) + ".";
  (*problem)[0] = problem->at(0).toUpper();
  return {};
}

void StepperModel::parametersChanged() {
  preferences_.setLastParameters(kPreferences, parameters_.last());
  identity_.clear();
  refreshScans();
}

// Takes the two scans from the snapshot where they are not those it had.
void StepperModel::refreshScans() {
  const SnapshotPtr snapshot = session_.snapshot();
  const auto gone = [&](std::optional<ScanId>& id) {
    if (id && (!snapshot || !snapshot->find(*id))) id.reset();
  };
  gone(fixed_);
  gone(moving_);
  // Something to begin with.
  if (snapshot && !fixed_ && !moving_ && snapshot->scans().size() >= 2) {
    fixed_ = snapshot->scans()[0].id;
    moving_ = snapshot->scans()[1].id;
  }
  QString problem;
  const auto chosen = settings(&problem);
  const ScanEntry* fixed = fixed_ ? snapshot->find(*fixed_) : nullptr;
  const ScanEntry* moving = moving_ ? snapshot->find(*moving_) : nullptr;
  if (!fixed || !moving || fixed == moving || !chosen) {
    identity_.clear();
    if (scans_) {
      scans_.reset();
      start_.setScans(nullptr, Pose(), false);
    }
    refreshProblem();
    return;
  }
  const Pose odometry = odometryStart(*fixed, *moving);
  const std::vector<std::int64_t> identity = {fixed->id,  fixed->matrix,  fixed->geometry_id,  fixed->lines,
                                              moving->id, moving->matrix, moving->geometry_id, moving->lines};
  const bool same_pair = scans_ && scans_->fixed().id == fixed->id && scans_->moving().id == moving->id;
  if (identity != identity_ || !(odometry == odometry_)) {
    identity_ = identity;
    odometry_ = odometry;
    scans_ = std::make_shared<PreparedPair>(*fixed, *moving, *chosen);
    start_.setScans(scans_, odometry, same_pair);
  }
  refreshProblem();
}

void StepperModel::refreshProblem() {
  problem_.clear();
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot)
    problem_ = "No project is open.";
  else if (snapshot->scans().size() < 2)
    problem_ = "Stepping needs two scans: import, simulate or capture more.";
  else if (!fixed_ || !moving_)
    problem_ = "Choose the scan that stays and the one that comes to it.";
  else if (fixed_ == moving_)
    problem_ = "A scan cannot be registered to itself: choose another.";
  else
    (void)settings(&problem_);
  Q_EMIT choiceChanged();
}

void StepperModel::startOver() {
  worker_.cancel();
  pace_.stop();
  trace_ = std::make_shared<std::optional<RegistrationTrace>>();
  steps_.clear();
  attempts_.clear();
  result_.reset();
  judgement_.reset();
  chosen_.reset();
  running_ = false;
  wanted_ = 0;
  setPosition(0);
  Q_EMIT stepsChanged();
  Q_EMIT stateChanged();
}

void StepperModel::setPosition(int position) {
  position_ = position;
  picked_.reset();
  const TraceStep* step = current();
  pairs_ = step ? tracedPairs(*attempt(), *step) : std::vector<TracedPair>();
  Q_EMIT positionChanged();
}

void StepperModel::goTo(int position) {
  position = std::clamp(position, 0, count());
  if (position == position_) return;
  pause();
  setPosition(position);
  Q_EMIT stateChanged();
}

void StepperModel::back() {
  goTo(position_ - 1);
}

void StepperModel::step() {
  if (!canStep()) return;
  if (position_ < count()) {
    setPosition(position_ + 1);
    Q_EMIT stateChanged();
  } else if (worker_.busy()) {
    ++wanted_;
  } else {
    compute();
  }
}

void StepperModel::run() {
  if (running_ || !canStep()) return;
  running_ = true;
  Q_EMIT stateChanged();
  tick();
}

void StepperModel::pause() {
  wanted_ = 0;
  pace_.stop();
  if (!running_) return;
  running_ = false;
  Q_EMIT stateChanged();
}

void StepperModel::tick() {
  if (!running_) return;
  if (!canStep()) return pause();
  const bool kept = position_ < count();
  if (kept || !worker_.busy()) step();
  if (kept) pace_.start();  // else the end of the computation starts it
}

void StepperModel::compute() {
  if (steps_.empty()) started_ = utcNow();
  worker_.start([this, trace = trace_, scans = scans_, start = start_.start()](const std::stop_token&) {
    BackgroundWorker::Done done;
    if (!*trace) {
      const auto prepared = scans->get();
      auto begun = prepared
                       ? RegistrationTrace::begin(prepared->fixed, prepared->moving, start, scans->settings())
                       : Result<RegistrationTrace>(fail(prepared.error()));
      if (!begun) {
        done = [this, error = begun.error()] {
          pause();
          Q_EMIT failed(error);
          Q_EMIT stateChanged();
        };
        return done;
      }
      trace->emplace(std::move(*begun));
    }
    const TraceStepPtr step = (*trace)->step();
    std::shared_ptr<const PairJudgement> judgement;
    if (const auto prepared = scans->get(); prepared && (*trace)->done())
      judgement = std::make_shared<const PairJudgement>(judgePair(
          *judgedScan(prepared->fixed), *judgedScan(prepared->moving), claimOf((*trace)->result(), start)));
    // The worker is idle when this runs, so that the trace may be read.
    done = [this, trace, step, judgement] { take(step, **trace, judgement); };
    return done;
  });
  Q_EMIT stateChanged();
}

void StepperModel::take(const TraceStepPtr& step, const RegistrationTrace& trace,
                        std::shared_ptr<const PairJudgement> judgement) {
  const bool following = position_ == count();
  steps_.push_back(step);
  attempts_ = trace.attempts();
  chosen_ = trace.chosenAttempt();
  if (trace.done()) result_ = trace.result();
  judgement_ = std::move(judgement);
  Q_EMIT stepsChanged();
  if (following) setPosition(count());
  if (isEnded()) {
    running_ = false;
    wanted_ = 0;
  } else if (running_) {
    pace_.start();
  } else if (wanted_ > 0) {
    --wanted_;
    compute();
  }
  Q_EMIT stateChanged();
}

const TraceStep* StepperModel::current() const {
  return position_ > 0 ? steps_[static_cast<std::size_t>(position_ - 1)].get() : nullptr;
}

const TraceAttempt* StepperModel::attempt() const {
  const TraceStep* step = current();
  return step ? &attempts_[step->attempt] : nullptr;
}

Pose StepperModel::pose() const {
  const TraceStep* step = current();
  return step ? step->report.fixed_from_moving : start_.start();
}

Pose StepperModel::poseBefore() const {
  const TraceStep* step = current();
  return step ? step->before : start_.start();
}

void StepperModel::pick(std::optional<std::size_t> pair) {
  if (pair && *pair >= pairs_.size()) pair.reset();
  if (pair == picked_) return;
  picked_ = pair;
  Q_EMIT pickedChanged();
}

QString StepperModel::pickedSentence() const {
  if (!picked_) return {};
  return qt(pairSentence(*attempt(), *current(), pairs_[*picked_]));
}

QString StepperModel::stateSentence() const {
  if (!isReady()) return problem_;
  if (count() == 0)
    return isWorking() ? QString("Preparing the two scans…")
                       : QString("At the start, from %1. Step, or run to the end.")
                             .arg(start_.byHand() ? "the pose set by hand" : "the odometry");
  if (!isEnded())
    return running_
               ? QString("Running: %1 iterations so far.").arg(count())
               : QString("Paused after %1 %2.").arg(count()).arg(count() == 1 ? "iteration" : "iterations");
  QString text =
      QString("Ended after %1 iterations: %2. %3")
          .arg(count())
          .arg(qt(stopReasonName(result_->stop_reason)), qt(stopReasonSentence(result_->stop_reason)));
  if (attempts_.size() > 1)
    text += QString(" Attempt %1 of %2 fits best and is the result.").arg(*chosen_ + 1).arg(attempts_.size());
  return text;
}

bool StepperModel::isStored() const {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot || !result_) return false;
  return std::ranges::any_of(snapshot->links(), [this](const Link& link) {
    return link.fixed == fixed_ && link.moving == moving_ &&
           link.fixed_from_moving == result_->fixed_from_moving;
  });
}

bool StepperModel::canAccept() const {
  return isEnded() && result_->succeeded() && session_.isWritable() && !project_busy_ && !isStored();
}

void StepperModel::setProjectBusy(bool busy) {
  if (busy == project_busy_) return;
  project_busy_ = busy;
  Q_EMIT stateChanged();
}

QString StepperModel::acceptHint() const {
  if (!isEnded()) return "Only an ended registration can be accepted: run it to the end first";
  if (!result_->succeeded()) return "There is nothing to accept: " + qt(stopReasonName(result_->stop_reason));
  if (!session_.isWritable()) return "The project is open for reading only";
  if (isStored()) return "The project has this link";
  if (project_busy_)
    return "Other work goes on, or waits to be decided; the result can be accepted when that is over";
  return "Store the result as a link, and place the scans by it (can be undone)";
}

Status StepperModel::accept() {
  if (!canAccept()) return fail(utf8(acceptHint()), "ICP stepper", "step or run the pair to its end");
  SteppedPair pair;
  pair.fixed = *fixed_;
  pair.moving = *moving_;
  pair.result = *result_;
  pair.start_by_hand = start_.byHand();
  pair.start = start_.start();
  pair.preset = utf8(parameters_.preset());
  pair.values = parameters_.values();
  pair.started = started_;
  pair.judgement = judgement_;
  // The session tells of a refusal itself.
  return session_.apply(steppedPairEdit(session_.snapshot(), pair));
}

void StepperModel::discard() {
  startOver();
}

}  // namespace tiltmap::ui
