// Running several methods over several pairs, turn by turn.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/benchmarks/pair_method.h"
#include "tests/benchmarks/stopwatch.h"
#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

struct PairMeasurement {
  std::size_t problem = 0;
  std::size_t method = 0;
  Timing timing;                          // quietest round
  std::optional<Pose> fixed_from_moving;  // nothing: it failed, or took back its result
  // Against the truth, where there is one; of a failed pair that of its start, which is what a user is left
  // with.
  PoseDifference error;
  double times_floor = 0.0;  // the error in translation over the pair's noise floor, where that is known
};

// The turns go A B C, A B C over the methods within each pair, so that a disturbance of the machine hits all
// alike. Result: problem by problem, one entry a method. `tell` hears about each pair.
std::vector<PairMeasurement> runPairs(const std::vector<PairProblem>& problems,
                                      const std::vector<PairMethod>& methods, int rounds,
                                      const std::function<void(const std::string&)>& tell);

double median(std::vector<double> values);                  // 0 for none
double quantile(std::vector<double> values, double share);  // 0 for none

// One row a method: median time, median, 95 % and worst error against the truth, share within 2 cm. The first
// method is ours.
void addPairRows(Table& table, const std::string& subject, const std::vector<PairMethod>& methods,
                 const std::vector<PairMeasurement>& measurements);

}  // namespace tiltmap::benchmarks
