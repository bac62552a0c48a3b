#include <stdexcept>

#include "tests/benchmarks/pair_sets.h"

namespace tiltmap::benchmarks {

std::vector<PairProblem> simulatedPairs(ExperimentId experiment, std::uint64_t seed) {
  const Result<Experiment> drive = Experiment::make(experiment, seed);
  if (!drive) throw std::runtime_error(drive.error().what);
  const Result<std::vector<SimulatedStop>> stops = drive->simulateAll(0);
  if (!stops) throw std::runtime_error(stops.error().what);
  const std::vector<NoiseFloor> floors = pairFloors(*drive, *stops);
  std::vector<PairProblem> pairs;
  for (std::size_t i = 0; i + 1 < stops->size(); ++i) {
    const SimulatedStop& fixed = (*stops)[i];
    const SimulatedStop& moving = (*stops)[i + 1];
    pairs.push_back({std::string(nameOf(experiment)) + " seed " + std::to_string(seed) + ", pair " +
                         std::to_string(i) + ":" + std::to_string(i + 1),
                     fixed.scan, moving.scan, fixed.scan.odometry.inverse() * moving.scan.odometry,
                     fixed.truth.inverse() * moving.truth, floors[i]});
  }
  return pairs;
}

}  // namespace tiltmap::benchmarks
