#include "ui/models/capture_model.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "hardware/capture/known_rig.h"
#include "hardware/capture/station_capture.h"
#include "ui/models/job_queue.h"
#include "ui/models/project_session.h"
#include "ui/models/scan_display.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr qint64 kDiskEvery_ms = 2000;

bool sameFacts(const std::vector<InstrumentFact>& a, const std::vector<InstrumentFact>& b) {
  return std::ranges::equal(a, b, [](const InstrumentFact& x, const InstrumentFact& y) {
    return x.name == y.name && x.value == y.value && x.trouble == y.trouble;
  });
}

// Lines come up to 75 times a second and are told by signals of their own.
bool differs(const StationSnapshot& a, const StationSnapshot& b) {
  return a.state != b.state || a.doing != b.doing || a.error != b.error || a.live != b.live ||
         a.tilt_rad != b.tilt_rad || a.target_rad != b.target_rad || a.replays != b.replays ||
         a.scanner.name != b.scanner.name || !sameFacts(a.scanner.facts, b.scanner.facts) ||
         a.tilt.name != b.tilt.name || a.warnings.size() != b.warnings.size() || !a.line != !b.line ||
         a.sweep.number != b.sweep.number || a.sweep.rows_taken != b.sweep.rows_taken ||
         a.sweep.retries != b.sweep.retries || a.sweep.recoveries != b.sweep.recoveries ||
         a.sweep.complete != b.sweep.complete;
}

}  // namespace

CaptureModel& captureModel(Workspace& workspace) {
  auto* model = workspace.findChild<CaptureModel*>(QString(), Qt::FindDirectChildrenOnly);
  // Of what belongs to the workspace it uses nothing while it goes, which is after all of that.
  if (!model)
    model = new CaptureModel(workspace.session(), workspace.jobs(), workspace.display(), &workspace);
  return *model;
}

CaptureModel::CaptureModel(ProjectSession& session, JobQueue& jobs, ScanDisplay& display, QObject* parent)
    : QObject(parent), session_(session), jobs_(jobs), display_(display) {
  mailbox_->model = this;
  station_ = std::make_shared<CaptureStation>([mailbox = mailbox_] {
    const std::lock_guard lock(mailbox->mutex);
    if (!mailbox->model || std::exchange(mailbox->posted, true)) return;
    mailbox->model->deliveries_.post([model = mailbox->model] { model->read(); });
  });
  form_ = makeStationCapture(station_);
  parameters_ = new ParameterModel(*form_, this);
  verdict_ = new CaptureVerdict(session, this);
  connect(verdict_, &CaptureVerdict::changed, this, [this] {
    showPlace();
    Q_EMIT changed();
  });
  connect(&jobs_, &JobQueue::finished, this, &CaptureModel::jobEnded);
  connect(&session_, &ProjectSession::snapshotReplaced, this, [this] {
    if (verdict_->scan() && (!session_.snapshot() || !session_.snapshot()->find(*verdict_->scan())))
      verdict_->forget();
    disk_read_.invalidate();
    readDisk();
    Q_EMIT changed();
  });
}

CaptureModel::~CaptureModel() {
  {
    const std::lock_guard lock(mailbox_->mutex);
    mailbox_->model = nullptr;
  }
  station_->stop();
}

void CaptureModel::read() {
  {
    const std::lock_guard lock(mailbox_->mutex);
    mailbox_->posted = false;
  }
  const StationSnapshot before = std::exchange(now_, station_->snapshot());
  if (now_.sweep.number != before.sweep.number && now_.sweep.number > 0) {
    place_shown_ = place_stored_ = false;
    rows_.clear();
    verdict_->begin(now_.sweep.scan);
    Q_EMIT sweepBegan();
  }
  const auto rows = station_->takeRows();
  for (const StationLinePtr& line : rows) {
    rows_.push_back(line);
    Q_EMIT rowTaken(line);
  }
  // What is in the project by now: lines are stored on this thread, in order.
  if (!rows.empty() && verdict_->scan()) verdict_->linesCame(now_.sweep.rows_taken);
  if (now_.line && now_.line != before.line) Q_EMIT lineSeen(now_.line);
  readDisk();
  if (differs(before, now_)) Q_EMIT changed();
}

void CaptureModel::readDisk() {
  if (disk_read_.isValid() && disk_read_.elapsed() < kDiskEvery_ms) return;
  disk_read_.start();
  disk_free_bytes_ = -1.0;
  if (!session_.isOpen()) return;
  std::error_code failed;
  const auto space = std::filesystem::space(pathOf(session_.path()).parent_path(), failed);
  if (!failed) disk_free_bytes_ = static_cast<double>(space.available);
}

bool CaptureModel::isConnected() const {
  return state() == StationState::Ready || state() == StationState::Verdict ||
         state() == StationState::Moving;
}
bool CaptureModel::isBusy() const {
  return state() == StationState::Connecting || state() == StationState::Moving ||
         state() == StationState::Scanning || state() == StationState::Reconnecting;
}
bool CaptureModel::isSweeping() const {
  const JobStatus* job = job_ ? jobs_.find(*job_) : nullptr;
  return job && !job->over();
}

void CaptureModel::connectTo(const CaptureSettings& source) {
  refused_.reset();
  station_->connect(source);
}
void CaptureModel::connectToWhatIsThere(const QString& tilt_options, const QString& network) {
  refused_.reset();
  station_->connectToWhatIsThere(utf8(tilt_options), utf8(network));
}
void CaptureModel::reconnect() {
  refused_.reset();
  station_->reconnect();
}
void CaptureModel::disconnectInstruments() {
  refused_.reset();
  station_->disconnect();
}
void CaptureModel::jogBy(double angle_rad) {
  refused_.reset();
  station_->jogBy(angle_rad);
}
void CaptureModel::jogTo(double angle_rad) {
  refused_.reset();
  station_->jogTo(angle_rad);
}
void CaptureModel::home() {
  refused_.reset();
  station_->home();
}
void CaptureModel::park() {
  refused_.reset();
  station_->park();
}
void CaptureModel::setLive(bool on) {
  station_->setLive(on);
}
void CaptureModel::order(const QString& fault) {
  refused_.reset();
  if (const Status status = station_->fault(utf8(fault)); !status) refused_ = status.error();
  Q_EMIT changed();
}
QStringList CaptureModel::faults() const {
  QStringList names;
  for (const std::string& name : station_->faultNames()) names << qt(name);
  return names;
}

void CaptureModel::stop() {
  station_->stop();
  // Where the sweep still waits for its turn the station knows nothing of it.
  if (job_ && isSweeping()) jobs_.cancel(*job_);
}

std::vector<double> CaptureModel::azimuths(std::size_t columns) const {
  std::vector<double> azimuths(columns);
  for (std::size_t k = 0; k < columns; ++k)
    azimuths[k] = now_.azimuth_start_rad + static_cast<double>(k) * now_.azimuth_step_rad;
  return azimuths;
}

ParameterValues CaptureModel::values(bool resume) const {
  ParameterValues values;
  const ParameterValues all = parameters_->values();
  for (const char* name : {"lines", "step", "start", "mode", "patience", "known-rig"})
    values[name] = all.at(name);
  if (resume) values["resume"] = true;
  return values;
}

void CaptureModel::start(const std::optional<Pose>& last_from_next) {
  startSweep(false, last_from_next);
}
void CaptureModel::resume() {
  startSweep(true, {});
}

void CaptureModel::startSweep(bool resume, const std::optional<Pose>& last_from_next) {
  refused_.reset();
  const std::shared_ptr<Operation> operation = makeStationCapture(station_, last_from_next);
  JobRequest request;
  request.operation = operation.get();
  request.keep = operation;
  request.values = values(resume);
  request.title = resume ? "Go on with the last stop" : "Capture a stop";
  const auto job = jobs_.start(request);
  if (job)
    job_ = *job;
  else
    refused_ = job.error();
  Q_EMIT changed();
}

QString CaptureModel::knownRigText() const {
  const SnapshotPtr snapshot = session_.snapshot();
  CaptureSettings settings;
  if (!snapshot || snapshot->scans().empty() || now_.columns == 0 || parameters_->hasErrors() ||
      !captureTable().apply(values(false), settings))
    return {};
  ScannerGeometry sweep{.rows = settings.lines,
                        .columns = now_.columns,
                        .azimuth_start_rad = now_.azimuth_start_rad,
                        .azimuth_step_rad = now_.azimuth_step_rad,
                        .tilt_start_rad = settings.start_rad,
                        .tilt_step_rad = settings.step_rad};
  if (isSweeping()) return known_rig_text_;  // each line is another revision
  // A mask is read out of a matrix: once for what it depends on.
  const std::tuple key{snapshot->projectId(), snapshot->revision(), now_.scanner.name, now_.tilt.name,
                       settings.lines,        settings.start_rad,   settings.step_rad, now_.columns};
  if (known_rig_key_ != key) {
    known_rig_key_ = key;
    const std::string instruments = now_.source.emulate == CaptureDrive::None
                                        ? now_.scanner.name + ", " + now_.tilt.name
                                        : emulatedSource(now_.source.emulate, now_.source.seed);
    const auto rig = knownRig(*snapshot, sweep, instruments);
    known_rig_text_ = rig ? qt(tiltmap::knownRigText(*rig)) : QString();
  }
  return known_rig_text_;
}

QString CaptureModel::whyNotStart() const {
  if (!session_.isOpen()) return "Open or make a project first.";
  if (!session_.isWritable()) return "The project is open for reading only.";
  if (isSweeping()) return "A sweep is under way.";
  if (parameters_->hasErrors()) return "A setting of the sweep is not allowed: see Sweep.";
  CaptureSettings settings;
  if (const Status status = captureTable().apply(values(false), settings); !status)
    return errorSentence(status.error());
  const Status status = station_->checkCapture(*session_.snapshot(), settings);
  return status ? QString() : errorSentence(status.error());
}

bool CaptureModel::canResume() const {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!snapshot || snapshot->scans().empty() || !session_.isWritable() || isSweeping()) return false;
  if (state() != StationState::Ready && state() != StationState::Verdict) return false;
  const ScanEntry& last = snapshot->scans().back();
  if (last.lines >= last.rows || now_.replays) return false;
  CaptureSettings settings;
  return captureTable().apply(values(true), settings) && station_->checkCapture(*snapshot, settings);
}

bool CaptureModel::needsOdometry() const {
  const SnapshotPtr snapshot = session_.snapshot();
  return snapshot && !snapshot->scans().empty() && now_.source.emulate == CaptureDrive::None;
}

void CaptureModel::jobEnded(int id) {
  if (job_ != id) return;
  const JobStatus* job = jobs_.find(id);
  if (job && job->phase == JobPhase::Accepted) {
    // The last rows may be told after the end of the job.
    read();
    verdict_->complete();
  } else {
    verdict_->forget();
  }
  showPlace();
  Q_EMIT changed();
}

// While the sweep fills, the scan slides into its place; its verdict stores it there.
void CaptureModel::showPlace() {
  const SnapshotPtr snapshot = session_.snapshot();
  const auto& judgement = verdict_->judgement();
  if (judgement || !verdict_->scan() || !verdict_->estimate() || !snapshot) {
    if (std::exchange(place_shown_, false)) display_.withdraw();
    if (judgement && judgement->placed && !std::exchange(place_stored_, true)) storePlace();
    return;
  }
  if (!verdict_->estimate()->placed) return;
  const std::vector<Pose> poses = snapshot->filledPoses(snapshot->latestStage());
  std::vector<std::pair<ScanId, Pose>> shown;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ScanId id = snapshot->scans()[i].id;
    shown.emplace_back(id, id == *verdict_->scan() ? verdict_->estimate()->world_from_scan : poses[i]);
  }
  place_shown_ = true;
  display_.propose(std::move(shown));
}

void CaptureModel::storePlace() {
  const SnapshotPtr snapshot = session_.snapshot();
  const auto place = snapshot->indexOf(*verdict_->scan());
  if (!place || !session_.isWritable()) return;
  // With the stops that it was held against, which may have nothing but their odometry yet.
  Stage stage = snapshot->latestStage();
  std::vector<std::pair<ScanId, Pose>> poses;
  if (stage == Stage::Odometry) {
    stage = Stage::Pairwise;
    const std::vector<Pose> all = snapshot->filledPoses(Stage::Odometry);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i != *place) poses.emplace_back(snapshot->scans()[i].id, all[i]);
  }
  poses.emplace_back(*verdict_->scan(), verdict_->judgement()->world_from_scan);
  ProjectEdit edit = posesEdit(stage, std::move(poses));
  edit.title = "place " + snapshot->scans()[*place].name + " by its registration";
  (void)session_.apply(edit);
}

}  // namespace tiltmap::ui
