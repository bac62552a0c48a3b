#include "core/project/operations/relax_increment.h"

#include <algorithm>

#include "core/project/link_what_if.h"

namespace tiltmap {

namespace {

constexpr double kLeastReach_m = 30.0;
constexpr double kMostReach_m = 150.0;
constexpr double kReachMargin = 1.2;  // added scans may see further than the ones before
constexpr int kNearestTimes = 2;      // times max-links: scans that are looked at for one added scan
constexpr double kStays_m = 1e-4;     // the outermost scans
constexpr double kStays_rad = 1e-5;
constexpr double kStands_m = 0.5;  // an overlap of two scans that have moved so far is another one
constexpr double kStands_rad = 1.0 * kDegree;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

bool speaks(const Link& link) {
  return link.usable() && link.origin != LinkOrigin::Odometry &&
         (link.information || link.origin == LinkOrigin::ByHand);
}

class Increment {
 public:
  Increment(const ProjectSnapshot& snapshot, const RelaxationInput& input, const std::vector<Link>& links,
            const std::vector<int>& added, const std::vector<int>& around)
      : input_(input), settled_(input.scans.size(), 1), ties_(input.scans.size()) {
    for (const int i : added) settled_[at(i)] = 0;
    from_ = around;
    for (const Link& link : links) {
      const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
      if (!fixed || !moving || !speaks(link) || !settled_[*fixed] || !settled_[*moving]) continue;
      const int a = static_cast<int>(*fixed), b = static_cast<int>(*moving);
      ties_[*fixed].push_back(b);
      ties_[*moving].push_back(a);
      priors_.push_back({a, b, input.world_from_scan[*fixed].inverse() * input.world_from_scan[*moving],
                         link.information.value_or(informationByHand()), false});
    }
  }

  // How many links each scan is from those around, at most `rings`; -1: further.
  std::vector<int> ringsOf(int rings) const {
    std::vector<int> ring(settled_.size(), -1);
    std::vector<int> open = from_;
    for (const int i : open) ring[at(i)] = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const int here = ring[at(open[k])];
      if (here == rings) continue;
      for (const int next : ties_[at(open[k])])
        if (ring[at(next)] < 0) ring[at(next)] = here + 1, open.push_back(next);
    }
    return ring;
  }

  RelaxationInput inputFor(const std::vector<int>& ring) const {
    RelaxationInput input = input_;
    input.settled = settled_;
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (ring[i] < 0) input.pins.push_back(static_cast<int>(i));
    std::erase_if(input.constraints, [this](const PoseConstraint& c) {
      return settled_[at(c.fixed)] && settled_[at(c.moving)];
    });
    for (const PoseConstraint& prior : priors_)
      if (ring[at(prior.fixed)] >= 0 || ring[at(prior.moving)] >= 0) input.constraints.push_back(prior);
    return input;
  }

  bool isSettled(std::size_t i) const { return settled_[i] != 0; }

 private:
  const RelaxationInput& input_;
  std::vector<char> settled_;
  std::vector<std::vector<int>> ties_;
  std::vector<int> from_;
  std::vector<PoseConstraint> priors_;
};

}  // namespace

std::vector<int> scansAround(const ProjectSnapshot& snapshot, const std::vector<Pose>& world_from_scan,
                             const std::vector<int>& added, const RelaxationSettings& settings) {
  double reach = 0.0;
  for (const Link& link : snapshot.links())
    if (link.usable()) reach = std::max(reach, link.fixed_from_moving.translation().norm());
  reach = std::clamp(kReachMargin * reach, kLeastReach_m, kMostReach_m);
  std::vector<int> around = added;
  for (const int from : added) {
    std::vector<std::pair<double, int>> near;
    for (std::size_t i = 0; i < world_from_scan.size(); ++i) {
      const double away = (world_from_scan[i].translation() - world_from_scan[at(from)].translation()).norm();
      if (away <= reach) near.emplace_back(away, static_cast<int>(i));
    }
    std::ranges::sort(near);
    const std::size_t most = at(kNearestTimes * settings.max_links_per_scan);
    if (near.size() > most) near.resize(most);
    for (const auto& [away, i] : near) around.push_back(i);
  }
  std::ranges::sort(around);
  const auto repeats = std::ranges::unique(around);
  around.erase(repeats.begin(), repeats.end());
  return around;
}

Result<std::optional<RelaxationResult>> relaxAdded(const ProjectSnapshot& snapshot,
                                                   const RelaxationInput& input,
                                                   const std::vector<Link>& links,
                                                   const std::vector<int>& added,
                                                   const std::vector<int>& around, const RelaxationRun& run) {
  const Increment increment(snapshot, input, links, added, around);
  for (int rings = 1;; rings = 2 * rings + 1) {
    const std::vector<int> ring = increment.ringsOf(rings);
    auto result = run(increment.inputFor(ring));
    if (!result) return fail(result.error());
    bool stays = true, stands = true;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (!increment.isSettled(i)) continue;
      const PoseDifference& moved = result->moved[i];
      stands = stands && moved.translation_m < kStands_m && moved.rotation_rad < kStands_rad;
      if (ring[i] == rings)
        stays = stays && moved.translation_m < kStays_m && moved.rotation_rad < kStays_rad;
    }
    if (!stands) return std::optional<RelaxationResult>();
    if (stays) return std::optional(std::move(*result));
  }
}

}  // namespace tiltmap
