#include "hardware/capture/sweep.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap {

namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

// How often the instruments are looked at. What they say waits no longer than this.
constexpr double kLookS = 0.0005;
// Lines on their way to the disk; more than these and the sweep waits for the disk.
constexpr std::size_t kUnstored = 16;
// A line that comes to nothing so often in a row is a broken wire, not noise.
constexpr int kSpoiledInARow = 12;

constexpr const char* kResume = "`tiltmap capture PROJECT --resume` goes on with the next line";

}  // namespace

// One sweep under way.
struct Sweep::Run {
  const ScannerGeometry& geometry;
  const Store& store;
  const JobControl& job;
  std::vector<bool> taken;
  SweepReport report{};
  int left = 0;

  int aim = -1;                           // the row the tilt stands at or is on its way to; -1: none yet
  std::optional<TiltReading> standing{};  // there
  // The line on its way: its row and where the tilt stood. The tilt may be off to the next one already.
  struct Coming {
    int row;
    TiltReading reading;
  };
  std::optional<Coming> coming{};

  std::optional<Instant> trouble_since{};  // no line has come since an instrument failed
  Instant last_event{};
  int spoiled_in_a_row = 0;
  double pause_s = 0.0;

  // Upwards from the row after the last one; from the lowest again where there is none.
  int next() const {
    const auto free = [this](int row) {
      return !taken[static_cast<std::size_t>(row)] && !(coming && coming->row == row);
    };
    for (int row = aim + 1; row < geometry.rows; ++row)
      if (free(row)) return row;
    for (int row = 0; row <= std::min(aim, geometry.rows - 1); ++row)
      if (free(row)) return row;
    return -1;
  }

  // Lines handed over and not yet known to be durable.
  struct Unstored {
    int row;
    SteadyTime since;
    std::future<Status> stored;
  };
  std::deque<Unstored> unstored{};

  // Looks after what has been stored; waits until at most `most` are open.
  Status settleStored(std::size_t most) {
    while (!unstored.empty()) {
      Unstored& first = unstored.front();
      if (unstored.size() <= most &&
          first.stored.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return {};
      const Status status = first.stored.get();
      report.slowest_store_s =
          std::max(report.slowest_store_s,
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - first.since).count());
      const int row = first.row;
      unstored.pop_front();
      if (!status) {
        taken[static_cast<std::size_t>(row)] = false;
        return status;
      }
      ++report.taken;
    }
    return {};
  }

  void tell() const {
    const int have = geometry.rows - left;
    job.tell(static_cast<double>(have) / geometry.rows,
             "line " + std::to_string(have) + " of " + std::to_string(geometry.rows));
  }
};

Sweep::Sweep(Instruments instruments, SweepSettings settings)
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

// The instruments are let go and found again until that works or patience ends. What was on its way is taken
// anew.
Status Sweep::recover(const Error& why, Run& run) {
  Clock& clock = *instruments_.clock;
  if (why.what == kCancelled) return fail(why);
  noteWarnings(run.report.warnings);
  run.report.warnings.push_back("interrupted at line " + std::to_string(run.geometry.rows - run.left) + ": " +
                                why.what + (why.where.empty() ? "" : " (" + why.where + ")"));
  run.coming.reset();
  run.standing.reset();
  run.spoiled_in_a_row = 0;
  Error last = why;
  if (!run.trouble_since) run.trouble_since = clock.now();
  while (true) {
    if (clock.now() - *run.trouble_since > durationOf(settings_.patience_s))
      return fail(last.what, last.where,
                  (last.remedy.empty() ? "" : last.remedy + "; ") + std::string(kResume));
    run.pause_s =
        run.pause_s == 0.0 ? settings_.first_pause_s : std::min(2.0 * run.pause_s, settings_.longest_pause_s);
    run.job.tell(static_cast<double>(run.geometry.rows - run.left) / run.geometry.rows,
                 last.what + "; trying again in " + fixedReal(run.pause_s, 0) + " s");
    const Instant end = clock.now() + durationOf(run.pause_s);
    while (clock.now() < end) {
      if (run.job.stopRequested()) return fail(kCancelled, "capture", kResume);
      if (Status status = run.settleStored(kUnstored); !status) return status;
      clock.sleepFor(durationOf(0.02));
    }
    scanner_.reset();
    tilt_.reset();
    if (Status status = prepare(run.job); !status) {
      if (status.error().what == kCancelled) return status;
      last = status.error();
      continue;
    }
    if (scanner_->columns() != run.geometry.columns)
      return fail("the scanner now sends " + std::to_string(scanner_->columns()) +
                      " values a line instead of " + std::to_string(run.geometry.columns),
                  scanner_->name(), "plug in the one the scan was begun with");
    ++run.report.recoveries;
    run.aim = -1;
    run.last_event = clock.now();
    return {};
  }
}

namespace {

// Between "settled" and "measured" lies what the clocks of driver and scanner may differ by.
bool stoodStill(const LineTimes& measured, const TiltReading& reading) {
  return measured.from >= reading.settled;
}

}  // namespace

Result<SweepReport> Sweep::run(const ScannerGeometry& geometry, std::vector<bool> taken, const Store& store,
                               const JobControl& job) {
  if (taken.size() != static_cast<std::size_t>(geometry.rows))
    throw std::invalid_argument("Sweep::run: one entry a row");
  Clock& clock = *instruments_.clock;
  const Instant start = clock.now();
  Run run{.geometry = geometry, .store = store, .job = job, .taken = std::move(taken), .last_event = start};
  run.left = static_cast<int>(std::ranges::count(run.taken, false));
  Instant finished = start;

  const auto aimAtNext = [&]() -> Status {
    const int row = run.next();
    if (row < 0) return {};
    run.aim = row;
    run.standing.reset();
    return tilt_->moveTo(geometry.tiltOfRow(row));
  };
  const auto happened = [&](const ScannerEvent& event) -> Status {
    run.last_event = clock.now();
    if (const auto* begun = std::get_if<LineBegun>(&event)) {
      run.coming.reset();  // whatever was on its way never came to its end
      if (!run.standing || run.aim < 0 || run.taken[static_cast<std::size_t>(run.aim)] ||
          !stoodStill(begun->measured, *run.standing))
        return {};
      run.coming = Run::Coming{run.aim, *run.standing};
      return aimAtNext();
    }
    if (std::holds_alternative<LineSpoiled>(event)) {
      if (!run.coming) return {};
      ++run.report.spoiled;
      run.coming.reset();
      if (++run.spoiled_in_a_row > kSpoiledInARow)
        return fail("nearly every line of the scanner arrives damaged", scanner_->name(),
                    "check the cable, its shield and the rate; a lower one may help (?baud=9600)");
      return {};  // the row is taken later: it is among those that are missing
    }
    if (!run.coming) return {};
    const auto& line = std::get<LineTaken>(event);
    const Run::Coming coming = *std::exchange(run.coming, std::nullopt);
    if (!stoodStill(line.measured, coming.reading)) {
      ++run.report.spoiled;
      return {};
    }
    run.spoiled_in_a_row = 0;
    run.pause_s = 0.0;
    run.trouble_since.reset();
    finished = clock.now();
    run.taken[static_cast<std::size_t>(coming.row)] = true;
    --run.left;
    ScanLine stored{coming.reading.angle_rad, clock.unixTime(line.measured.to), line.range_m, line.code,
                    line.intensity};
    run.unstored.push_back(
        {coming.row, std::chrono::steady_clock::now(), store(coming.row, std::move(stored))});
    run.tell();
    return {};
  };
  const auto look = [&]() -> Status {
    if (run.aim < 0 || (run.taken[static_cast<std::size_t>(run.aim)] && !run.coming)) {
      if (Status status = aimAtNext(); !status) return status;
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
      if (Status status = happened(**event); !status) return status;
    }
    if (clock.now() - run.last_event > durationOf(settings_.silence_s))
      return fail("the scanner has stopped sending", scanner_->name(),
                  "check its supply and its cable, and that nothing else uses its port");
    return {};
  };

  // A store that fails (a full disk) ends the sweep; an instrument that fails is waited for.
  Status outcome;
  while (outcome && run.left > 0) {
    if (job.stopRequested()) {
      outcome = fail(kCancelled, "capture", kResume);
      break;
    }
    if (outcome = run.settleStored(kUnstored); !outcome) break;
    if (Status status = look(); !status) {
      outcome = recover(status.error(), run);
      continue;
    }
    if (run.left > 0) clock.sleepFor(durationOf(kLookS));
  }
  if (tilt_ && !outcome) tilt_->stop();
  // What was handed over is waited for in any case; the first failure counts.
  Status last_stored;
  while (!run.unstored.empty())
    if (Status status = run.settleStored(0); !status && last_stored) last_stored = status;
  if (outcome && !last_stored) outcome = last_stored;
  noteWarnings(run.report.warnings);
  run.report.duration_s = secondsOf(finished - start);
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
