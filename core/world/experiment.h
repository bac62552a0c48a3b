// Drives through simulated sites: the thesis' two experiments, a closed loop, a long survey.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/scan/range_image.h"
#include "core/world/simulated_scanner.h"
#include "core/world/site.h"

namespace tiltmap {

enum class ExperimentId {
  Exp1,       // thesis chapter 5: 5 stops
  Exp2,       // thesis chapter 6: 14 stops, odometry as printed, with its two wrong rows
  Exp2Fixed,  // the same with those rows mended
  Loop,       // 40 stops round a block, back to the start
  Survey,     // a long drive along the streets
};

// "exp1", "exp2", "exp2fixed", "loop", "survey".
std::string_view nameOf(ExperimentId id);
Result<ExperimentId> experimentNamed(std::string_view name);
// Stops without a wish: 5, 14, 14, 40, 50.
int defaultStops(ExperimentId id);

struct StopPoses {
  Pose odometry;  // world_from_scan as measured: planar; stop 0 is the identity
  Pose truth;     // world_from_scan; stop 0 is the identity
};

struct SimulatedStop {
  Scan scan;  // its odometry is StopPoses::odometry
  Pose truth;
};

// How a drive is scanned.
struct SimulationSettings {
  ScannerGeometry geometry;  // stored with each scan
  // What the scanner is really like, where that differs from what the scans claim: planted calibration
  // errors. Its matrix must have the same size.
  std::optional<ScannerGeometry> true_geometry;
  LmsBeam beam;
  bool continuous_tilt =
      false;  // the tilt moves on steadily during a line, one step a line; else it stands still
  double line_period_s = 0.32;  // from line to line: measuring, sending, and the step
  double drive_s = 60.0;        // from the end of a scan to the start of the next
};

// One experiment with a seed: its stops, and the site around each of them. Loop and Survey get another street
// grid for every seed. Exp1, Exp2 and Exp2Fixed were driven in one car park: its houses, lamps, trees and taken
// bays are the same for every seed to within 0.3 m; details (windows, cars' shapes and places, crowns, clutter,
// terrain, reflectivity) and the stops' roll are the seed's. Their stops are the thesis'. Cheap to copy.
class Experiment {
 public:
  // stops 0: the default number. Fewer are the first ones; more only for Loop (closer together, same course)
  // and Survey (further along). Refuses a number below zero, or more than the tables have.
  static Result<Experiment> make(ExperimentId id, std::uint64_t seed = 1, int stops = 0);

  ExperimentId id() const;
  std::uint64_t seed() const;
  int stops() const;
  const std::vector<StopPoses>& poses() const;

  // The site as far as the scanner sees from this stop. In the site frame z is against gravity; for the
  // thesis' experiments it is the world frame itself.
  std::shared_ptr<const Site> siteAt(int stop) const;
  Pose siteFromWorld() const;
  Pose siteFromScan(int stop) const {
    return siteFromWorld() * poses()[static_cast<std::size_t>(stop)].truth;
  }

  // One stop; lines are shared among the threads. Fails only when cancelled, or when the settings do not fit.
  Result<SimulatedStop> simulate(int stop, int threads, const JobControl& job = {},
                                 const SimulationSettings& settings = {}) const;
  // All stops, shared among the threads. The bytes depend on neither the threads nor the number of stops.
  Result<std::vector<SimulatedStop>> simulateAll(int threads, const JobControl& job = {},
                                                 const SimulationSettings& settings = {}) const;

 private:
  struct Plan;
  explicit Experiment(std::shared_ptr<const Plan> plan) : plan_(std::move(plan)) {}
  Result<SimulatedStop> simulateIn(const Site& site, int stop, int threads, const JobControl& job,
                                   const SimulationSettings& settings, bool report) const;
  std::shared_ptr<const Plan> plan_;
};

// Experiment::make and simulateAll in one.
Result<std::vector<SimulatedStop>> simulateExperiment(ExperimentId id, std::uint64_t seed, int stops,
                                                      int threads, const JobControl& job = {},
                                                      const SimulationSettings& settings = {});
// Odometry and truth alone: no site, no rays.
Result<std::vector<StopPoses>> experimentPoses(ExperimentId id, std::uint64_t seed, int stops);

}  // namespace tiltmap
