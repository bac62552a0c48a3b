// Lines taken while the tilt moves on at one speed.
//
// The tilt passes all rows in one move. What it does on the way is known once it has arrived in time at the
// right place; then each row gets the line whose middle was nearest to it, and each line the tilt at its end
// and how far it moved in a turn of the mirror, from which every beam's own tilt follows
// (core/scan/beam_tilts.h).
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/text.h"
#include "core/project/moving_line.h"
#include "core/scan/beam_tilts.h"
#include "hardware/capture/sweep_run.h"

namespace tiltmap {

namespace {

constexpr int kGap = 10;              // rows that were taken already: more, and another pass skips them
constexpr double kSpareS = 0.010;     // around the lines, for what is not known of the motion's start
constexpr double kDirectS = 0.6;      // a longer run-up at the pass's own speed costs more than a move
constexpr double kFarAboveRad = 0.2;  // from there the way back is made in one piece
constexpr int kEmptyPasses = 4;

}  // namespace

// One pass over rows first to last.
struct Sweep::SteadyPass {
  int first = 0, last = 0;
  SteadySpeed speed;
  double duration_s = 0.0, period_s = 0.0;  // of a line
  double lead_rad = 0.0;                    // before the first row, until the motion is steady
  double below_rad = 0.0, below_with_play_rad = 0.0, end_rad = 0.0;  // where it begins and ends
  bool measuring = false;
  struct Held {
    LineTaken line;
    Instant arrived;
  };
  std::vector<Held> held{};  // lines of this pass

  double pitchRad() const { return speed.rate_rad_s * period_s; }
};

Sweep::SteadyPass Sweep::steadyPass(const ScannerGeometry& geometry, int first, int last) const {
  SteadyPass pass;
  pass.first = first;
  pass.last = last;
  pass.duration_s = scanner_->lineDuration();
  pass.period_s = scanner_->linePeriod();
  if (pass.period_s > 0.0) pass.speed = tilt_->steadySpeed(geometry.tilt_step_rad / pass.period_s);
  pass.lead_rad = pass.speed.rate_rad_s * (0.5 * pass.speed.ramp_s + 0.5 * pass.duration_s + kSpareS) +
                  0.5 * pass.pitchRad();
  pass.below_rad = geometry.tiltOfRow(first) - pass.lead_rad;
  pass.below_with_play_rad = pass.below_rad - pass.speed.play_rad;
  pass.end_rad = geometry.tiltOfRow(last) + pass.lead_rad;
  return pass;
}

Status Sweep::checkSteady(const ScannerGeometry& geometry) const {
  const SteadyPass pass = steadyPass(geometry, 0, geometry.rows - 1);
  if (!(pass.period_s > 0.0))
    return fail("the instants of this scanner's beams are not known", scanner_->name(),
                "capture line by line: --mode stop");
  // What is stored of a line tells how many turns it took by the shape of its fan alone.
  if (std::lround(pass.duration_s / scanner_->turnDuration()) != mirrorTurns(geometry))
    return fail(
        "beams of this spacing in so narrow a field of view would be taken for those of an LMS 2xx, "
        "which needs several turns of its mirror for them",
        scanner_->name(),
        "let the scanner send its whole field of view, or capture line by line: --mode stop");
  if (!(pass.speed.rate_rad_s > 0.0))
    return fail("this tilt cannot move steadily", tilt_->name(), "capture line by line: --mode stop");
  if (!(geometry.tilt_step_rad > 0.0))
    return fail("the lines do not go upwards", "capture --step", "give a step above 0");
  for (const double angle : {pass.below_with_play_rad, pass.end_rad})
    if (Status status = tilt_->checkAngle(angle); !status)
      return fail(
          status.error().what + " (a steady move begins below the first line and ends above the last)",
          status.error().where, status.error().remedy);
  return {};
}

// Looks at both instruments until `done` says so; lines are kept while the pass is measuring.
Status Sweep::watch(Run& run, SteadyPass& pass, const std::function<bool()>& done) {
  Clock& clock = *instruments_.clock;
  while (true) {
    if (run.job.stopRequested()) return fail(kCancelled, "capture", kResume);
    if (Status status = run.settleStored(kUnstored); !status) {
      run.disk_failed = true;
      return status;
    }
    auto reading = tilt_->poll();
    if (!reading) return fail(reading.error());
    run.standing = *reading;
    while (true) {
      auto event = scanner_->poll();
      if (!event) return fail(event.error());
      if (!*event) break;
      run.last_event = clock.now();
      if (std::holds_alternative<LineSpoiled>(**event) && pass.measuring)
        if (Status status = spoiled(run); !status) return status;
      if (auto* line = std::get_if<LineTaken>(&**event)) {
        run.line_end = line->measured.ended();
        run.spoiled_in_a_row = 0;
        if (pass.measuring) pass.held.push_back({std::move(*line), clock.now()});
      }
    }
    if (Status status = silent(run); !status) return status;
    if (done()) return {};
    clock.sleepFor(durationOf(kLookS));
  }
}

// Stands below the first row, with the gear's play taken out or enough way left to do so.
Status Sweep::goBelow(Run& run, SteadyPass& pass) {
  const auto stands = [&] { return run.standing.has_value(); };
  if (Status status = watch(run, pass, stands); !status) return status;
  if (!run.begun) run.begun = instruments_.clock->now();
  const double first = pass.below_rad + pass.lead_rad;
  const SteadySpeed back = tilt_->steadySpeed(std::numeric_limits<double>::max());
  if (run.standing->angle_rad > first + kFarAboveRad) {
    if (Status status = tilt_->moveSteadily(pass.below_with_play_rad, back.rate_rad_s); !status)
      return status;
    run.standing.reset();
    if (Status status = watch(run, pass, stands); !status) return status;
  }
  const double angle = run.standing->angle_rad;
  const bool direct =
      angle <= pass.below_with_play_rad + 0.001 && (first - angle) <= kDirectS * pass.speed.rate_rad_s;
  if (!direct) {
    // Upwards in one piece, which takes the play out as well.
    const Status moved = angle < pass.below_rad ? tilt_->moveSteadily(pass.below_rad, back.rate_rad_s)
                                                : tilt_->moveTo(pass.below_rad);
    if (!moved) return moved;
    run.standing.reset();
  }
  return watch(run, pass, [&] {
    return stands() && run.line_end && instruments_.clock->now() >= run.standing->settled;
  });
}

Status Sweep::passSteadily(Run& run) {
  Clock& clock = *instruments_.clock;
  const auto free = [&](int row) { return !run.taken[static_cast<std::size_t>(row)]; };
  int first = 0;
  while (!free(first)) ++first;
  int last = first;
  for (int row = first; row < run.geometry.rows && row - last <= kGap; ++row)
    if (free(row)) last = row;
  SteadyPass pass = steadyPass(run.geometry, first, last);
  run.standing.reset();
  if (Status status = goBelow(run, pass); !status) return status;

  // Begun so that the middle of a line falls on the first row.
  const SteadyMotion expected{clock.now() + durationOf(tilt_->steadyDelay()), run.standing->angle_rad,
                              pass.end_rad, pass.speed.rate_rad_s, pass.speed.ramp_s};
  const double early_s = secondsOf(*run.line_end - durationOf(0.5 * pass.duration_s) -
                                   expected.when(run.geometry.tiltOfRow(first)));
  const Instant begin =
      clock.now() + durationOf(early_s - pass.period_s * std::floor(early_s / pass.period_s));
  if (Status status = watch(run, pass, [&] { return clock.now() >= begin; }); !status) return status;

  if (Status status = tilt_->moveSteadily(pass.end_rad, pass.speed.rate_rad_s); !status) return status;
  pass.measuring = true;
  run.standing.reset();
  const Status moved = watch(run, pass, [&] {
    const auto have = run.geometry.rows - run.left +
                      std::min(static_cast<int>(pass.held.size()), pass.last - pass.first + 1);
    run.job.tell(static_cast<double>(have) / run.geometry.rows, "the tilt moves on steadily");
    if (!run.standing) return false;
    // At low rates the last line is still on its way when the tilt has arrived.
    const auto motion = tilt_->steadyMotion();
    return !motion || clock.now() > motion->end() + durationOf(3.0 * pass.period_s) ||
           motion->angle(*run.line_end - durationOf(0.5 * pass.duration_s)) >=
               run.geometry.tiltOfRow(pass.last) - 0.5 * pass.pitchRad();
  });
  if (!moved) return moved;
  return storeSteady(run, pass);
}

Status Sweep::storeSteady(Run& run, const SteadyPass& pass) {
  const auto motion = tilt_->steadyMotion();
  const int before = run.left;
  // A line arrives so long after it was measured, all of them alike. One that seems to have taken longer came
  // late or was dated too early: it is not known which.
  Duration lag = Duration::max();
  for (const SteadyPass::Held& held : pass.held)
    lag = std::min(lag, held.arrived - held.line.measured.ended());
  for (int row = pass.first; motion && row <= pass.last; ++row) {
    if (run.taken[static_cast<std::size_t>(row)]) continue;
    const SteadyPass::Held* nearest = nullptr;
    double off = 0.51 * pass.pitchRad() + 1e-4;
    for (const SteadyPass::Held& held : pass.held) {
      const Instant to = held.line.measured.ended(), from = to - durationOf(pass.duration_s);
      if (from < motion->steadyFrom() || to > motion->steadyTo()) continue;
      if (held.arrived - to > lag + durationOf(0.9 * pass.period_s)) continue;
      const double way =
          std::abs(motion->angle(to - durationOf(0.5 * pass.duration_s)) - run.geometry.tiltOfRow(row));
      if (way < off) off = way, nearest = &held;
    }
    if (!nearest) continue;
    const LineTaken& line = nearest->line;
    run.finished = std::max(run.finished, nearest->arrived);
    const Instant end = line.measured.ended();
    ScanLine stored{motion->angle(end), instruments_.clock->unixTime(end), line.range_m, line.code,
                    line.intensity};
    setTurnTilt(stored, motion->signedRate() * scanner_->turnDuration());
    run.handOver(row, std::move(stored));
    if (Status status = run.settleStored(kUnstored); !status) {
      run.disk_failed = true;
      return status;
    }
  }
  run.tell();
  if (run.left < before) {
    run.empty_passes = 0;
    return {};
  }
  if (++run.empty_passes < kEmptyPasses) return {};
  run.empty_passes = 0;
  if (!motion)
    return fail("where the tilt was on its way could not be told, several times in a row", tilt_->name(),
                "give it a lower speed (?velocity=60), or capture line by line: --mode stop");
  return fail("no line fell into the steady part of the tilt's move", tilt_->name(),
              "capture line by line: --mode stop");
}

// Below the first row while the vehicle drives on: the next stop begins there, and the next search for home
// is short. What goes wrong now shows when it is next asked for.
void Sweep::park(const ScannerGeometry& geometry) {
  const SteadyPass pass = steadyPass(geometry, 0, geometry.rows - 1);
  const SteadySpeed back = tilt_->steadySpeed(std::numeric_limits<double>::max());
  if (back.rate_rad_s > 0.0) (void)tilt_->moveSteadily(pass.below_with_play_rad, back.rate_rad_s);
}

}  // namespace tiltmap
