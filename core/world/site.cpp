#include "core/world/site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace tiltmap {

namespace {
constexpr std::uint32_t kLeafShapes = 3;
constexpr double kPlainGround = 0.2;
constexpr double kMargin = 5e-3;  // m
constexpr float kFar = 1e30F;
constexpr float kNever = std::numeric_limits<float>::infinity();
// Where to part the shapes of a node: the surface area heuristic over sixteen slices of the longest axis
// (Wald 2007), or the median where all centres fall into one slice.
std::uint32_t split(std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& order,
                    const std::vector<Eigen::AlignedBox3d>& bounds, const Eigen::AlignedBox3d& centres) {
  constexpr int kSlices = 16;
  int axis = 0;
  const double width = centres.sizes().maxCoeff(&axis);
  const auto slice = [&](std::uint32_t i) {
    const double place = (bounds[i].center()[axis] - centres.min()[axis]) / width;
    return std::min(kSlices - 1, static_cast<int>(kSlices * place));
  };
  if (width > 0.0) {
    std::array<Eigen::AlignedBox3d, kSlices> box;
    std::array<int, kSlices> count{};
    for (std::uint32_t i = first; i < last; ++i) {
      const auto s = static_cast<std::size_t>(slice(order[i]));
      box[s].extend(bounds[order[i]]);
      ++count[s];
    }
    const auto area = [](const Eigen::AlignedBox3d& b) {
      const Eigen::Vector3d e = b.sizes();
      return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
    };
    std::array<double, kSlices> right_cost{};
    Eigen::AlignedBox3d sum;
    int shapes = 0;
    for (std::size_t s = kSlices - 1; s > 0; --s) {
      sum.extend(box[s]);
      shapes += count[s];
      right_cost[s] = shapes > 0 ? area(sum) * shapes : 0.0;
    }
    sum.setEmpty();
    shapes = 0;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s + 1 < kSlices; ++s) {
      sum.extend(box[s]);
      shapes += count[s];
      const bool parts = shapes > 0 && shapes < static_cast<int>(last - first);
      if (!parts) continue;
      const double cost = area(sum) * shapes + right_cost[s + 1];
      if (cost < least) {
        least = cost;
        best = static_cast<int>(s);
      }
    }
    const auto parted = std::stable_partition(order.begin() + first, order.begin() + last,
                                              [&](std::uint32_t i) { return slice(i) <= best; });
    const auto middle = static_cast<std::uint32_t>(parted - order.begin());
    if (middle > first && middle < last) return middle;
  }
  return first + (last - first) / 2;
}

}  // namespace

Site::Site(Ground ground, std::vector<Shape> shapes, GroundReflectivity reflectivity)
    : ground_(std::move(ground)), reflectivity_(std::move(reflectivity)) {
  if (shapes.empty()) return;
  std::vector<Eigen::AlignedBox3d> bounds;
  bounds.reserve(shapes.size());
  for (const Shape& shape : shapes) bounds.push_back(boundsOf(shape));
  std::vector<std::uint32_t> order(shapes.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(shapes.size()), order, bounds);
  shapes_.reserve(shapes.size());
  for (const std::uint32_t index : order) shapes_.push_back(std::move(shapes[index]));
}

void Site::build(std::uint32_t node, std::uint32_t first, std::uint32_t last,
                 std::vector<std::uint32_t>& order, const std::vector<Eigen::AlignedBox3d>& bounds) {
  Eigen::AlignedBox3d box, centres;
  for (std::uint32_t i = first; i < last; ++i) {
    box.extend(bounds[order[i]]);
    centres.extend(bounds[order[i]].center());
  }
  // Single precision is kept on the safe side by a margin above its rounding some kilometres out.
  nodes_[node].low << (box.min().array() - kMargin).cast<float>(), 0.0F;
  nodes_[node].high << (box.max().array() + kMargin).cast<float>(), kFar;
  if (last - first <= kLeafShapes) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  const std::uint32_t middle = split(first, last, order, bounds, centres);
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(left, first, middle, order, bounds);
  build(left + 1, middle, last, order, bounds);
}

std::optional<SurfaceHit> Site::cast(const Ray& ray, double max_distance_m) const {
  std::optional<SurfaceHit> hit;
  cast(std::span(&ray, 1), max_distance_m, std::span(&hit, 1));
  return hit;
}

void Site::cast(std::span<const Ray> rays, double max_distance_m,
                std::span<std::optional<SurfaceHit>> hits) const {
  if (rays.size() > kMaxBundle || hits.size() < rays.size())
    throw std::invalid_argument("Site::cast: too many rays, or too few slots for their hits");
  std::array<double, kMaxBundle> reach{};
  std::array<bool, kMaxBundle> ground{};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i].reset();
    const auto t = ground_.hit(rays[i], max_distance_m);
    ground[i] = t.has_value();
    reach[i] = t.value_or(max_distance_m);
  }
  if (!nodes_.empty() && !rays.empty()) castAtShapes(rays, std::span(reach).first(rays.size()), hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i] || !ground[i]) continue;
    const Eigen::Vector3d p = rays[i].origin + reach[i] * rays[i].direction;
    const double reflectivity = reflectivity_ ? reflectivity_(p.x(), p.y()) : kPlainGround;
    hits[i] = SurfaceHit{reach[i], ground_.normal(p.x(), p.y()), reflectivity};
  }
}

// Follows the first ray through boxes that are widened by as much as the others can be away from it.
void Site::castAtShapes(std::span<const Ray> rays, std::span<double> reach,
                        std::span<std::optional<SurfaceHit>> hits) const {
  const Ray& axis = rays.front();
  double apart = 0.0, spread = 0.0;
  for (const Ray& ray : rays) {
    apart = std::max(apart, (ray.origin - axis.origin).norm());
    spread = std::max(spread, (ray.direction - axis.direction).norm());
  }
  float limit = 0.0F, margin = 0.0F;  // how far any of the rays still looks, and the widening for it
  const auto look = [&] {
    const double farthest = *std::max_element(reach.begin(), reach.end());
    limit = static_cast<float>(farthest) * 1.0001F;
    margin = static_cast<float>(apart + spread * farthest);
  };
  look();

  Eigen::Array4f origin, inverse;
  for (int i = 0; i < 3; ++i) {
    const double d = axis.direction[i];
    origin[i] = static_cast<float>(axis.origin[i]);
    // Never infinite: 0 * infinity is no number, and a box would be missed.
    inverse[i] = static_cast<float>(1.0 / (std::abs(d) > 1e-12 ? d : std::copysign(1e-12, d)));
  }
  origin[3] = 0.0F;
  inverse[3] = 1.0F;
  const auto entry = [&](const Node& node) {
    const Eigen::Array4f a = (node.low - margin - origin) * inverse,
                         b = (node.high + margin - origin) * inverse;
    const float in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
    return in <= out * 1.00001F ? std::max(in, 0.0F) : kNever;
  };
  std::array<std::uint32_t, 64> stack;
  std::array<float, 64> entered;
  std::size_t depth = 0;
  const auto push = [&](std::uint32_t node, float in) {
    if (in > limit) return;
    stack[depth] = node;
    entered[depth++] = in;
  };
  push(0, entry(nodes_[0]));
  while (depth > 0) {
    --depth;
    if (entered[depth] > limit) continue;
    const Node& node = nodes_[stack[depth]];
    if (node.count == 0) {
      const float left = entry(nodes_[node.first]), right = entry(nodes_[node.first + 1]);
      const bool left_first = left <= right;
      push(left_first ? node.first + 1 : node.first, std::max(left, right));
      push(left_first ? node.first : node.first + 1, std::min(left, right));
      continue;
    }
    bool nearer = false;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (auto found = hitOf(shapes_[k], rays[i], reach[i])) {
          reach[i] = found->distance_m;
          hits[i] = std::move(found);
          nearer = true;
        }
    if (nearer) look();
  }
}

double Site::clearance(const Eigen::Vector3d& point) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape& shape : shapes_)
    if (boundsOf(shape).exteriorDistance(point) < least) least = std::min(least, distanceOf(shape, point));
  return least;
}

}  // namespace tiltmap
