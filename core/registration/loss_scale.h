// How far a residual may be off before it loses its weight.
#pragma once

#include <vector>

namespace tiltmap {

// Scale of the Geman-McClure loss, and what is added to the variance of a pair of patches.
struct LossScale {
  LossScale(double metres = 0.0) : scale_m(metres) {}  // NOLINT: a plain number is an absolute scale
  // Each residual by its own deviation, which is that of its patches and the excess together.
  static LossScale ofOwnDeviation(double deviations, double excess_m) {
    LossScale scale(excess_m);
    scale.deviations = deviations;
    return scale;
  }
  bool isOwn() const { return deviations > 0.0; }

  double scale_m = 0.0;     // 0: no loss; own deviation: the excess
  double deviations = 0.0;  // 0: the scale is scale_m, the same for all
};

// The deviation, metres, that the patches' own variances leave unexplained: with it added, residuals spread
// as normal ones would. 0 where nothing is left. An estimator of a variance between studies (Mandel and Paule
// 1970), ours by ranks: first by the lower quarter, since where scans share little more than half of the
// pairs may be wrong, then three times by the median of what lies within three deviations. Of many at most
// 500 are looked at, evenly spread. Both of the same size; 0 where they are empty.
double excessDeviation(const std::vector<double>& residuals_m, const std::vector<double>& variances_m2);

// The median of at most 500 of the values, evenly spread.
double typicalOf(const std::vector<double>& values);

}  // namespace tiltmap
