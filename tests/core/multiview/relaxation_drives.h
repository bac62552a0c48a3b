// Simulated drives, prepared and chained once for all tests of this program.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/multiview/relaxation.h"
#include "core/registration/register_pair.h"
#include "core/world/experiment.h"

namespace tiltmap::relaxation_test {

struct Drive {
  std::vector<Scan> scans;
  std::vector<Pose> truth;
  std::vector<Pose> chained;              // pairwise registration, scan after scan
  std::vector<PreparedScanPtr> prepared;  // for the default relaxation
};

// Each one once, with the number of stops (0: the experiment's own) of the first call.
inline const Drive& drive(ExperimentId id, std::uint64_t seed, int stops_wished = 0) {
  static std::map<std::pair<ExperimentId, std::uint64_t>, Drive> drives;
  Drive& made = drives[{id, seed}];
  if (!made.scans.empty()) return made;
  std::vector<SimulatedStop> stops = simulateExperiment(id, seed, stops_wished, 2).value();
  for (SimulatedStop& stop : stops) {
    made.truth.push_back(stop.truth);
    made.scans.push_back(std::move(stop.scan));
  }
  const RegistrationSettings settings;
  std::vector<Pose> links;
  for (std::size_t i = 0; i + 1 < made.scans.size(); ++i) {
    const Pose start = made.scans[i].odometry.inverse() * made.scans[i + 1].odometry;
    const auto pair = registerPair(made.scans[i], made.scans[i + 1], start, settings);
    links.push_back(pair && pair->succeeded() ? pair->fixed_from_moving : start);
  }
  made.chained = chained(Pose(), links);
  made.prepared = prepareAll(made.scans, RelaxationSettings(), 2).value();
  return made;
}

struct Errors {
  double rms_m = 0.0, rms_deg = 0.0;
};

inline Errors errorsOf(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  Errors errors;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseDifference off = difference(poses[i], truth[i]);
    errors.rms_m += off.translation_m * off.translation_m;
    errors.rms_deg += off.rotation_rad * off.rotation_rad / (kDegree * kDegree);
  }
  const auto count = static_cast<double>(poses.size());
  return {std::sqrt(errors.rms_m / count), std::sqrt(errors.rms_deg / count)};
}

// Everyone but scan 0 off by a few centimetres and tenths of a degree.
inline std::vector<Pose> perturbed(const std::vector<Pose>& poses, double shift_m, double turn_rad,
                                   std::uint64_t seed) {
  std::vector<Pose> result = poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    RandomStream random = RandomStream::keyed({seed, i});
    Vector6d d;
    for (int k = 0; k < 6; ++k) d[k] = random.normal() * (k < 3 ? turn_rad : shift_m);
    result[i] = poses[i] * Pose().moved(d);
  }
  return result;
}

inline bool sameBits(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].quaternion().coeffs() != b[i].quaternion().coeffs() || a[i].translation() != b[i].translation())
      return false;
  return true;
}

inline PreparedScanPtr emptyScan() {
  return std::make_shared<PreparedScan>();
}

}  // namespace tiltmap::relaxation_test
