#include "core/registration/pair_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/registration/moved_cells.h"

namespace tiltmap {

namespace {

constexpr std::uint32_t kNobody = DirectionIndex::kNobody;
constexpr std::size_t kShootingCandidates = 12;
constexpr float kSamePatch_m =
    0.05F;  // a patch seen in a direction and this near is not compared with others

// One element of `from`, in the frame of `to`.
struct Query {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // zero where it has none
  bool has_normal = false;
};

std::uint32_t nearest(const PreparedScan& to, const Query& query) {
  return to.tree->nearest(query.position).index;
}

// Thesis 4.2.4: in the leaf that holds the nearest point, the one whose normal agrees best.
std::uint32_t bestNormalInLeaf(const PreparedScan& to, const Query& query) {
  KdTree::Neighbour found;
  const KdTree::Leaf leaf = to.tree->leafOfNearest(query.position, found);
  if (!query.has_normal) return found.index;
  std::uint32_t best = kNobody;
  double best_cos = -2.0;
  for (const std::uint32_t candidate : to.tree->order().subspan(leaf.first, leaf.count)) {
    const Eigen::Vector3d& normal = to.elements.normal[candidate];
    if (normal.isZero()) continue;
    const double cos_angle = normal.dot(query.normal);
    if (cos_angle > best_cos) best_cos = cos_angle, best = candidate;
  }
  return best == kNobody ? found.index : best;
}

// Chen and Medioni 1991, on points: of the nearest few the one closest to the line along the normal.
std::uint32_t normalShooting(const PreparedScan& to, const Query& query,
                             std::vector<KdTree::Neighbour>& scratch) {
  if (!query.has_normal) return nearest(to, query);
  to.tree->nearestSeveral(query.position, kShootingCandidates, scratch);
  std::uint32_t best = kNobody;
  double best_off = std::numeric_limits<double>::infinity();
  for (const KdTree::Neighbour& candidate : scratch) {
    const Eigen::Vector3d d = to.elements.position[candidate.index] - query.position;
    const double along = d.dot(query.normal);
    const double off = d.squaredNorm() - along * along;
    if (off < best_off) best_off = off, best = candidate.index;
  }
  return best;
}

// How far a place is from a patch as a disc, squared: across its plane, and beyond its edge along it.
float discDistance(const PatchDisc& disc, float x, float y, float z) {
  const float dx = x - disc.x, dy = y - disc.y, dz = z - disc.z;
  const float across = dx * disc.nx + dy * disc.ny + dz * disc.nz;
  const float u = std::max(0.0F, std::abs(dx * disc.ux + dy * disc.uy + dz * disc.uz) - disc.reach_u);
  const float v = std::max(0.0F, std::abs(dx * disc.vx + dy * disc.vy + dz * disc.vz) - disc.reach_v);
  return across * across + u * u + v * v;
}

// The projective choice among the patches of a matrix, which are of very different sizes.
class SeenPatches {
 public:
  SeenPatches(const PreparedScan& from, const PreparedScan& to, const Pose& to_from_from, bool from_is_fixed,
              bool wide, double min_cos)
      : from_(from.elements),
        to_(to),
        motion_(to_from_from),
        from_is_fixed_(from_is_fixed),
        reach_(wide ? 3 : 1),
        min_cos_(static_cast<float>(min_cos)),
        enough_square_(wide ? 0.0F : kSamePatch_m * kSamePatch_m) {}

  void pair(std::span<const std::uint32_t> sample, std::vector<Correspondence>& pairs) {
    for (std::size_t begin = 0; begin < sample.size(); begin += MovedPatches::kMost) {
      const auto some = sample.subspan(begin, std::min(MovedPatches::kMost, sample.size() - begin));
      for (std::size_t i = 0; i < some.size(); ++i) {
        const Eigen::Vector3d &p = from_.position[some[i]], &n = from_.normal[some[i]];
        moved_.x[i] = static_cast<float>(p.x()), moved_.nx[i] = static_cast<float>(n.x());
        moved_.y[i] = static_cast<float>(p.y()), moved_.ny[i] = static_cast<float>(n.y());
        moved_.z[i] = static_cast<float>(p.z()), moved_.nz[i] = static_cast<float>(n.z());
      }
      movePatches(some.size(), motion_, moved_);
      for (std::size_t i = 0; i < some.size(); ++i) pairs.push_back(pairOf(some[i], i));
    }
  }

 private:
  Correspondence pairOf(std::uint32_t index, std::size_t i) const {
    const float x = moved_.x[i], y = moved_.y[i], z = moved_.z[i];
    const float nx = moved_.nx[i], ny = moved_.ny[i], nz = moved_.nz[i];
    const auto cosine = [&](const PatchDisc& disc) { return disc.nx * nx + disc.ny * ny + disc.nz * nz; };
    std::uint32_t best = kNobody, any = kNobody;
    float best_square = std::numeric_limits<float>::infinity();
    if (x * x + y * y + z * z > 1e-12F)
      to_.raster->aroundIndex(moved_.place[i], reach_, [&](std::uint32_t patch) {
        if (any == kNobody) any = patch;
        const PatchDisc& disc = to_.discs[patch];
        if (cosine(disc) < min_cos_) return true;
        const float square = discDistance(disc, x, y, z);
        if (square < best_square) best_square = square, best = patch;
        return best_square > enough_square_;
      });
    const std::uint32_t partner = best == kNobody ? any : best;
    Correspondence pair;
    pair.from_fixed = from_is_fixed_;
    (from_is_fixed_ ? pair.fixed : pair.moving) = index;
    if (partner == kNobody) {
      pair.reason = RejectReason::NoPartner;
      return pair;
    }
    (from_is_fixed_ ? pair.moving : pair.fixed) = partner;
    const PatchDisc& disc = to_.discs[partner];
    const float dx = disc.x - x, dy = disc.y - y, dz = disc.z - z;
    pair.distance_m = std::sqrt(dx * dx + dy * dy + dz * dz);
    pair.has_normals = nx * nx + ny * ny + nz * nz > 0.5F;
    if (pair.has_normals) pair.cos_angle = cosine(disc);
    return pair;
  }

  const SurfaceElements& from_;
  const PreparedScan& to_;
  FloatPose motion_;
  bool from_is_fixed_;
  int reach_;
  float min_cos_, enough_square_;
  MovedPatches moved_;
};

}  // namespace

void choosePairs(const PreparedScan& from, const PreparedScan& to, const Pose& to_from_from,
                 std::span<const std::uint32_t> sample, bool from_is_fixed, double loss_scale_m,
                 const RegistrationSettings& settings, std::vector<Correspondence>& pairs) {
  const bool by_direction = settings.pair_choice == PairChoice::Projective;
  if (!to.elements.empty() &&
      (by_direction ? !to.directions.has_value() && !to.raster.has_value() : !to.tree.has_value()))
    throw std::logic_error("choosePairs: the scan was not prepared for this pair choice");
  const bool wide = loss_scale_m > settings.wide_search_above_m;
  if (by_direction && to.raster) {
    SeenPatches(from, to, to_from_from, from_is_fixed, wide, std::cos(settings.max_angle_rad))
        .pair(sample, pairs);
    return;
  }
  const auto& directions = wide ? to.wide_directions : to.directions;
  const Eigen::Matrix3d rotation = to_from_from.rotation();
  const Eigen::Vector3d shift = to_from_from.translation();
  const double min_cos = std::cos(settings.max_angle_rad);
  std::vector<KdTree::Neighbour> scratch;
  for (const std::uint32_t index : sample) {
    Query query{rotation * from.elements.position[index] + shift, rotation * from.elements.normal[index],
                false};
    query.has_normal = !from.elements.normal[index].isZero();
    std::uint32_t partner = kNobody;
    if (!to.elements.empty()) {
      switch (settings.pair_choice) {
        case PairChoice::Nearest:
          partner = nearest(to, query);
          break;
        case PairChoice::BestNormalInLeaf:
          partner = bestNormalInLeaf(to, query);
          break;
        case PairChoice::NormalShooting:
          partner = normalShooting(to, query, scratch);
          break;
        case PairChoice::Projective:
          partner = directions->nearestFitting(query.position, query.normal, min_cos);
          break;
      }
    }
    Correspondence pair;
    pair.from_fixed = from_is_fixed;
    pair.fixed = from_is_fixed ? index : partner;
    pair.moving = from_is_fixed ? partner : index;
    if (partner == kNobody) {
      (from_is_fixed ? pair.moving : pair.fixed) = 0;
      pair.reason = RejectReason::NoPartner;
    } else {
      const Eigen::Vector3d& normal = to.elements.normal[partner];
      pair.distance_m = static_cast<float>((to.elements.position[partner] - query.position).norm());
      pair.has_normals = query.has_normal && !normal.isZero();
      if (pair.has_normals) pair.cos_angle = static_cast<float>(normal.dot(query.normal));
    }
    pairs.push_back(pair);
  }
}

RejectionCounts findPairs(const PreparedScan& fixed, const PreparedScan& moving,
                          const Pose& fixed_from_moving, std::span<const std::uint32_t> fixed_sample,
                          std::span<const std::uint32_t> moving_sample, double loss_scale_m,
                          const RegistrationSettings& settings, RejectionState& state,
                          std::vector<Correspondence>& pairs) {
  pairs.clear();
  pairs.reserve(moving_sample.size() + fixed_sample.size());
  choosePairs(moving, fixed, fixed_from_moving, moving_sample, false, loss_scale_m, settings, pairs);
  if (settings.both_directions && loss_scale_m <= settings.both_directions_below_m)
    choosePairs(fixed, moving, fixed_from_moving.inverse(), fixed_sample, true, loss_scale_m, settings,
                pairs);
  return applyRejection(settings, state, pairs);
}

}  // namespace tiltmap
