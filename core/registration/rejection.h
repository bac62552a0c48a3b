// Which pairs are not used for the motion, and why. One rule in one place: to add a rule, add its reason and
// its settings here, and its function and its parameters in rejection.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tiltmap {

struct RegistrationSettings;
template <class Settings>
class ParameterTable;

// Why a pair was not used. A reason of the pair choice (nothing to pair with) stands first; then the rules,
// in the order in which they are tried.
enum class RejectReason : std::uint8_t {
  None,             // kept
  NoPartner,        // the pair choice found no candidate
  NoNormal,         // a normal is needed, and one of the two has none
  TooFar,           // further apart than the distance bound of the step
  NormalDisagrees,  // the normals differ by more than the angle bound
  Statistics,       // beyond the bound of Zhang's statistics
};
inline constexpr std::size_t kRejectReasons = 6;
std::string rejectReasonName(RejectReason reason);  // "too far"

// Pairs by reason; the entry of None is the number kept.
using RejectionCounts = std::array<std::size_t, kRejectReasons>;

// One pair of a step, kept or not. Indices into the elements of the prepared scans; what was rejected stays,
// so that it can be drawn.
struct Correspondence {
  std::uint32_t fixed = 0;
  std::uint32_t moving = 0;
  float distance_m = 0.0F;  // of the two positions, at the pose the pair was found at
  float cos_angle = 1.0F;   // between the two normals at that pose; 1 where one is missing
  RejectReason reason = RejectReason::None;
  bool has_normals = false;
  bool from_fixed = false;  // found from the fixed scan's side (both directions)

  bool kept() const { return reason == RejectReason::None; }
};

// What rules may be told. RegistrationSettings carries these as its own members.
struct RejectionSettings {
  double max_distance_m = 0.0;                // bound on the distance of a pair at the start; 0: no bound
  double max_angle_rad = 0.6108652381980153;  // 35 deg between normals; pi: no bound
  bool statistics = false;                    // Zhang 1994
  double statistics_distance_m = 0.5;         // Zhang's D: mean pair distance of a good registration
};

// What the rules share within one step.
struct RejectionState {
  double distance_bound_m =
      0.0;  // in and out: Zhang's statistics set the bound of this and the next step; 0: none
};

// Applies every rule in turn and counts by reason. Pairs already rejected are left alone.
RejectionCounts applyRejection(const RegistrationSettings& settings, RejectionState& state,
                               std::span<Correspondence> pairs);

// Zhang's bound from the distances of the pairs (Zhang 1994, 4.2; thesis 4.2.1 step 5): mean below D gives
// mean + 3 dev, below 3 D mean + 2 dev, below 6 D mean + dev; else the valley after the peak of the distance
// histogram (ours: 20 bins to the largest distance, the first bin after the highest whose count is at most 60
// % of it). Distances in metres, not empty, D > 0.
double zhangBound(std::span<const double> distances_m, double good_distance_m);

void addRejectionParameters(ParameterTable<RegistrationSettings>& table);

}  // namespace tiltmap
