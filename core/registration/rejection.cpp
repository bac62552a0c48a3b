#include "core/registration/rejection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/registration/registration_settings.h"

namespace tiltmap {

namespace {

using Pairs = std::span<Correspondence>;

template <class Test>
void rejectWhere(Pairs pairs, RejectReason reason, Test&& test) {
  for (Correspondence& pair : pairs)
    if (pair.kept() && test(pair)) pair.reason = reason;
}

void rejectWithoutNormals(const RegistrationSettings& settings, RejectionState&, Pairs pairs) {
  const bool needed = settings.max_angle_rad < std::numbers::pi - 1e-9 ||
                      settings.motion == MotionMethod::PointToPlane ||
                      settings.motion == MotionMethod::PlaneToPlane;
  if (needed)
    rejectWhere(pairs, RejectReason::NoNormal, [](const Correspondence& p) { return !p.has_normals; });
}

void rejectFar(const RegistrationSettings&, RejectionState& state, Pairs pairs) {
  if (state.distance_bound_m <= 0.0) return;
  const auto bound = static_cast<float>(state.distance_bound_m);
  rejectWhere(pairs, RejectReason::TooFar, [bound](const Correspondence& p) { return p.distance_m > bound; });
}

void rejectByAngle(const RegistrationSettings& settings, RejectionState&, Pairs pairs) {
  const auto bound = static_cast<float>(std::cos(settings.max_angle_rad));
  rejectWhere(pairs, RejectReason::NormalDisagrees,
              [bound](const Correspondence& p) { return p.has_normals && p.cos_angle < bound; });
}

void rejectByStatistics(const RegistrationSettings& settings, RejectionState& state, Pairs pairs) {
  if (!settings.statistics) return;
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const Correspondence& pair : pairs)
    if (pair.kept()) distances.push_back(static_cast<double>(pair.distance_m));
  if (distances.empty()) return;
  double bound = zhangBound(distances, settings.statistics_distance_m);
  if (settings.max_distance_m > 0.0) bound = std::min(bound, settings.max_distance_m);
  state.distance_bound_m = bound;  // also the distance bound of the next step
  rejectWhere(pairs, RejectReason::Statistics,
              [bound](const Correspondence& p) { return static_cast<double>(p.distance_m) > bound; });
}

// The rules, in order. A new one is a function above and a line here.
constexpr void (*kRules[])(const RegistrationSettings&, RejectionState&, Pairs) = {
    rejectWithoutNormals,
    rejectFar,
    rejectByAngle,
    rejectByStatistics,
};

double valleyAfterPeak(std::span<const double> distances) {
  constexpr std::size_t kBins = 20;
  const double largest = *std::ranges::max_element(distances);
  if (!(largest > 0.0)) return largest;
  std::array<std::size_t, kBins> histogram{};
  for (const double d : distances)
    ++histogram[std::min(kBins - 1, static_cast<std::size_t>(d / largest * static_cast<double>(kBins)))];
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(histogram) - histogram.begin());
  for (std::size_t bin = peak + 1; bin < kBins; ++bin)
    if (10 * histogram[bin] <= 6 * histogram[peak])
      return largest * (static_cast<double>(bin) + 0.5) / static_cast<double>(kBins);
  return largest;
}

}  // namespace

std::string rejectReasonName(RejectReason reason) {
  switch (reason) {
    case RejectReason::None:
      return "kept";
    case RejectReason::NoPartner:
      return "no partner";
    case RejectReason::NoNormal:
      return "no normal";
    case RejectReason::TooFar:
      return "too far";
    case RejectReason::NormalDisagrees:
      return "normal disagrees";
    case RejectReason::Statistics:
      return "statistics";
  }
  throw std::invalid_argument("rejectReasonName: no such reason");
}

RejectionCounts applyRejection(const RegistrationSettings& settings, RejectionState& state, Pairs pairs) {
  for (const auto rule : kRules) rule(settings, state, pairs);
  RejectionCounts counts{};
  for (const Correspondence& pair : pairs) ++counts[static_cast<std::size_t>(pair.reason)];
  return counts;
}

double zhangBound(std::span<const double> distances_m, double good_distance_m) {
  if (distances_m.empty() || !(good_distance_m > 0.0))
    throw std::invalid_argument("zhangBound: needs distances and a positive D");
  const double n = static_cast<double>(distances_m.size());
  double sum = 0.0, square = 0.0;
  for (const double d : distances_m) sum += d;
  const double mean = sum / n;
  for (const double d : distances_m) square += (d - mean) * (d - mean);
  const double deviation = std::sqrt(square / n);
  if (mean < good_distance_m) return mean + 3.0 * deviation;
  if (mean < 3.0 * good_distance_m) return mean + 2.0 * deviation;
  if (mean < 6.0 * good_distance_m) return mean + deviation;
  return valleyAfterPeak(distances_m);
}

void addRejectionParameters(ParameterTable<RegistrationSettings>& table) {
  table.real("max-distance", &RegistrationSettings::max_distance_m, "m", 0.0, 1000.0,
             "Pairs further apart than this are rejected at the start; 0 sets no bound. Too small a bound "
             "lets scans "
             "slide along walls.",
             "thesis 4.2.4; value ours");
  table.angle("max-angle", &RegistrationSettings::max_angle_rad, 0.0, 180.0,
              "Pairs whose normals differ by more are rejected; 180 sets no bound.",
              "thesis 4.2.4; value ours");
  table.boolean(
      "statistics", &RegistrationSettings::statistics,
      "Reject pairs beyond a bound from the mean and deviation of the distances, and use it as the next "
      "distance bound.",
      "Zhang 1994; thesis 4.2.1 step 5");
  table.real("statistics-distance", &RegistrationSettings::statistics_distance_m, "m", 0.001, 100.0,
             "Zhang's D: the mean pair distance below which a registration counts as good.",
             "Zhang 1994; value ours");
}

}  // namespace tiltmap
