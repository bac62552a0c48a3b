#include "hardware/capture/sweep.h"

#include <stdexcept>

#include "core/base/text.h"
#include "hardware/capture/sweep_run.h"

namespace tiltmap {

Sweep::Sweep(Instruments instruments, SweepOptions settings)
    : instruments_(std::move(instruments)), settings_(settings) {
  if (!instruments_.clock || !instruments_.open_scanner || !instruments_.open_tilt)
    throw std::invalid_argument("Sweep: instruments are missing");
}
Sweep::~Sweep() = default;

Status Sweep::prepare(const JobControl& job) {
  if (!scanner_) {
    auto opened = instruments_.open_scanner();
    if (!opened) return fail(opened.error());
    scanner_ = std::move(*opened);
  }
  if (!tilt_) {
    auto opened = instruments_.open_tilt();
    if (!opened) return fail(opened.error());
    tilt_ = std::move(*opened);
  }
  if (Status status = tilt_->prepare(job); !status) return status;
  return scanner_->prepare(job);
}

ScannerGeometry Sweep::geometry(int lines, double start_rad, double step_rad) const {
  if (!scanner_) throw std::logic_error("Sweep::geometry: not prepared");
  ScannerGeometry geometry;
  geometry.rows = lines;
  geometry.columns = scanner_->columns();
  geometry.azimuth_start_rad = scanner_->azimuthStart();
  geometry.azimuth_step_rad = scanner_->azimuthStep();
  geometry.tilt_start_rad = start_rad;
  geometry.tilt_step_rad = step_rad;
  return geometry;
}

Status Sweep::check(const ScannerGeometry& geometry) const {
  if (!tilt_) throw std::logic_error("Sweep::check: not prepared");
  if (settings_.steady) return checkSteady(geometry);
  for (const int row : {0, geometry.rows - 1})
    if (Status status = tilt_->checkAngle(geometry.tiltOfRow(row)); !status) return status;
  return {};
}

std::string Sweep::instrumentNames() const {
  return (scanner_ ? scanner_->name() : "no scanner") + ", " + (tilt_ ? tilt_->name() : "no tilt unit");
}

void Sweep::noteWarnings(std::vector<std::string>& warnings) {
  const auto add = [&](std::vector<std::string> more) {
    for (std::string& text : more)
      if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(std::move(text));
  };
  if (scanner_) add(scanner_->takeWarnings());
  if (tilt_) add(tilt_->takeWarnings());
}

Status Sweep::findAgain(const Error& why, const JobControl& job, Instant since, double& pause_s,
                        const std::function<Status()>& meanwhile) {
  Clock& clock = *instruments_.clock;
  Error last = why;
  while (true) {
    if (clock.now() - since > durationOf(settings_.patience_s)) return fail(last);
    pause_s = pause_s == 0.0 ? settings_.first_pause_s : std::min(2.0 * pause_s, settings_.longest_pause_s);
    job.tell(-1.0, last.what + "; trying again in " + fixedReal(pause_s, 0) + " s");
    const Instant end = clock.now() + durationOf(pause_s);
    while (clock.now() < end) {
      if (job.stopRequested()) return fail(kCancelled, "capture", "");
      if (meanwhile)
        if (Status status = meanwhile(); !status) return status;
      clock.sleepFor(durationOf(0.02));
    }
    scanner_.reset();
    tilt_.reset();
    const Status status = prepare(job);
    if (status || status.error().what == kCancelled) return status;
    last = status.error();
  }
}

// What was on its way is taken anew.
Status Sweep::recover(const Error& why, Run& run) {
  Clock& clock = *instruments_.clock;
  if (why.what == kCancelled) return fail(why);
  noteWarnings(run.report.warnings);
  run.report.warnings.push_back("interrupted at line " + std::to_string(run.geometry.rows - run.left) + ": " +
                                why.what + (why.where.empty() ? "" : " (" + why.where + ")"));
  run.coming.reset();
  run.standing.reset();
  run.line_end.reset();
  run.spoiled_in_a_row = 0;
  if (!run.trouble_since) run.trouble_since = clock.now();
  if (run.events.lost) run.events.lost(why);
  JobControl telling = run.job;
  telling.report = [&run](const Progress& progress) {
    run.job.tell(static_cast<double>(run.geometry.rows - run.left) / run.geometry.rows, progress.message);
  };
  bool disk = false;
  const Status found = findAgain(why, telling, *run.trouble_since, run.pause_s, [&] {
    Status stored = run.settleStored(kUnstored);
    disk = !stored;
    return stored;
  });
  if (!found) {
    const Error& last = found.error();
    if (disk) return found;
    return fail(last.what, last.where,
                (last.remedy.empty() ? "" : last.remedy + "; ") + std::string(kResume));
  }
  if (scanner_->columns() != run.geometry.columns)
    return fail("the scanner now sends " + std::to_string(scanner_->columns()) +
                    " values a line instead of " + std::to_string(run.geometry.columns),
                scanner_->name(), "plug in the one the scan was begun with");
  ++run.report.recoveries;
  if (run.events.found) run.events.found(run.report.recoveries);
  run.aim = -1;
  run.last_event = clock.now();
  return {};
}

namespace {

// Between "settled" and "measured" lies what the clocks of driver and scanner may differ by.
bool stoodStill(const LineTimes& measured, const TiltReading& reading) {
  return measured.from >= reading.settled;
}

}  // namespace

Status Sweep::aimAtNext(Run& run) {
  const int row = run.next();
  if (row < 0) return {};
  run.aim = row;
  run.standing.reset();
  return tilt_->moveTo(run.geometry.tiltOfRow(row));
}

Status Sweep::spoiled(Run& run) {
  ++run.report.spoiled;
  if (run.events.spoiled) run.events.spoiled(run.report.spoiled);
  if (++run.spoiled_in_a_row > kSpoiledInARow)
    return fail("nearly every line of the scanner arrives damaged", scanner_->name(),
                "check the cable, its shield and the rate; a lower one may help (?baud=9600)");
  return {};  // the row is taken later: it is among those that are missing
}

Status Sweep::happened(Run& run, const ScannerEvent& event) {
  Clock& clock = *instruments_.clock;
  run.last_event = clock.now();
  if (const auto* begun = std::get_if<LineBegun>(&event)) {
    run.coming.reset();  // whatever was on its way never came to its end
    if (!run.standing || run.aim < 0 || run.taken[static_cast<std::size_t>(run.aim)] ||
        !stoodStill(begun->measured, *run.standing))
      return {};
    run.coming = Run::Coming{run.aim, *run.standing};
    return aimAtNext(run);
  }
  if (!run.coming) return {};
  const Run::Coming coming = *std::exchange(run.coming, std::nullopt);
  if (std::holds_alternative<LineSpoiled>(event)) return spoiled(run);
  const auto& line = std::get<LineTaken>(event);
  if (!stoodStill(line.measured, coming.reading)) {
    ++run.report.spoiled;
    if (run.events.spoiled) run.events.spoiled(run.report.spoiled);
    return {};
  }
  run.finished = clock.now();
  run.handOver(coming.row, {coming.reading.angle_rad, clock.unixTime(line.measured.to), line.range_m,
                            line.code, line.intensity});
  run.tell();
  return {};
}

Status Sweep::silent(const Run& run) const {
  if (instruments_.clock->now() - run.last_event <= durationOf(settings_.silence_s)) return {};
  return fail("the scanner has stopped sending", scanner_->name(),
              "check its supply and its cable, and that nothing else uses its port");
}

// One look at the instruments of a sweep from line to line.
Status Sweep::look(Run& run) {
  if (run.aim < 0 || (run.taken[static_cast<std::size_t>(run.aim)] && !run.coming)) {
    if (Status status = aimAtNext(run); !status) return status;
  }
  if (!run.standing) {
    auto reading = tilt_->poll();
    if (!reading) return fail(reading.error());
    run.standing = *reading;
  }
  while (true) {
    auto event = scanner_->poll();
    if (!event) return fail(event.error());
    if (!*event) break;
    if (Status status = happened(run, **event); !status) return status;
  }
  return silent(run);
}

Result<SweepReport> Sweep::run(const ScannerGeometry& geometry, std::vector<bool> taken, const Store& store,
                               const JobControl& job, const SweepEvents& events) {
  if (taken.size() != static_cast<std::size_t>(geometry.rows))
    throw std::invalid_argument("Sweep::run: one entry a row");
  Clock& clock = *instruments_.clock;
  const Instant start = clock.now();
  Run run{.geometry = geometry,
          .store = store,
          .job = job,
          .events = events,
          .taken = std::move(taken),
          .last_event = start,
          .finished = start};
  run.left = static_cast<int>(std::ranges::count(run.taken, false));

  // A store that fails (a full disk) ends the sweep; an instrument that fails is waited for.
  Status outcome;
  while (outcome && run.left > 0) {
    if (job.stopRequested()) {
      outcome = fail(kCancelled, "capture", kResume);
      break;
    }
    if (outcome = run.settleStored(kUnstored); !outcome) break;
    if (Status status = settings_.steady ? passSteadily(run) : look(run); !status) {
      outcome = run.disk_failed ? status : recover(status.error(), run);
      continue;
    }
    if (run.left > 0) clock.sleepFor(durationOf(kLookS));
  }
  if (tilt_ && !outcome) tilt_->stop();
  if (outcome && settings_.steady) park(geometry);
  // What was handed over is waited for in any case; the first failure counts.
  Status last_stored;
  while (!run.unstored.empty())
    if (Status status = run.settleStored(0); !status && last_stored) last_stored = status;
  if (outcome && !last_stored) outcome = last_stored;
  noteWarnings(run.report.warnings);
  run.report.duration_s = secondsOf(run.finished - run.begun.value_or(start));
  if (!outcome) return fail(outcome.error());
  return run.report;
}

Status Sweep::release() {
  Status first;
  if (scanner_) first = scanner_->release();
  if (tilt_)
    if (Status status = tilt_->release(); !status && first) first = status;
  return first;
}

}  // namespace tiltmap
