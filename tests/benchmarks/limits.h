// What the preset `default` promises on simulated pairs.
#pragma once

#include <string>
#include <vector>

#include "tests/benchmarks/pair_run.h"

namespace tiltmap::benchmarks {

inline constexpr double kMedianLimitM = 0.006;
inline constexpr double kMedianLimitDeg = 0.05;
inline constexpr double kWorstLimitM = 0.025;

// A sentence for each promise that the measurements break: the errors of "Tiltmap default", its time against
// PCL's GICP pair by pair (where that was measured), and that `thesis` is the worse one. Empty: all kept.
std::vector<std::string> brokenLimits(const std::vector<PairMethod>& methods,
                                      const std::vector<PairMeasurement>& measurements);

}  // namespace tiltmap::benchmarks
