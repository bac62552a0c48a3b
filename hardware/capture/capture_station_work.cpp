// What the station's thread does with the instruments.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "core/base/text.h"
#include "core/geometry/pose.h"
#include "hardware/capture/capture_station.h"
#include "hardware/capture/capture_station_faults.h"
#include "hardware/capture/detect_instruments.h"

namespace tiltmap {

namespace {

constexpr double kSilenceS = 3.0;
// Fewer lines say more about the way to the first one than about the rest.
constexpr int kEnoughToTell = 3;

}  // namespace

// Emulators in memory live on a clock that passes only while somebody waits: between sweeps at the usual
// pace.
void CaptureStation::sleep() {
  const auto now = std::chrono::steady_clock::now();
  const Duration passed =
      std::clamp<Duration>(now - std::exchange(looked_, now), durationOf(settings_.look_s), durationOf(0.1));
  if (bench_ && dynamic_cast<VirtualClock*>(&bench_->clock())) bench_->clock().sleepFor(passed);
}

void CaptureStation::putToRest(bool orderly) {
  if (sweep_ && orderly) (void)sweep_->release();
  listening_ = moving_ = false;
  sweep_.reset();
  {
    // What takes its time must not hold up who asks for faults.
    std::unique_lock lock(bench_mutex_);
    auto faults = std::move(faults_);
    auto bench = std::move(bench_);
    lock.unlock();
    faults.reset();
  }
  update([](StationSnapshot& now) {
    now.scanner = now.tilt = {};
    now.warnings.clear();
    now.tilt_rad.reset();
    now.target_rad.reset();
    now.line.reset();
  });
}

void CaptureStation::connectNow(const CaptureSettings& source, const std::stop_token& stop) {
  putToRest(true);
  const bool replays = tiltmap::replays(source);
  update([&](StationSnapshot& now) {
    now.source = source;
    now.replays = replays;
  });
  setState(StationState::Connecting, "opening the instruments");
  auto bench = CaptureBench::open(source, source.stops, {});
  if (!bench) {
    setState(StationState::Fault);
    return refuse(bench.error());
  }
  {
    const std::lock_guard lock(bench_mutex_);
    bench_ = std::move(*bench);
    if (EmulatedBench* emulated = bench_->emulated()) faults_ = std::make_unique<FaultActor>(*emulated);
  }
  if (!replays) {
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), sweepSettings(source));
    return prepareNow(stop);
  }
  update([&](StationSnapshot& now) {
    now.scanner = {"recording of " + source.scanner.substr(0, source.scanner.find(':')), {}};
    now.tilt = {"recording of " + source.tilt.substr(0, source.tilt.find(':')), {}};
  });
  setState(StationState::Ready, "the sweep replays it");
}

void CaptureStation::detectNow(const std::string& tilt_options, const std::string& network,
                               const std::stop_token& stop) {
  putToRest(true);
  setState(StationState::Connecting, "looking at the ports");
  const auto found = detectInstruments({settings_.ports, network}, control(stop));
  if (!found) {
    if (found.error().what == kCancelled) return setState(StationState::Idle);
    setState(StationState::Fault);
    return refuse(found.error());
  }
  CaptureSettings source;
  source.scanner = found->scanner;
  source.tilt = found->tilt + (tilt_options.empty() ? "" : "?" + tilt_options);
  connectNow(source, stop);
}

void CaptureStation::prepareNow(const std::stop_token& stop) {
  const Status status = sweep_->prepare(control(stop));
  if (status) return ready();
  if (status.error().what == kCancelled) {
    putToRest(false);
    return setState(StationState::Idle);
  }
  putToRest(false);
  setState(StationState::Fault);
  refuse(status.error());
}

void CaptureStation::showInstruments() {
  ScannerUnit* scanner = sweep_->scanner();
  TiltUnit* tilt = sweep_->tilt();
  if (!scanner || !tilt) return;
  const std::vector<std::string> told[] = {scanner->takeWarnings(), tilt->takeWarnings()};
  update([&](StationSnapshot& now) {
    now.scanner = {scanner->name(), scanner->facts()};
    now.tilt = {tilt->name(), tilt->facts()};
    now.columns = scanner->columns();
    now.azimuth_start_rad = scanner->azimuthStart();
    now.azimuth_step_rad = scanner->azimuthStep();
    for (const auto& list : told)
      for (const std::string& text : list)
        if (std::ranges::find(now.warnings, text) == now.warnings.end()) now.warnings.push_back(text);
  });
}

void CaptureStation::ready(StationState state) {
  last_heard_ = bench_->clock().now();
  listening_ = true;
  moving_ = false;
  showInstruments();
  setState(state);
}

bool CaptureStation::isReady() {
  if (listening_ && sweep_ && sweep_->scanner() && sweep_->tilt()) return true;
  const StationSnapshot now = snapshot();
  if (now.replays)
    refuse({"a recording has no tilt that could be moved", "", "begin the sweep: it replays the recording"});
  else
    refuse({"no instruments are connected", "", "connect them first"});
  return false;
}

// Told to stand still, and asked where that is. Nothing moves by itself after a stop: where the place got
// lost, the operator has home searched. False: so it is.
bool CaptureStation::standNow() {
  if (!sweep_ || !sweep_->tilt()) return true;
  TiltUnit& tilt = *sweep_->tilt();
  tilt.stop();
  if (!listening_) return true;
  update([](StationSnapshot& now) { now.tilt_rad.reset(); });
  if (tilt.poll() && tilt.findWhereItStands()) return true;
  putToRest(false);
  setState(StationState::Fault, "stopped");
  refuse({"the tilt was stopped on its way, and where it stands is not known", "",
          "connect again, which searches home; the lines before are kept"});
  return false;
}

Status CaptureStation::lookAtInstruments() {
  const Instant now = bench_->clock().now();
  while (true) {
    auto event = sweep_->scanner()->poll();
    if (!event) return fail(event.error());
    if (!*event) break;
    last_heard_ = now;
    auto* taken = std::get_if<LineTaken>(&**event);
    if (!taken) continue;
    auto line = std::make_shared<StationLine>();
    line->range_m = std::move(taken->range_m);
    line->code = std::move(taken->code);
    update([&](StationSnapshot& state) {
      ++state.lines_seen;
      state.scanner.facts = sweep_->scanner()->facts();
      if (!state.live) return;
      line->tilt_rad = state.tilt_rad.value_or(0.0);
      state.line = std::move(line);
    });
  }
  if (now - last_heard_ > durationOf(kSilenceS))
    return fail("the scanner has stopped sending", sweep_->scanner()->name(),
                "check its supply and its cable, and that nothing else uses its port");
  const auto reading = sweep_->tilt()->poll();
  if (!reading) return fail(reading.error());
  std::optional<double> angle;
  if (*reading && (!moving_ || bench_->clock().now() >= (*reading)->settled)) angle = (*reading)->angle_rad;
  if (snapshot().tilt_rad != angle) update([&](StationSnapshot& state) { state.tilt_rad = angle; });
  return {};
}

void CaptureStation::look() {
  sleep();
  if (Status status = lookAtInstruments(); !status) lost(status.error());
}

// Between sweeps. A stop ends the search.
void CaptureStation::lost(const Error& error) {
  listening_ = moving_ = false;
  setState(StationState::Reconnecting);
  refuse(error);
  std::stop_source ended;
  {
    const std::lock_guard lock(mutex_);
    if (stop_wanted_) ended.request_stop();
    running_ = ended;
  }
  SweepOptions settings = sweepSettings(snapshot().source);
  settings.patience_s = settings_.patience_s;
  sweep_->setSettings(settings);
  double pause_s = 0.0;
  const Status status = sweep_->findAgain(error, control(ended.get_token()), bench_->clock().now(), pause_s);
  if (status) return ready();
  const bool stopped = status.error().what == kCancelled;
  const Error why = stopped ? error : status.error();
  putToRest(false);
  setState(StationState::Fault, stopped ? "stopped looking for it" : "");
  refuse(why);
}

void CaptureStation::moveNow(double angle_rad, const std::string& doing, const std::stop_token& stop) {
  if (!isReady()) return;
  TiltUnit& tilt = *sweep_->tilt();
  if (Status status = tilt.checkAngle(angle_rad); !status) return refuse(status.error());
  if (stop.stop_requested()) return;
  setState(StationState::Moving, doing);
  update([&](StationSnapshot& now) {
    now.target_rad = angle_rad;
    now.tilt_rad.reset();
  });
  if (Status status = tilt.moveTo(angle_rad); !status) return lost(status.error());
  moving_ = true;
  while (true) {
    if (stop.stop_requested()) {
      moving_ = false;
      if (standNow()) setState(StationState::Ready, "stopped");
      return;
    }
    if (Status status = lookAtInstruments(); !status) return lost(status.error());
    if (snapshot().tilt_rad) break;
    if (dynamic_cast<VirtualClock*>(&bench_->clock()))
      sleep();
    else
      std::this_thread::sleep_for(durationOf(settings_.look_s));
  }
  moving_ = false;
  setState(StationState::Ready);
}

void CaptureStation::homeNow(const std::stop_token& stop) {
  if (!isReady()) return;
  setState(StationState::Moving, "searching home");
  update([](StationSnapshot& now) { now.tilt_rad.reset(); });
  listening_ = false;
  Status status = sweep_->tilt()->release();
  if (status) status = sweep_->tilt()->prepare(control(stop));
  if (!status && status.error().what == kCancelled) {
    sweep_->tilt()->stop();
    putToRest(false);
    setState(StationState::Fault);
    return refuse({"the search for home was stopped: where the tilt stands is not known", "",
                   "connect again, which searches home"});
  }
  if (!status) return lost(status.error());
  ready();
}

SweepEvents CaptureStation::sweepEvents() {
  SweepEvents events;
  events.line = [this](int row, double wished_rad, const ScanLine& taken) {
    auto line = std::make_shared<StationLine>(StationLine{row, taken.tilt_rad, taken.range_m, taken.code});
    update([&](StationSnapshot& now) {
      StationSweep& sweep = now.sweep;
      now.line = line;
      ++now.lines_seen;
      if (const ScannerUnit* scanner = sweep_->scanner()) now.scanner.facts = scanner->facts();
      rows_.push_back(line);
      now.tilt_rad = taken.tilt_rad;
      ++sweep.rows_taken;
      sweep.cells += taken.code.size();
      sweep.dead_cells += static_cast<std::size_t>(
          std::ranges::count_if(taken.code, [](CellCode code) { return !cell_code::hasPoint(code); }));
      // Of lines taken on the move the angle is that of the line's end, not the row's.
      if (!sweep_->settings().steady) {
        sweep.tilt_error_rad = taken.tilt_rad - wished_rad;
        sweep.worst_tilt_error_rad = std::max(sweep.worst_tilt_error_rad, std::abs(*sweep.tilt_error_rad));
      }
      sweep.elapsed_s = secondsOf(std::chrono::steady_clock::now() - sweep_began_);
      const int have = static_cast<int>(sweep.cells / std::max<std::size_t>(1, taken.code.size()));
      if (have >= kEnoughToTell)
        sweep.left_s = sweep.elapsed_s / have * (sweep.geometry.rows - sweep.rows_taken);
      now.doing = "line " + std::to_string(sweep.rows_taken) + " of " + std::to_string(sweep.geometry.rows);
    });
  };
  events.spoiled = [this](int so_far) { update([&](StationSnapshot& now) { now.sweep.retries = so_far; }); };
  events.lost = [this](const Error& why) {
    setState(StationState::Reconnecting);
    refuse(why);
  };
  events.found = [this](int so_far) {
    showInstruments();
    update([&](StationSnapshot& now) { now.sweep.recoveries = so_far; });
    setState(StationState::Scanning, "going on");
  };
  return events;
}

void CaptureStation::sweepBegins(ScanId scan, const ScannerGeometry& geometry,
                                 const std::vector<bool>& taken) {
  sweep_began_ = std::chrono::steady_clock::now();
  showInstruments();
  update([&](StationSnapshot& now) {
    StationSweep sweep;
    sweep.number = now.sweep.number + 1;
    sweep.scan = scan;
    sweep.geometry = geometry;
    sweep.rows_taken = static_cast<int>(std::ranges::count(taken, true));
    now.sweep = sweep;
    rows_.clear();
  });
  setState(StationState::Scanning, "on the way to the first line");
}

Result<OperationResult> CaptureStation::captureNow(const SnapshotPtr& project,
                                                   const CaptureSettings& settings,
                                                   const std::optional<Pose>& last_from_next,
                                                   LiveProject& live, const JobControl& job) {
  if (job.stopRequested()) return fail(kCancelled, "capture", "start it again");
  const CaptureSettings all = merged(settings);
  const bool replays = snapshot().replays;
  if (replays) {
    // From its beginning, however often it was replayed.
    auto bench = CaptureBench::open(all, 1, {});
    if (!bench) return fail(bench.error());
    const std::lock_guard lock(bench_mutex_);
    bench_ = std::move(*bench);
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), sweepSettings(all));
  } else if (!isReady()) {
    return fail(snapshot().error.value_or(Error{"no instruments are connected", "", "connect them first"}));
  }
  auto plan = planNextStop(*project, all);
  if (!plan) return fail(plan.error());
  CaptureTask task;
  task.snapshot = project;
  task.plan = std::move(*plan);
  task.last_from_next = last_from_next;
  task.events = sweepEvents();
  task.begun = [this](ScanId scan, const ScannerGeometry& geometry, const std::vector<bool>& taken) {
    sweepBegins(scan, geometry, taken);
  };
  listening_ = false;
  setState(StationState::Scanning, "getting ready");
  auto outcome = runCapture(task, *bench_, *sweep_, live, job);
  if (replays) {
    (void)sweep_->release();
    sweep_.reset();
  }
  const bool there = !replays && sweep_->scanner() && sweep_->tilt();
  if (outcome) {
    update([](StationSnapshot& now) {
      now.sweep.complete = true;
      now.sweep.left_s.reset();
    });
    if (there)
      ready(StationState::Verdict);
    else
      setState(StationState::Verdict);
    return outcome;
  }
  afterFailure(outcome.error(), replays);
  return outcome;
}

void CaptureStation::afterFailure(const Error& why, bool replays) {
  const bool stopped = why.what == kCancelled;
  if (replays) {
    setState(StationState::Ready, stopped ? "stopped" : "");
    return stopped ? void() : refuse(why);
  }
  if (snapshot().state == StationState::Reconnecting || !sweep_->scanner() || !sweep_->tilt()) {
    putToRest(false);
    setState(StationState::Fault, stopped ? "stopped" : "");
    return refuse(stopped ? Error{"an instrument is not there", "",
                                  "connect again, then go on; the lines before are kept"}
                          : why);
  }
  listening_ = true;
  if (stopped && !standNow()) return;
  ready();
  if (stopped) return setState(StationState::Ready, "stopped");
  refuse(why);
}

}  // namespace tiltmap
