#include "core/world/simulated_scanner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/scan/beam_tilts.h"

namespace tiltmap {

namespace {

// A place in the spot, in spot diameters from the axis, and its share of the light.
struct SubRay {
  double across, along, share;
};
// Enough where the spot lies on one smooth surface.
constexpr std::array<SubRay, 5> kFew{
    {{0.0, 0.0, 0.28}, {0.3, 0.0, 0.18}, {-0.3, 0.0, 0.18}, {0.0, 0.3, 0.18}, {0.0, -0.3, 0.18}}};
// Where it does not: a ring of eight outside, bright in the middle.
constexpr std::array<SubRay, 13> kMany{{{0.0, 0.0, 0.16},
                                        {0.22, 0.0, 0.12},
                                        {-0.22, 0.0, 0.12},
                                        {0.0, 0.22, 0.12},
                                        {0.0, -0.22, 0.12},
                                        {0.42, 0.0, 0.045},
                                        {-0.42, 0.0, 0.045},
                                        {0.0, 0.42, 0.045},
                                        {0.0, -0.42, 0.045},
                                        {0.3, 0.3, 0.045},
                                        {-0.3, 0.3, 0.045},
                                        {0.3, -0.3, 0.045},
                                        {-0.3, -0.3, 0.045}}};

struct Strike {
  double range_m = 0.0;
  double reflectivity = 0.0;
  double energy = 0.0;
  double share = 0.0;
};

// Cast a little further than the scanner measures, so that "too far" differs from "nothing".
constexpr double kCastBeyond = 1.15;

class Spotlight {
 public:
  Spotlight(const Site& site, const Ray& axis, const Eigen::Vector3d& across, const LmsBeam& beam)
      : site_(site), axis_(axis), across_(across), along_(axis.direction.cross(across)), beam_(beam) {}

  template <std::size_t N>
  std::size_t cast(const std::array<SubRay, N>& pattern, std::array<Strike, 13>& strikes,
                   std::array<bool, 13>& struck) const {
    std::array<Ray, N> rays;
    std::array<std::optional<SurfaceHit>, N> hits;
    for (std::size_t i = 0; i < N; ++i) {
      const Eigen::Vector3d aside = pattern[i].across * across_ + pattern[i].along * along_;
      rays[i] = {axis_.origin + beam_.spot_m * aside, axis_.direction + beam_.divergence_rad * aside};
    }
    site_.cast(rays, kCastBeyond * beam_.maximum_range_m, hits);
    std::size_t count = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const std::optional<SurfaceHit>& hit = hits[i];
      struck[i] = hit.has_value();
      if (!hit) continue;
      // Rough walls and ground send more back at a slant than an ideal diffuse surface: a fifth regardless of
      // angle.
      const double facing = 0.2 + 0.8 * std::abs(hit->normal.dot(axis_.direction));
      const double ideal = 0.1 / (beam_.sensitivity_m * beam_.sensitivity_m);
      Strike& strike = strikes[i];
      strike.range_m = hit->distance_m;
      strike.reflectivity = hit->reflectivity;
      strike.share = pattern[i].share;
      strike.energy = pattern[i].share * hit->reflectivity * facing /
                      std::max(1.0, hit->distance_m * hit->distance_m) / ideal;
      ++count;
    }
    return count;
  }

 private:
  const Site& site_;
  const Ray& axis_;
  const Eigen::Vector3d across_, along_;
  const LmsBeam& beam_;
};

// The first pulse that is strong enough triggers the measurement, and what comes later is ignored
// (thesis 3.1.1); strikes within a pulse's length of its first one shift it by their energy.
Pulse firstPulse(std::array<Strike, 13>& strikes, const std::array<bool, 13>& struck, std::size_t size,
                 double pulse_m) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < size; ++i)
    if (struck[i]) strikes[count++] = strikes[i];
  // By insertion: at most 13, and often in order.
  for (std::size_t i = 1; i < count; ++i) {
    const Strike moved = strikes[i];
    std::size_t k = i;
    for (; k > 0 && strikes[k - 1].range_m > moved.range_m; --k) strikes[k] = strikes[k - 1];
    strikes[k] = moved;
  }
  Pulse strongest;
  for (std::size_t first = 0; first < count;) {
    Pulse pulse;
    double range = 0.0, reflectivity = 0.0, share = 0.0;
    std::size_t i = first;
    for (; i < count && strikes[i].range_m <= strikes[first].range_m + pulse_m; ++i) {
      pulse.energy += strikes[i].energy;
      range += strikes[i].energy * strikes[i].range_m;
      reflectivity += strikes[i].share * strikes[i].reflectivity;
      share += strikes[i].share;
    }
    pulse.any = true;
    pulse.range_m = pulse.energy > 0.0 ? range / pulse.energy : strikes[first].range_m;
    pulse.reflectivity = reflectivity / share;
    if (pulse.energy >= 1.0) return pulse;
    if (!strongest.any || pulse.energy > strongest.energy) strongest = pulse;
    first = i;
  }
  return strongest;
}

Echo echoOf(const Pulse& pulse, const LmsBeam& beam, double range_offset_m, RandomStream& random) {
  // Always the same number of draws, so that one beam's fate does not shift the next one's noise.
  const double lot = random.uniform(), noise = random.normal(), flicker = random.normal(),
               grain = random.normal();
  Echo echo;
  if (!pulse.any) {
    echo.code = lot < 0.7 ? cell_code::kLmsNoSignal : cell_code::kLmsOverflow;
    return echo;
  }
  const double energy = pulse.energy * std::exp(0.12 * flicker);
  if (energy < 1.0) {
    // Far below the threshold there is no stop signal at all; just below it the noise is too large (1FFB).
    echo.code = energy < 0.6 ? cell_code::kLmsNoSignal : CellCode{8187};
    return echo;
  }
  double range = pulse.range_m - range_offset_m + beam.noise_m * noise;
  if (beam.resolution_m > 0.0) range = std::round(range / beam.resolution_m) * beam.resolution_m;
  if (range > beam.maximum_range_m || !(range > 0.0)) {
    echo.code = range > 0.0 ? cell_code::kLmsFirst : cell_code::kLmsOverflow;
    return echo;
  }
  echo.range_m = static_cast<float>(range);
  echo.code = cell_code::kMeasured;
  echo.intensity = static_cast<float>(
      std::clamp(std::round(255.0 * pulse.reflectivity * (1.0 + 0.03 * grain)), 1.0, 255.0));
  return echo;
}

}  // namespace

double beamDelay(const ScannerGeometry& geometry, const LmsBeam& beam, int column) {
  const double turns = beamTurns(geometry, column);
  return beam.turn_s * (beam.interlaced ? turns : turns - column % mirrorTurns(geometry));
}

double lineDuration(const ScannerGeometry& geometry, const LmsBeam& beam) {
  return beam.turn_s * (beam.interlaced ? mirrorTurns(geometry) : 1);
}

Pulse castPulse(const Site& site, const Ray& axis, const Eigen::Vector3d& across, const LmsBeam& beam) {
  const Spotlight spotlight(site, axis, across, beam);
  std::array<Strike, 13> strikes;
  std::array<bool, 13> struck{};
  std::size_t size = kFew.size();
  const std::size_t count = spotlight.cast(kFew, strikes, struck);
  if (count == 0) return {};
  // On a plane the ranges to both sides of the axis add up to twice the middle one, nearly.
  const auto smooth = [&] {
    const double middle = 2.0 * strikes[0].range_m;
    return std::abs(strikes[1].range_m + strikes[2].range_m - middle) < 0.02 &&
           std::abs(strikes[3].range_m + strikes[4].range_m - middle) < 0.02;
  };
  if (count < kFew.size() || !smooth()) {
    size = kMany.size();
    spotlight.cast(kMany, strikes, struck);
  }
  return firstPulse(strikes, struck, size, beam.pulse_m);
}

std::vector<Echo> castLine(const Site& site, const Pose& site_from_scan, const ScannerGeometry& geometry,
                           const TiltFunction& tilt, double start_time_s, RandomStream random,
                           const LmsBeam& beam) {
  std::vector<Echo> echoes;
  echoes.reserve(static_cast<std::size_t>(geometry.columns));
  const Eigen::Matrix3d rotation = site_from_scan.rotation();
  for (int column = 0; column < geometry.columns; ++column) {
    const double e = tilt(start_time_s + beamDelay(geometry, beam, column));
    const double a = geometry.azimuthOfColumn(column);
    // The mirror centre is where a beam of no length ends.
    const Ray axis{site_from_scan * geometry.point(e, a, -geometry.range_offset_m),
                   rotation * geometry.direction(e, a)};
    const Eigen::Vector3d across = rotation * geometry.direction(e, a + 90.0 * kDegree);
    echoes.push_back(echoOf(castPulse(site, axis, across, beam), beam, geometry.range_offset_m, random));
  }
  return echoes;
}

}  // namespace tiltmap
