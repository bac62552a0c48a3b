// Moves of an EPOS in one piece, for scanning on the way.
//
// Unlike a MIP 50 it tells where it stands while it moves: the line through the steady part is laid through
// what it told, each position at the instant at which its request had arrived.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/geometry/pose.h"
#include "hardware/tilt/cia402.h"
#include "hardware/tilt/epos_unit.h"

namespace tiltmap {

using namespace cia402;

namespace {

// What the positions told on the way may be off the line through them: the motor did not move as computed, or
// an answer was held up.
constexpr double kOffRad = 0.0009;
constexpr std::size_t kEnough = 5;
constexpr double kLateS = 2.0;  // a stall is noticed so long after the end that was due
constexpr std::size_t kWriteBytes = 16, kAnswerBytes = 12;  // of a request on the wire, about

}  // namespace

double EposUnit::countsPerMs(double rpm_told) const {
  return rpm_told * settings_.counts_per_motor_turn / 60000.0;
}

SteadySpeed EposUnit::steadySpeed(double wished_rad_s) const {
  const double counts_per_rad = std::abs(drive_.counts_per_turn) / (2.0 * std::numbers::pi);
  const double wished = std::min(0.001 * wished_rad_s * counts_per_rad, drive_.speed);
  // In whole revolutions a minute of the motor, as it is told.
  const double speed = countsPerMs(rpm(wished));
  const double acceleration = 0.001 * countsPerMs(rpm(1000.0 * drive_.acceleration));
  return {1000.0 * speed / counts_per_rad, 0.001 * speed / acceleration, drive_.approach_rad};
}

Status EposUnit::moveSteadily(double angle_rad, double rate_rad_s) {
  using Kind = Step::Kind;
  if (!ready_ || phase_ != Phase::Still)
    return fail("the tilt is not ready to move steadily", name_, "let it stand still first");
  if (Status status = checkAngle(angle_rad); !status) return status;
  const SteadySpeed steady = steadySpeed(rate_rad_s + 1e-9);
  target_ = drive_.countsOf(angle_rad);
  attempts_ = 0;
  only_reading_ = false;
  irregular_ = false;
  steady_known_ = false;
  on_the_way_.clear();
  steady_ = SteadyMotion{kNever, drive_.angleOf(position_), drive_.angleOf(target_), steady.rate_rad_s,
                         steady.ramp_s};
  const double counts_per_rad = std::abs(drive_.counts_per_turn) / (2.0 * std::numbers::pi);
  speed_told_ = rpm(0.001 * steady.rate_rad_s * counts_per_rad + 1e-9);
  const double limit_s = steady_->duration() + kLateS;
  steps_ = {{Kind::Write, writing(kSpeed, 0, static_cast<std::int64_t>(speed_told_))},
            {Kind::Write, writing(kTarget, 0, target_)},
            {Kind::Begin, writing(kControl, 0, kStartMove)},
            {Kind::AwaitTaken, reading(kStatus), kLateS},
            {Kind::Write, writing(kControl, 0, kEnable)},
            {Kind::AwaitReached, reading(kStatus), limit_s},
            {Kind::ReadPosition, reading(kPosition)}};
  move_deadline_ = clock_.now() + durationOf(limit_s + kLateS);
  phase_ = Phase::Gliding;
  ended_ = clock_.now();
  return poll().map([](const auto&) {});
}

// Speed, target and control word, each with its answer.
double EposUnit::steadyDelay() const {
  return 3.0 * (secondsOf(channel_->line().wireTime(kWriteBytes + kAnswerBytes)) + 0.002) -
         secondsOf(channel_->line().wireTime(kAnswerBytes));
}

// Arrived. When it began is known to a few milliseconds; what it told on the way says it better.
void EposUnit::settleSteady() {
  std::vector<double> late_s;
  for (const Told& told : on_the_way_) {
    const double s = secondsOf(told.at - steady_->when(drive_.angleOf(told.counts)));
    if (told.at > steady_->steadyFrom() + durationOf(0.01) &&
        told.at < steady_->steadyTo() - durationOf(0.01))
      late_s.push_back(s);
  }
  if (late_s.size() < kEnough) return;  // too short for lines to be taken on it
  const double shift_s = medianOf(late_s);
  double worst_s = 0.0;
  for (const double s : late_s) worst_s = std::max(worst_s, std::abs(s - shift_s));
  steady_known_ = worst_s * steady_->rate_rad_s <= kOffRad && std::abs(shift_s) < 1.0;
  if (steady_known_)
    steady_->start += durationOf(shift_s);
  else
    warnings_.push_back("the tilt was up to " + fixedReal(worst_s * steady_->rate_rad_s / kDegree, 2) +
                        " deg off an even move, so that where it was on the way is not certain, and was sent "
                        "again; where that happens often its supply is weak or its load is heavy");
}

}  // namespace tiltmap
