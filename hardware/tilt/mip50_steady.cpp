// Moves of a MIP 50 in one piece, for scanning on the way.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/text.h"
#include "core/geometry/pose.h"
#include "hardware/tilt/mip50_unit.h"

namespace tiltmap {

namespace {

// Whole counts/ms are what such controllers have been seen to be told; below that a part would be too much to
// lose.
constexpr double kWholeFrom = 10.0;
// What the angles of a move may be wrong by, because it took longer or shorter than computed.
constexpr double kOffRad = 0.0009;
// A stall is noticed so long after the end that was due.
constexpr double kLateS = 2.0;
constexpr std::size_t kDoneBytes = 4;  // of the acknowledge, with its line end

}  // namespace

SteadySpeed Mip50Unit::steadySpeed(double wished_rad_s) const {
  if (table_.interrupt.empty()) return {};
  const double counts_per_rad = std::abs(drive_.counts_per_turn) / (2.0 * std::numbers::pi);
  double speed = std::min(0.001 * wished_rad_s * counts_per_rad, drive_.speed);
  if (speed >= kWholeFrom) speed = std::floor(speed + 1e-9);
  return {1000.0 * speed / counts_per_rad, 0.001 * speed / drive_.acceleration, drive_.approach_rad};
}

Status Mip50Unit::moveSteadily(double angle_rad, double rate_rad_s) {
  if (!ready_ || phase_ != Phase::Still)
    return fail("the tilt is not ready to move steadily", name_, "let it stand still first");
  const SteadySpeed steady = steadySpeed(rate_rad_s);
  if (!(steady.rate_rad_s > 0.0))
    return fail(
        "there is no command to interrupt a long move, so none is begun", name_,
        "capture line by line (--mode stop), or name one in the controller's table (interrupt = ...)");
  if (Status status = checkAngle(angle_rad); !status) return status;
  target_ = drive_.countsOf(angle_rad);
  attempts_ = 0;
  irregular_ = false;
  steady_known_ = false;
  steady_ = SteadyMotion{kNever, drive_.angleOf(position_), drive_.angleOf(target_), steady.rate_rad_s,
                         steady.ramp_s};
  const double exact =
      0.001 * steady.rate_rad_s * std::abs(drive_.counts_per_turn) / (2.0 * std::numbers::pi);
  const double speed = std::round(1e6 * exact) * 1e-6;
  Request move = request(Mip50Verb::MoveAbsolute, static_cast<double>(target_));
  move.limit_s = steady_->duration() + kLateS;
  script_ = {request(Mip50Verb::Speed, speed), move, request(Mip50Verb::Speed, drive_.speed),
             positionRequest()};
  move_deadline_ = clock_.now() + durationOf(steady_->duration() + 2.0 * kLateS);
  phase_ = Phase::Gliding;
  ended_ = kNever;
  return poll().map([](const auto&) {});
}

// The speed is told and acknowledged first, then the move; the answer's delay is the controller's own.
double Mip50Unit::steadyDelay() const {
  constexpr std::size_t kSpeedBytes = 7, kMoveBytes = 12;
  return secondsOf(channel_->line().wireTime(kSpeedBytes + kDoneBytes + kMoveBytes)) + 0.002;
}

// The motor starts when the command's last letter, the G, has arrived.
void Mip50Unit::noteSent(const std::string& text) {
  if (phase_ != Phase::Gliding || !steady_ || script_.front().command.verb != Mip50Verb::MoveAbsolute) return;
  const std::size_t last = text.find_last_not_of("\r\n");
  steady_->start =
      clock_.now() + channel_->line().wireTime(last == std::string::npos ? text.size() : last + 1);
}

// Arrived. When it should have ended is computed; what it differs by may lie before the start or before the
// acknowledge, so half of it is taken into account and the other half is what may be wrong.
void Mip50Unit::settleSteady() {
  const Instant ended = ended_ - channel_->line().wireTime(kDoneBytes);
  const double late_s = secondsOf(ended - steady_->end());
  steady_known_ = std::abs(0.5 * late_s * steady_->rate_rad_s) <= kOffRad;
  if (steady_known_)
    steady_->start += durationOf(0.5 * late_s);
  else
    warnings_.push_back(
        "the tilt took " + fixedReal(steady_->duration() + late_s, 2) + " s for a move of " +
        fixedReal(steady_->duration(), 2) +
        " s, so that where it was on the way is not certain, and was sent again; where that "
        "happens often its supply is weak or its load is heavy: give it a lower speed (?velocity=60)");
}

}  // namespace tiltmap
