#include "ui/models/relaxation_model.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/multiview/relaxation_text.h"
#include "core/project/operations/relax_operation.h"
#include "ui/models/project_session.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr int kTogether_ms = 120;
constexpr qint64 kPosesAtMost_ms = 300;
constexpr int kLongestLog = 5000;  // lines; a thesis run over many scans writes some thousand

bool among(const std::vector<int>& list, int index) {
  return std::ranges::find(list, index) != list.end();
}

}  // namespace

QString relaxationRoleName(RelaxationRole role) {
  switch (role) {
    case RelaxationRole::None:
      return {};
    case RelaxationRole::Held:
      return "never moves";
    case RelaxationRole::Active:
      return "active";
    case RelaxationRole::Waiting:
      return "static";
    case RelaxationRole::Queued:
      return "queued";
    case RelaxationRole::Aligning:
      return "being aligned";
  }
  return {};
}

QString relaxationRoleTip(RelaxationRole role) {
  switch (role) {
    case RelaxationRole::None:
      return {};
    case RelaxationRole::Held:
      return "Scan 0 and pinned scans stay where they are";
    case RelaxationRole::Active:
      return "In the active set: tied to the scans that are being fitted together";
    case RelaxationRole::Waiting:
      return "In the static set: not tied to the others yet";
    case RelaxationRole::Queued:
      return "In the active set, and waiting in the queue to be aligned";
    case RelaxationRole::Aligning:
      return "Being registered onto its neighbours at this moment";
  }
  return {};
}

RelaxationModel::RelaxationModel(ProjectSession& session, JobQueue& jobs, ScanDisplay& display,
                                 QObject* parent)
    : QObject(parent), session_(session), jobs_(jobs), display_(display) {
  mailbox_->model = this;
  soon_.setSingleShot(true);
  soon_.setInterval(kTogether_ms);
  connect(&soon_, &QTimer::timeout, this, [this] {
    showRoles();
    // Views draw all points anew: a large survey gets its turns seldom enough that the window stays quick.
    if (!shown_.isValid() || shown_.elapsed() >= wait_ms_) {
      QElapsedTimer took;
      took.start();
      showPoses();
      wait_ms_ = std::max(kPosesAtMost_ms, 8 * took.elapsed());
      shown_.start();
    }
    Q_EMIT changed();
  });
  connect(&jobs, &JobQueue::changed, this, &RelaxationModel::jobChanged);
  connect(&session, &ProjectSession::closed, this, &RelaxationModel::forget);
  connect(&session, &ProjectSession::opened, this, &RelaxationModel::forget);
}

RelaxationModel::~RelaxationModel() {
  const std::lock_guard lock(mailbox_->mutex);
  mailbox_->model = nullptr;
}

JobRequest RelaxationModel::watched(JobRequest request) {
  if (request.operation->id() != "relax" || request.keep) return request;
  const auto notify = [mailbox = mailbox_] {
    const std::lock_guard lock(mailbox->mutex);
    if (mailbox->model) mailbox->model->deliveries_.post([model = mailbox->model] { model->readNews(); });
  };
  Run run;
  run.feed = std::make_shared<RelaxationFeed>(notify);
  if (hold_at_ > 0) run.feed->holdAt(hold_at_);
  run.operation = makeRelaxOperation(run.feed);
  request.operation = run.operation.get();
  request.keep = run.operation;
  runs_.push_back(std::move(run));
  return request;
}

void RelaxationModel::started(int job, const JobRequest& request) {
  const auto run = std::ranges::find_if(
      runs_, [&](const Run& r) { return r.operation.get() == request.operation && r.job == 0; });
  if (run == runs_.end()) return;
  run->job = job;
  // Those that were refused were never started.
  std::erase_if(runs_, [](const Run& r) { return r.job == 0; });
  jobChanged(job);
}

RelaxationModel::Run* RelaxationModel::runOf(int job) {
  const auto run = std::ranges::find_if(runs_, [job](const Run& r) { return r.job == job; });
  return run == runs_.end() ? nullptr : &*run;
}

RelaxationModel::Run* RelaxationModel::currentRun() {
  const JobStatus* status = jobs_.current();
  return status ? runOf(status->id) : nullptr;
}
const RelaxationModel::Run* RelaxationModel::currentRun() const {
  return const_cast<RelaxationModel*>(this)->currentRun();
}

const JobStatus* RelaxationModel::job() const {
  return job_ > 0 ? jobs_.find(job_) : nullptr;
}

bool RelaxationModel::isRunning() const {
  const JobStatus* status = jobs_.current();
  return status && status->phase == JobPhase::Running && currentRun();
}
bool RelaxationModel::isPaused() const {
  return isRunning() && currentRun()->feed->isPaused();
}
bool RelaxationModel::isHolding() const {
  return isPaused() && currentRun()->feed->isWaiting();
}
bool RelaxationModel::isProposal() const {
  const JobStatus* status = job();
  return status && status->phase == JobPhase::Waiting;
}

void RelaxationModel::pause() {
  if (!isRunning()) return;
  currentRun()->feed->pause();
  Q_EMIT changed();
}
void RelaxationModel::resume() {
  if (!isRunning()) return;
  currentRun()->feed->resume();
  Q_EMIT changed();
}
void RelaxationModel::cancel() {
  if (const Run* run = currentRun()) jobs_.cancel(run->job);
}
void RelaxationModel::accept() {
  if (isProposal()) jobs_.accept(job_);
}
void RelaxationModel::discard() {
  if (isProposal()) jobs_.discard(job_);
}

void RelaxationModel::showBefore(bool before) {
  // One of the two alone: both at once is over.
  display_.compareProposal(ProposalCompare::Off);
  if (before_shown_ != before) {
    before_shown_ = before;
    showPoses();
  }
  Q_EMIT changed();
}

void RelaxationModel::compareInView(ProposalCompare how) {
  if (!isProposal()) return;
  if (how != ProposalCompare::Off && before_shown_) {
    before_shown_ = false;
    showPoses();
  }
  display_.compareProposal(how);
  Q_EMIT changed();
}

void RelaxationModel::stepOn() {
  if (!isRunning()) return;
  currentRun()->feed->stepOn();
  Q_EMIT changed();
}

QString RelaxationModel::doing() const {
  if (state_.doing.empty()) return {};
  QString text = qt(state_.doing);
  if (state_.iteration > 0)
    text += QString(": iteration %1, %2 pairs, rms %3 mm")
                .arg(state_.iteration)
                .arg(state_.pairs)
                .arg(qt(fixedReal(1000.0 * state_.rms_m, 1)));
  return text;
}

RelaxationRole RelaxationModel::role(int index) const {
  if (index == state_.aligning) return RelaxationRole::Aligning;
  if (among(pins_, index)) return RelaxationRole::Held;
  if (among(state_.waiting, index)) return RelaxationRole::Waiting;
  if (among(state_.queue, index)) return RelaxationRole::Queued;
  return among(state_.active, index) ? RelaxationRole::Active : RelaxationRole::None;
}

void RelaxationModel::readNews() {
  bool any = false;
  for (Run& run : runs_) {
    const RelaxationNews news = run.feed->take();
    if (run.job == 0 || news.empty()) continue;
    if (news.began) begin(run.job, *news.began);
    if (run.job != job_) continue;
    for (const RelaxationFrame& frame : news.frames) take(frame);
    if (news.now) state_ = *news.now;
    any = true;
  }
  // A pause that takes effect brings no news but this, and is worth a word of its own: buttons wait for it.
  const bool held = isHolding();
  if (held != held_) {
    held_ = held;
    Q_EMIT changed();
  }
  if ((any || isPaused()) && !soon_.isActive()) soon_.start();
}

void RelaxationModel::begin(int job, const RelaxationBeginning& beginning) {
  job_ = job;
  method_ = qt(beginning.method);
  scans_ = beginning.scans;
  start_ = poses_ = beginning.world_from_scan;
  pins_ = beginning.pins;
  state_ = {};
  records_.clear();
  links_.clear();
  log_.clear();
  before_shown_ = false;
  Q_EMIT reset();
  write(QString("Relaxing %1 scans, method %2").arg(scans_.size()).arg(method_));
}

void RelaxationModel::take(const RelaxationFrame& frame) {
  poses_ = frame.world_from_scan;
  links_ = frame.links;
  RelaxationRecord record;
  record.step = frame.step.number;
  for (std::size_t i = 0; i < poses_.size(); ++i)
    record.moved_m.push_back(difference(start_[i], poses_[i]).translation_m);
  for (const RelaxationEvent& event : frame.step.events) {
    if (event.rms_m > 0.0) record.rms_m = event.rms_m;
    write(QString("step %1: %2").arg(frame.step.number).arg(qt(relaxationEventText(event))));
  }
  records_.push_back(std::move(record));
}

void RelaxationModel::write(const QString& line) {
  log_ << line;
  if (log_.size() > kLongestLog) log_.removeFirst();
  Q_EMIT logged(line);
}

void RelaxationModel::jobChanged(int id) {
  const Run* run = runOf(id);
  const JobStatus* status = jobs_.find(id);
  if (!run || !status) return;
  if (status->phase == JobPhase::Running && job_ != id && !isProposal()) {
    // It is shown from its first moment on, before it has anything to tell.
    forget();
    job_ = id;
    Q_EMIT reset();
  }
  if (job_ != id) return Q_EMIT changed();
  if (status->phase == JobPhase::Waiting || status->over()) {
    readNews();
    soon_.stop();
    state_.aligning = -1;
    state_.doing.clear();
  }
  if (status->phase == JobPhase::Waiting) {
    for (const EditStep& step : jobs_.waitingResult(id)->edit.steps)
      if (const auto* poses = std::get_if<SetPoses>(&step); poses && poses->stage == Stage::Relaxed)
        for (const auto& [scan, pose] : poses->poses)
          if (const auto place = std::ranges::find(scans_, scan); place != scans_.end())
            poses_[static_cast<std::size_t>(place - scans_.begin())] = pose;
    showRoles();
    showPoses();
  }
  if (status->over()) {
    write(jobPhaseName(status->phase) +
          (status->phase == JobPhase::Accepted ? "" : "; the project is as it was"));
    display_.setRoles({});
    display_.withdraw();
    if (status->phase != JobPhase::Accepted) poses_ = start_;
    std::erase_if(runs_, [id](const Run& r) { return r.job == id; });
  }
  Q_EMIT changed();
}

void RelaxationModel::showRoles() {
  if (!isRunning() || scans_.empty()) return display_.setRoles({});
  std::map<ScanId, RelaxationRole> roles;
  for (std::size_t i = 0; i < scans_.size(); ++i) roles[scans_[i]] = role(static_cast<int>(i));
  display_.setRoles(std::move(roles));
}

void RelaxationModel::showPoses() {
  if (scans_.empty() || (!isRunning() && !isProposal())) return display_.withdraw();
  const std::vector<Pose>& shown = before_shown_ ? start_ : poses_;
  std::vector<std::pair<ScanId, Pose>> poses, before;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    poses.emplace_back(scans_[i], shown[i]);
    before.emplace_back(scans_[i], start_[i]);
  }
  display_.propose(std::move(poses), std::move(before));
}

void RelaxationModel::forget() {
  soon_.stop();
  job_ = 0;
  method_.clear();
  scans_.clear();
  start_.clear();
  poses_.clear();
  pins_.clear();
  state_ = {};
  records_.clear();
  links_.clear();
  log_.clear();
  before_shown_ = false;
  display_.setRoles({});
  display_.withdraw();
  Q_EMIT reset();
}

}  // namespace tiltmap::ui
