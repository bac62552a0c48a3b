#include "core/registration/loss_scale.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/ranks.h"

namespace tiltmap {

namespace {

constexpr double kQuarterSquare = 0.1015310;  // a normal variate's square is below this for one in four
constexpr double kMedianSquare = 0.4549364;   // the same for one in two
constexpr double kFittingSquare = 9.0;        // three deviations
constexpr int kRounds = 5;                    // the ratio is within a percent of 1 after three
constexpr int kTrimmedRounds = 3;
constexpr double kEnough = 0.02;
constexpr std::size_t kEnoughValues = 500;

// Evenly spread, as many as tell a scale within a few percent.
std::vector<double> sampled(const std::vector<double>& all) {
  const std::size_t step = (all.size() + kEnoughValues - 1) / kEnoughValues;
  std::vector<double> some;
  some.reserve(kEnoughValues);
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace

double typicalOf(const std::vector<double>& values) {
  if (values.empty()) throw std::invalid_argument("typicalOf: no values");
  std::vector<double> some = sampled(values);
  return valueAtRank(some, some.size() / 2);
}

double excessDeviation(const std::vector<double>& all_residuals_m,
                       const std::vector<double>& all_variances_m2) {
  if (all_residuals_m.size() != all_variances_m2.size())
    throw std::invalid_argument("excessDeviation: residuals and variances differ in number");
  if (all_residuals_m.empty()) return 0.0;
  const std::vector<double> residuals_m = sampled(all_residuals_m), variances_m2 = sampled(all_variances_m2);
  const auto square = [&](std::size_t i, double excess) {
    return residuals_m[i] * residuals_m[i] / (variances_m2[i] + excess);
  };
  double excess = 0.0;  // m^2
  double typical = medianOf(variances_m2);
  std::vector<double> squares, variances;
  // Whether there is more to come.
  const auto take = [&](double ratio) {
    excess = std::max(0.0, (typical + excess) * ratio - typical);
    return excess > 0.0 && std::abs(ratio - 1.0) > kEnough;
  };
  for (int round = 0; round < kRounds; ++round) {
    squares.clear();
    for (std::size_t i = 0; i < residuals_m.size(); ++i) squares.push_back(square(i, excess));
    if (!take(valueAtRank(squares, squares.size() / 4) / kQuarterSquare)) break;
  }
  for (int round = 0; round < kTrimmedRounds; ++round) {
    squares.clear(), variances.clear();
    for (std::size_t i = 0; i < residuals_m.size(); ++i) {
      const double s = square(i, excess);
      if (s < kFittingSquare) squares.push_back(s), variances.push_back(variances_m2[i]);
    }
    if (squares.empty()) break;
    typical = valueAtRank(variances, variances.size() / 2);
    if (!take(valueAtRank(squares, squares.size() / 2) / kMedianSquare)) break;
  }
  return std::sqrt(excess);
}

}  // namespace tiltmap
