#include "tests/benchmarks/limits.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

namespace tiltmap::benchmarks {

namespace {

std::string sentence(const char* format, double value, double limit) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, value, limit);
  return text.data();
}

std::vector<const PairMeasurement*> measurementsOf(const std::string& name,
                                                   const std::vector<PairMethod>& methods,
                                                   const std::vector<PairMeasurement>& measurements) {
  std::vector<const PairMeasurement*> own;
  for (const PairMeasurement& m : measurements)
    if (methods[m.method].name == name) own.push_back(&m);
  return own;
}

double medianError(const std::vector<const PairMeasurement*>& own) {
  std::vector<double> metres;
  for (const PairMeasurement* m : own) metres.push_back(m->error.translation_m);
  return median(metres);
}

}  // namespace

std::vector<std::string> brokenLimits(const std::vector<PairMethod>& methods,
                                      const std::vector<PairMeasurement>& measurements) {
  std::vector<std::string> broken;
  const auto ours = measurementsOf("Tiltmap default", methods, measurements);
  const auto thesis = measurementsOf("Tiltmap thesis", methods, measurements);
  const auto gicp = measurementsOf("PCL GICP", methods, measurements);
  if (ours.empty()) return {"nothing was measured"};
  std::vector<double> radians;
  double worst_m = 0.0;
  std::size_t failed = 0;
  for (const PairMeasurement* m : ours) {
    radians.push_back(m->error.rotation_rad);
    worst_m = std::max(worst_m, m->error.translation_m);
    failed += m->fixed_from_moving ? 0 : 1;
  }
  const double median_m = medianError(ours);
  const double median_deg = median(radians) / kDegree;
  if (failed > 0) broken.push_back(std::to_string(failed) + " pairs gave up");
  if (median_m > kMedianLimitM)
    broken.push_back(sentence("median error %.2f mm, allowed %.2f", median_m * 1e3, kMedianLimitM * 1e3));
  if (median_deg > kMedianLimitDeg)
    broken.push_back(sentence("median error %.4f deg, allowed %.4f", median_deg, kMedianLimitDeg));
  if (worst_m > kWorstLimitM)
    broken.push_back(sentence("worst error %.2f mm, allowed %.2f", worst_m * 1e3, kWorstLimitM * 1e3));
  // Both lists run through the same pairs in the same order. CPU time: both use one thread, and it does not
  // count what other programs on the machine do.
  for (std::size_t i = 0; i < std::min(ours.size(), gicp.size()); ++i)
    if (ours[i]->timing.cpu_ms > gicp[i]->timing.cpu_ms)
      broken.push_back("pair " + std::to_string(i) + ": " +
                       sentence("%.2f ms, PCL's GICP %.2f", ours[i]->timing.cpu_ms, gicp[i]->timing.cpu_ms));
  if (!thesis.empty() && medianError(thesis) <= median_m)
    broken.push_back("the preset thesis is not worse than default");
  return broken;
}

}  // namespace tiltmap::benchmarks
