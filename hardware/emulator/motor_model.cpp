#include "hardware/emulator/motor_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tiltmap {

namespace {

double milliseconds(Duration duration) {
  return 1000.0 * secondsOf(duration);
}

// The swing right after a move of usual size, as a fraction of the acceleration times a time constant:
// a few hundredths of a degree, so that a line measured before the end of settling is seen to be wrong.
constexpr double kSwingCounts = 300.0;
constexpr double kSwings = 2.0;  // periods until it has died away

}  // namespace

double MotorModel::Move::at(Instant when) const {
  if (when >= end) return to;
  if (when <= start) return from;
  const double way = std::abs(to - from), sign = to < from ? -1.0 : 1.0;
  const double total = milliseconds(end - start), t = milliseconds(when - start);
  const double ramp = std::min(speed / acceleration, total / 2.0);
  double gone = 0.0;
  if (t < ramp) {
    gone = 0.5 * acceleration * t * t;
  } else if (t <= total - ramp) {
    gone = 0.5 * acceleration * ramp * ramp + acceleration * ramp * (t - ramp);
  } else {
    gone = way - 0.5 * acceleration * (total - t) * (total - t);
  }
  return from + sign * std::clamp(gone, 0.0, way);
}

void MotorModel::forget(Instant before) {
  while (!moves_.empty() && moves_.front().end < before) {
    rest_ = moves_.front().to;
    moves_.pop_front();
  }
}

void MotorModel::moveTo(Instant start, double target, double speed, double acceleration) {
  haltAt(start);
  forget(start - durationOf(kMemoryS));
  Move move{start, start, rawPosition(start), target, speed, acceleration};
  const double way = std::abs(move.to - move.from);
  const double ramps = speed * speed / acceleration;
  const double ms = way >= ramps ? way / speed + speed / acceleration : 2.0 * std::sqrt(way / acceleration);
  move.end = start + durationOf(0.001 * ms);
  end_ = move.end;
  moves_.push_back(move);
}

void MotorModel::haltAt(Instant at) {
  if (moves_.empty() || at >= moves_.back().end) return;
  // What has been gone through stays as it was: the profile up to here, then nothing.
  const double where = moves_.back().at(at);
  moves_.push_back({at, at, where, where, 1.0, 1.0});
  end_ = at;
}

void MotorModel::shift(double counts) {
  rest_ += counts;
  for (Move& move : moves_) {
    move.from += counts;
    move.to += counts;
  }
}

double MotorModel::rawPosition(Instant at) const {
  for (auto move = moves_.rbegin(); move != moves_.rend(); ++move)
    if (at >= move->start) return move->at(at);
  return moves_.empty() ? rest_ : moves_.front().from;
}

double MotorModel::position(Instant at, double settle_s) const {
  const double raw = rawPosition(at);
  if (settle_s <= 0.0) return raw;
  for (auto move = moves_.rbegin(); move != moves_.rend(); ++move) {
    if (at < move->start) continue;
    const double after = secondsOf(at - move->end) / settle_s;
    if (after < 0.0 || after >= 1.0 || move->from == move->to) return raw;
    const double sign = move->to < move->from ? -1.0 : 1.0;
    return raw + sign * kSwingCounts * (1.0 - after) * (1.0 - after) *
                     std::sin(2.0 * std::numbers::pi * kSwings * after);
  }
  return raw;
}

}  // namespace tiltmap
