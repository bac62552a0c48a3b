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
  std::optional<SurfaceHit> best;
  double reach = max_distance_m;
  bool on_ground = false;
  if (const auto t = ground_.hit(ray, max_distance_m)) {
    reach = *t;
    on_ground = true;
  }
  if (!nodes_.empty()) {
    Eigen::Array4f origin, inverse;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray.direction[axis];
      origin[axis] = static_cast<float>(ray.origin[axis]);
      // Never infinite: 0 * infinity is no number, and a box would be missed.
      inverse[axis] = static_cast<float>(1.0 / (std::abs(d) > 1e-12 ? d : std::copysign(1e-12, d)));
    }
    origin[3] = 0.0F;
    inverse[3] = 1.0F;
    const auto entry = [&](const Node& node) {
      const Eigen::Array4f a = (node.low - origin) * inverse, b = (node.high - origin) * inverse;
      const float in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
      return in <= out * 1.00001F ? in : kNever;
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
