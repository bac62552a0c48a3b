#include "hardware/capture/capture_station.h"

#include <algorithm>
#include <future>

#include "hardware/capture/capture_station_faults.h"

namespace tiltmap {

CaptureStation::CaptureStation(std::function<void()> changed, StationSettings settings)
    : changed_(std::move(changed)), settings_(std::move(settings)) {
  thread_ = std::jthread([this](const std::stop_token& end) { run(end); });
}

CaptureStation::~CaptureStation() {
  stop();
  thread_.request_stop();
  wake_.notify_all();
  thread_.join();
  // Given after the stop, by another thread: it waits for an answer.
  for (const Command& command : std::exchange(waiting_, {}))
    if (command.dropped) command.dropped();
}

StationSnapshot CaptureStation::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::vector<StationLinePtr> CaptureStation::takeRows() {
  const std::lock_guard lock(mutex_);
  return std::exchange(rows_, {});
}

void CaptureStation::update(const std::function<void(StationSnapshot&)>& change) {
  {
    const std::lock_guard lock(mutex_);
    change(snapshot_);
  }
  if (changed_) changed_();
}

void CaptureStation::setState(StationState state, std::string doing) {
  update([&](StationSnapshot& now) {
    now.state = state;
    now.doing = std::move(doing);
    if (state != StationState::Fault && state != StationState::Reconnecting) now.error.reset();
    if (state != StationState::Moving) now.target_rad.reset();
  });
}

// Nothing was done, and nothing has changed.
void CaptureStation::refuse(Error error) {
  update([&](StationSnapshot& now) { now.error = std::move(error); });
}

void CaptureStation::post(Command command) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(command));
  }
  wake_.notify_all();
}

void CaptureStation::stop() {
  std::deque<Command> dropped;
  {
    const std::lock_guard lock(mutex_);
    dropped.swap(waiting_);
    running_.request_stop();
    stop_wanted_ = true;
  }
  for (const Command& command : dropped)
    if (command.dropped) command.dropped();
  wake_.notify_all();
}

void CaptureStation::run(const std::stop_token& end) {
  while (!end.stop_requested()) {
    std::optional<Command> command;
    bool stop_now = false;
    {
      std::unique_lock lock(mutex_);
      const auto due = [this] { return stop_wanted_ || !waiting_.empty(); };
      if (listening_)
        wake_.wait_for(lock, end, durationOf(settings_.look_s), due);
      else
        wake_.wait(lock, end, due);
      stop_now = std::exchange(stop_wanted_, false);
      if (!end.stop_requested() && !waiting_.empty()) {
        command = std::move(waiting_.front());
        waiting_.pop_front();
        running_ = command->stop;
      }
    }
    if (stop_now) (void)standNow();
    if (command)
      command->run(command->stop.get_token());
    else if (listening_)
      look();
  }
  // An instrument that does not answer must not hold up the end of the program.
  const StationState state = snapshot().state;
  putToRest(state != StationState::Fault && state != StationState::Reconnecting);
}

JobControl CaptureStation::control(const std::stop_token& stop) {
  JobControl job;
  job.stop = stop;
  job.report = [this](const Progress& progress) {
    update([&](StationSnapshot& now) { now.doing = progress.message; });
  };
  return job;
}

void CaptureStation::connect(CaptureSettings source) {
  post({[this, source = std::move(source)](const std::stop_token& stop) { connectNow(source, stop); }, {}});
}
void CaptureStation::connectToWhatIsThere(std::string tilt_options, std::string network) {
  post({[this, options = std::move(tilt_options), network = std::move(network)](const std::stop_token& stop) {
          detectNow(options, network, stop);
        },
        {}});
}
void CaptureStation::reconnect() {
  post({[this](const std::stop_token& stop) { connectNow(snapshot().source, stop); }, {}});
}
void CaptureStation::disconnect() {
  post({[this](const std::stop_token&) {
          putToRest(true);
          setState(StationState::Idle);
        },
        {}});
}

void CaptureStation::jogTo(double angle_rad) {
  post({[this, angle_rad](const std::stop_token& stop) { moveNow(angle_rad, "moving the tilt", stop); }, {}});
}
void CaptureStation::jogBy(double angle_rad) {
  post({[this, angle_rad](const std::stop_token& stop) {
          const std::optional<double> from = snapshot().tilt_rad;
          if (!isReady()) return;
          if (!from)
            return refuse({"it is not known yet where the tilt stands", "",
                           "wait a moment, or send it to an "
                           "angle"});
          moveNow(*from + angle_rad, "moving the tilt", stop);
        },
        {}});
}
void CaptureStation::park() {
  post({[this](const std::stop_token& stop) {
          moveNow(settings_.park_rad, "moving the tilt to its parking place", stop);
        },
        {}});
}
void CaptureStation::home() {
  post({[this](const std::stop_token& stop) { homeNow(stop); }, {}});
}
void CaptureStation::setLive(bool on) {
  update([on](StationSnapshot& now) { now.live = on; });
}

Status CaptureStation::fault(const std::string& word) {
  const std::lock_guard lock(bench_mutex_);
  if (!faults_)
    return fail("only emulated instruments have faults to order", "",
                "connect to the emulator to practise with them");
  return faults_->order(word);
}

std::vector<std::string> CaptureStation::faultNames() const {
  const std::lock_guard lock(bench_mutex_);
  return faults_ ? faults_->names() : std::vector<std::string>();
}

// What was asked for, with the instruments that are there.
CaptureSettings CaptureStation::merged(const CaptureSettings& settings) const {
  CaptureSettings all = settings;
  const CaptureSettings source = snapshot().source;
  all.scanner = source.scanner;
  all.tilt = source.tilt;
  all.emulate = source.emulate;
  all.seed = source.seed;
  all.speed = source.speed;
  all.baud = source.baud;
  all.stops = 1;
  return all;
}

Status CaptureStation::checkCapture(const ProjectSnapshot& project, const CaptureSettings& settings) const {
  switch (const StationSnapshot now = snapshot(); now.state) {
    case StationState::Idle:
      return fail("no instruments are connected", "", "connect them first");
    case StationState::Connecting:
      return fail("the instruments are not ready yet", "", "wait until they are");
    case StationState::Fault:
      return fail("an instrument is not there", "", "connect again");
    case StationState::Scanning:
    case StationState::Reconnecting:
      return fail("the instruments are busy", "", "wait for the end, or stop them");
    default:
      break;
  }
  const CaptureSettings all = merged(settings);
  if (const auto plan = planNextStop(project, all); !plan) return fail(plan.error());
  if (Status status = tiltmap::checkCapture(project, all, {}); !status) return status;
  const ScannerGeometry geometry{
      .rows = all.lines, .tilt_start_rad = all.start_rad, .tilt_step_rad = all.step_rad};
  return geometry.check();
}

Result<OperationResult> CaptureStation::capture(const SnapshotPtr& snapshot, const CaptureSettings& settings,
                                                std::optional<Pose> last_from_next, LiveProject& live,
                                                const JobControl& job) {
  struct Answer {
    std::promise<Result<OperationResult>> promise;
  };
  const auto answer = std::make_shared<Answer>();
  auto outcome = answer->promise.get_future();
  Command command;
  std::stop_source stop = command.stop;
  command.run = [&, answer](const std::stop_token& token) {
    JobControl own = job;
    own.stop = token;
    answer->promise.set_value(captureNow(snapshot, settings, last_from_next, live, own));
  };
  command.dropped = [answer] { answer->promise.set_value(fail(kCancelled, "capture", "start it again")); };
  const std::stop_callback passed_on(job.stop, [stop]() mutable { stop.request_stop(); });
  post(std::move(command));
  return outcome.get();
}

}  // namespace tiltmap
