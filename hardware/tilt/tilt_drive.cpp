#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/text.h"
#include "core/geometry/pose.h"
#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {

namespace {

double countsPerRadian(const TiltDrive& drive) {
  return drive.counts_per_turn / (2.0 * std::numbers::pi);
}

}  // namespace

std::string angleText(double angle_rad) {
  return fixedReal(angle_rad / kDegree, 2) + " deg";
}

Status withinLimits(double angle_rad, double minimum_rad, double maximum_rad, const std::string& name,
                    const std::string& given_with) {
  if (angle_rad >= minimum_rad - 1e-9 && angle_rad <= maximum_rad + 1e-9) return {};
  return fail("a tilt of " + angleText(angle_rad) + " lies outside the limits " + angleText(minimum_rad) +
                  " to " + angleText(maximum_rad),
              name,
              "choose start, step and lines within them, or give other limits (min, max) " + given_with);
}

double TiltDrive::angleOf(std::int64_t counts) const {
  return static_cast<double>(counts - level_count) / countsPerRadian(*this);
}

std::int64_t TiltDrive::countsOf(double angle_rad) const {
  return level_count + std::llround(angle_rad * countsPerRadian(*this));
}

double TiltDrive::moveDuration(double counts) const {
  const double way = std::abs(counts);
  const double ramps = speed * speed / acceleration;  // up and down together
  const double ms = way >= ramps ? way / speed + speed / acceleration : 2.0 * std::sqrt(way / acceleration);
  return 0.001 * ms;
}

double TiltDrive::longestSegment() const {
  // A twentieth is left to the line and to a controller that is a little slower than it was told to be.
  const double ms = 950.0 * longest_segment_s;
  const double ramp = speed / acceleration;
  return std::floor(ms >= 2.0 * ramp ? speed * (ms - ramp) : acceleration * ms * ms / 4.0);
}

Status TiltDrive::check() const {
  const auto refuse = [](const std::string& what, const std::string& remedy) {
    return fail(what, "settings of the tilt unit", remedy);
  };
  for (const double number : {counts_per_turn, minimum_rad, maximum_rad, speed, acceleration, settle_s,
                              tolerance_rad, approach_rad, longest_segment_s})
    if (!std::isfinite(number)) return refuse("a setting is not a number", "give numbers");
  if (std::abs(counts_per_turn) < 360.0)
    return refuse("an encoder of " + shortestReal(counts_per_turn) + " counts per turn is too coarse",
                  "give the counts per turn of the output shaft, 3125248 for the thesis' gear");
  if (!(minimum_rad < maximum_rad))
    return refuse("the lower limit does not lie below the upper one", "give min below max");
  if (!(speed > 0.0 && speed <= 200.0))
    return refuse("a speed of " + shortestReal(speed) + " counts/ms is more than motor and gear take",
                  "give a speed above 0 and at most 200");
  if (!(acceleration > 0.0 && acceleration <= 20.0))
    return refuse("an acceleration of " + shortestReal(acceleration) + " counts/ms2 makes no sense",
                  "give more than 0 and at most 20");
  if (settle_s < 0.0 || approach_rad < 0.0 || !(tolerance_rad > 0.0) || !(longest_segment_s > 0.0))
    return refuse("a time or an angle is negative", "give positive numbers");
  if (longest_segment_s > 0.2)
    return refuse("moves of more than 200 ms could not be stopped in time", "give at most 0.2 s");
  if (longestSegment() < 1.0)
    return refuse("so slow a motor moves nothing within a segment", "give more speed or acceleration");
  return {};
}

std::vector<std::int64_t> segmentsOf(const TiltDrive& drive, std::int64_t from, std::int64_t to) {
  std::vector<std::int64_t> stations;
  const auto leg = [&](std::int64_t begin, std::int64_t end) {
    const double way = static_cast<double>(end - begin);
    const auto parts =
        static_cast<std::int64_t>(std::max(1.0, std::ceil(std::abs(way) / drive.longestSegment())));
    for (std::int64_t i = 1; i <= parts; ++i)
      stations.push_back(begin + std::llround(way * static_cast<double>(i) / static_cast<double>(parts)));
  };
  if (drive.angleOf(from) > drive.angleOf(to)) {
    const double below =
        std::max(drive.angleOf(to) - drive.approach_rad, std::min(drive.minimum_rad, drive.angleOf(to)));
    const std::int64_t turn = drive.countsOf(below);
    if (turn != to) {
      leg(from, turn);
      from = turn;
    }
  }
  leg(from, to);
  return stations;
}

}  // namespace tiltmap
