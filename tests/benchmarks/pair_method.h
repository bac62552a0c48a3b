// One way to register a pair of scans, ours or a peer's, behind one face.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/registration/registration_settings.h"
#include "core/scan/range_image.h"
#include "tests/benchmarks/noise_floor.h"

namespace tiltmap::benchmarks {

// Two scans, where the search starts, and where it should end if that is known.
struct PairProblem {
  std::string name;
  Scan fixed;
  Scan moving;
  Pose start_fixed_from_moving;
  std::optional<Pose> true_fixed_from_moving;
  std::optional<NoiseFloor> floor{};  // of simulated pairs
};

// What is timed: from the scans in memory, in the method's own type, to the pose. All preparation (thinning,
// normals, covariances, trees) lies inside. Called several times; keeps nothing from one call to the next.
using TimedJob = std::function<Result<Pose>()>;

struct PairMethod {
  std::string name;
  // Brings the scans into the method's own type; not timed. Ours are the raw matrices. A peer gets a cloud of
  // the points, so that computing points from ranges is counted for us and not for the peer.
  std::function<TimedJob(const PairProblem&)> load;
};

// What every peer is told, as far as it takes it: thinned to cubes of 0.5 m, pairs up to 3 m apart, at most
// 60 iterations.
inline constexpr double kVoxelM = 0.5;
inline constexpr double kPairDistanceM = 3.0;
inline constexpr int kIterations = 60;
// Neighbours for normals and covariances, where the peer needs any.
inline constexpr int kNeighbours = 20;

PairMethod ownMethod(const std::string& name, const RegistrationSettings& settings);
std::vector<PairMethod> ownMethods();  // the presets default and thesis
std::vector<PairMethod> pclMethods();
std::vector<PairMethod> open3dMethods();

}  // namespace tiltmap::benchmarks
