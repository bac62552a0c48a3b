#include "core/world/site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace tiltmap {

namespace {
constexpr std::uint32_t kLeafShapes = 3;
constexpr double kPlainGround = 0.2;
constexpr double kMargin = 5e-3;  // m
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
  nodes_[node].low = (box.min().array() - kMargin).cast<float>();
  nodes_[node].high = (box.max().array() + kMargin).cast<float>();
  if (last - first <= kLeafShapes) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const double ca = bounds[a].center()[axis], cb = bounds[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  };
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, less);
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.emplace_back();
  nodes_.emplace_back();
  build(left, first, middle, order, bounds);
  build(left + 1, middle, last, order, bounds);
}

std::optional<SurfaceHit> Site::cast(const Ray& ray, double max_distance_m) const {
  std::optional<SurfaceHit> best;
  double reach = max_distance_m;
  bool on_ground = false;
  if (const auto t = ground_.hit(ray, max_distance_m)) {
    reach = *t;
    on_ground = true;
  }
  if (!nodes_.empty()) {
    const Eigen::Array3f origin = ray.origin.array().cast<float>();
    // Never infinite: 0 * infinity is no number, and a box would be missed.
    const Eigen::Array3f inverse =
        ray.direction.array()
            .unaryExpr([](double d) { return 1.0 / (std::abs(d) > 1e-12 ? d : std::copysign(1e-12, d)); })
            .cast<float>();
    const auto entry = [&](const Node& node) {
      const Eigen::Array3f a = (node.low - origin) * inverse, b = (node.high - origin) * inverse;
      const float in = std::max({std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]), 0.0F});
      const float out = std::min({std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])});
      return in <= out * 1.00001F ? in : std::numeric_limits<float>::infinity();
    };
    std::array<std::pair<std::uint32_t, float>, 64> stack;
    std::size_t depth = 0;
    if (const float in = entry(nodes_[0]); in < static_cast<float>(reach)) stack[depth++] = {0U, in};
    while (depth > 0) {
      const auto [index, in] = stack[--depth];
      if (in > static_cast<float>(reach)) continue;
      const Node& node = nodes_[index];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          if (auto found = hitOf(shapes_[i], ray, reach)) {
            reach = found->distance_m;
            best = std::move(found);
            on_ground = false;
          }
        continue;
      }
      const float left = entry(nodes_[node.first]), right = entry(nodes_[node.first + 1]);
      const bool left_first = left <= right;
      const std::uint32_t near = left_first ? node.first : node.first + 1;
      const std::uint32_t far = left_first ? node.first + 1 : node.first;
      const auto limit = static_cast<float>(reach);
      if (std::max(left, right) <= limit) stack[depth++] = {far, std::max(left, right)};
      if (std::min(left, right) <= limit) stack[depth++] = {near, std::min(left, right)};
    }
  }
  if (!on_ground) return best;
  const Eigen::Vector3d p = ray.origin + reach * ray.direction;
  return SurfaceHit{reach, ground_.normal(p.x(), p.y()),
                    reflectivity_ ? reflectivity_(p.x(), p.y()) : kPlainGround};
}

double Site::clearance(const Eigen::Vector3d& point) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape& shape : shapes_)
    if (boundsOf(shape).exteriorDistance(point) < least) least = std::min(least, distanceOf(shape, point));
  return least;
}

}  // namespace tiltmap
