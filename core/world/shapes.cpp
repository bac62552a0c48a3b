#include "core/world/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tiltmap {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNearest = 1e-6;  // a strike nearer than this is the origin's own surface

// One mixing step (SplitMix64's) over a cell's address: repeatable without a table.
std::uint64_t cellHash(std::uint64_t seed, std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = seed ^ static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL ^
                    static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31);
}
// Bits [shift, shift + 16) of a hash as a number in [0, 1).
double part(std::uint64_t hash, int shift) {
  return static_cast<double>((hash >> shift) & 0xffff) / 65536.0;
}

struct Span {
  double in = -kInfinity, out = kInfinity;
  int axis = -1;  // the axis of the slab that was entered last
};

// Where the ray is inside the slab box; false where it never is.
bool crossBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& low,
              const Eigen::Vector3d& high, Span& span) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < low[axis] || origin[axis] > high[axis]) return false;
      continue;
    }
    const double a = (low[axis] - origin[axis]) / direction[axis];
    const double b = (high[axis] - origin[axis]) / direction[axis];
    if (std::min(a, b) > span.in) {
      span.in = std::min(a, b);
      span.axis = axis;
    }
    span.out = std::min(span.out, std::max(a, b));
  }
  return span.in <= span.out && span.axis >= 0;
}

Eigen::AlignedBox3d transformedBounds(const Eigen::Isometry3d& frame, const Eigen::Vector3d& low,
                                      const Eigen::Vector3d& high) {
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner)
    box.extend(frame * Eigen::Vector3d((corner & 1) ? high.x() : low.x(), (corner & 2) ? high.y() : low.y(),
                                       (corner & 4) ? high.z() : low.z()));
  return box;
}

}  // namespace

Hull Hull::box(const Eigen::Isometry3d& site_from_frame, const Eigen::Vector3d& low,
               const Eigen::Vector3d& high, double reflectivity) {
  Hull hull;
  hull.site_from_frame_ = site_from_frame;
  hull.reflectivity_ = reflectivity;
  hull.bounds_ = transformedBounds(site_from_frame, low, high);
  for (int axis = 0; axis < 3; ++axis) {
    hull.cut(high, Eigen::Vector3d::Unit(axis));
    hull.cut(low, -Eigen::Vector3d::Unit(axis));
  }
  return hull;
}

Hull& Hull::cut(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  if (planes_ == kMaxPlanes) throw std::logic_error("Hull::cut: too many planes");
  const Eigen::Vector3d n = site_from_frame_.linear() * normal.normalized();
  normal_[static_cast<std::size_t>(planes_)] = n;
  offset_[static_cast<std::size_t>(planes_)] = n.dot(site_from_frame_ * point);
  ++planes_;
  return *this;
}

std::optional<SurfaceHit> Hull::hit(const Ray& ray, double max_distance_m) const {
  double in = -kInfinity, out = kInfinity;
  std::size_t entered = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(planes_); ++i) {
    const double speed = normal_[i].dot(ray.direction);
    const double above = normal_[i].dot(ray.origin) - offset_[i];
    if (speed == 0.0) {
      if (above > 0.0) return std::nullopt;
      continue;
    }
    const double t = -above / speed;
    if (speed < 0.0 && t > in) {
      in = t;
      entered = i;
    } else if (speed > 0.0) {
      out = std::min(out, t);
    }
    if (in > out) return std::nullopt;
  }
  if (in < kNearest || in > max_distance_m) return std::nullopt;
  return SurfaceHit{in, normal_[entered], reflectivity_};
}

double Hull::distance(const Eigen::Vector3d& point) const {
  double largest = -kInfinity;
  for (std::size_t i = 0; i < static_cast<std::size_t>(planes_); ++i)
    largest = std::max(largest, normal_[i].dot(point) - offset_[i]);
  return largest;
}

std::optional<SurfaceHit> Cylinder::hit(const Ray& ray, double max_distance_m) const {
  const Eigen::Vector2d from = ray.origin.head<2>() - centre;
  const Eigen::Vector2d along = ray.direction.head<2>();
  const double a = along.squaredNorm(), b = from.dot(along), c = from.squaredNorm() - radius_m * radius_m;
  const double root = b * b - a * c;
  if (a > 0.0 && (root < 0.0 || (c > 0.0 && b > 0.0))) return std::nullopt;
  std::optional<SurfaceHit> best;
  if (a > 0.0) {
    const double t = (-b - std::sqrt(root)) / a;
    const double z = ray.origin.z() + t * ray.direction.z();
    if (t > kNearest && t <= max_distance_m && z >= low_m && z <= high_m) {
      const Eigen::Vector2d n = (from + t * along) / radius_m;
      best = SurfaceHit{t, {n.x(), n.y(), 0.0}, reflectivity};
    }
  }
  if (!best && ray.direction.z() < 0.0) {
    const double t = (high_m - ray.origin.z()) / ray.direction.z();
    if (t > kNearest && t <= max_distance_m && (from + t * along).squaredNorm() <= radius_m * radius_m)
      best = SurfaceHit{t, Eigen::Vector3d::UnitZ(), reflectivity};
  }
  return best;
}

double Cylinder::distance(const Eigen::Vector3d& point) const {
  return std::max({(point.head<2>() - centre).norm() - radius_m, point.z() - high_m, low_m - point.z()});
}

Eigen::AlignedBox3d Cylinder::bounds() const {
  return {Eigen::Vector3d(centre.x() - radius_m, centre.y() - radius_m, low_m),
          Eigen::Vector3d(centre.x() + radius_m, centre.y() + radius_m, high_m)};
}

std::optional<SurfaceHit> Ball::hit(const Ray& ray, double max_distance_m) const {
  const Eigen::Vector3d from = ray.origin - centre;
  const double a = ray.direction.squaredNorm(), b = from.dot(ray.direction);
  const double c = from.squaredNorm() - radius_m * radius_m;
  const double root = b * b - a * c;
  if (root < 0.0 || b > 0.0 || c < 0.0) return std::nullopt;
  const double t = (-b - std::sqrt(root)) / a;
  if (t < kNearest || t > max_distance_m) return std::nullopt;
  return SurfaceHit{t, (from + t * ray.direction) / radius_m, reflectivity};
}

double Ball::distance(const Eigen::Vector3d& point) const {
  return (point - centre).norm() - radius_m;
}

Eigen::AlignedBox3d Ball::bounds() const {
  return {centre - Eigen::Vector3d::Constant(radius_m), centre + Eigen::Vector3d::Constant(radius_m)};
}

std::optional<SurfaceHit> Foliage::hit(const Ray& ray, double max_distance_m) const {
  // The stretch of the ray where clumps may be, as a unit ball in scaled space: their centres lie in the
  // ellipsoid, so they stand out of it by up to their radius.
  constexpr double kOut = 0.5 * kCellM;
  const Eigen::Vector3d scale(1.0 / (radius_m + kOut), 1.0 / (radius_m + kOut), 1.0 / (half_height_m + kOut));
  const Eigen::Vector3d from = ray.origin - centre;
  const Eigen::Vector3d o = from.cwiseProduct(scale), d = ray.direction.cwiseProduct(scale);
  const double a = d.squaredNorm(), b = o.dot(d), root = b * b - a * (o.squaredNorm() - 1.0);
  if (root <= 0.0) return std::nullopt;
  const double start = std::max(0.0, (-b - std::sqrt(root)) / a);
  const double end = std::min(max_distance_m, (-b + std::sqrt(root)) / a);
  if (start >= end) return std::nullopt;

  const auto holds = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d from_centre = p - centre;
    return from_centre.head<2>().squaredNorm() / (radius_m * radius_m) +
               from_centre.z() * from_centre.z() / (half_height_m * half_height_m) <
           1.0;
  };
  // From cell to cell (Amanatides and Woo 1987).
  const Eigen::Vector3d entry = from + start * ray.direction;
  std::array<std::int64_t, 3> cell{};
  std::array<int, 3> step{};
  Eigen::Vector3d next, across;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double speed = ray.direction[axis];
    cell[k] = static_cast<std::int64_t>(std::floor(entry[axis] / kCellM));
    step[k] = speed > 0.0 ? 1 : -1;
    across[axis] = speed == 0.0 ? kInfinity : kCellM / std::abs(speed);
    const double border = static_cast<double>(cell[k] + (speed > 0.0 ? 1 : 0)) * kCellM;
    next[axis] = speed == 0.0 ? kInfinity : start + (border - entry[axis]) / speed;
  }
  for (double t = start; t < end;) {
    const std::uint64_t hash = cellHash(seed, cell[0], cell[1], cell[2]);
    if (part(hash, 0) < density) {
      // A clump stays inside its cell: radius 0.08 to 0.11 m, moved by at most 0.04 m.
      Ball clump;
      for (int axis = 0; axis < 3; ++axis)
        clump.centre[axis] = centre[axis] +
                             (static_cast<double>(cell[static_cast<std::size_t>(axis)]) + 0.5) * kCellM +
                             0.08 * (part(hash, 16 + 12 * axis) - 0.5);
      clump.radius_m = 0.08 + 0.03 * part(hash, 8);
      clump.reflectivity = reflectivity;
      if (holds(clump.centre))
        if (const auto found = clump.hit(ray, max_distance_m)) return found;
    }
    int axis = 0;
    if (next.y() < next[axis]) axis = 1;
    if (next.z() < next[axis]) axis = 2;
    t = next[axis];
    next[axis] += across[axis];
    cell[static_cast<std::size_t>(axis)] += step[static_cast<std::size_t>(axis)];
  }
  return std::nullopt;
}

double Foliage::distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d scale(1.0 / radius_m, 1.0 / radius_m, 1.0 / half_height_m);
  return ((point - centre).cwiseProduct(scale).norm() - 1.0) * std::min(radius_m, half_height_m);
}

Eigen::AlignedBox3d Foliage::bounds() const {
  const Eigen::Vector3d half(radius_m + kCellM, radius_m + kCellM, half_height_m + kCellM);
  return {centre - half, centre + half};
}

namespace {

struct Opening {
  double left = 0.0, right = 0.0, low = 0.0, high = 0.0, depth = 0.0;
  double reflectivity = 0.0;
};

// The window or door at a place of a wall (s along it from its middle, h above the floor), if there is one.
std::optional<Opening> openingAt(const Facade& f, int wall, double s, double h) {
  const double half = wall < 2 ? f.half_m.y() : f.half_m.x();
  const auto bays = static_cast<std::int64_t>(std::floor(2.0 * half / f.bay_m));
  if (bays < 1 || h < 0.0) return std::nullopt;
  const double bay_place = s / f.bay_m + 0.5 * static_cast<double>(bays);
  const auto bay = static_cast<std::int64_t>(std::floor(bay_place));
  const auto storey = static_cast<std::int64_t>(std::floor(h / f.storey_m));
  const double floor_h = static_cast<double>(storey) * f.storey_m;
  if (bay < 0 || bay >= bays || floor_h + f.sill_m + f.window_height_m + 0.3 > f.height_m)
    return std::nullopt;
  const std::uint64_t hash = cellHash(f.seed, wall, bay, storey);
  const double lot = part(hash, 0);
  if (lot < 0.12) return std::nullopt;
  const double middle = (static_cast<double>(bay) + 0.5 - 0.5 * static_cast<double>(bays)) * f.bay_m;
  Opening opening;
  if (storey == 0 && lot > 0.82) {
    opening = {middle - 0.6, middle + 0.6, 0.0, 2.2, f.recess_m + 0.25, f.door_reflectivity};
  } else {
    const double low = floor_h + f.sill_m;
    opening = {middle - 0.5 * f.window_width_m,
               middle + 0.5 * f.window_width_m,
               low,
               low + f.window_height_m,
               f.recess_m,
               f.glass_reflectivity};
  }
  if (s <= opening.left || s >= opening.right || h <= opening.low || h >= opening.high) return std::nullopt;
  return opening;
}

}  // namespace

std::optional<SurfaceHit> Facade::hit(const Ray& ray, double max_distance_m) const {
  const Eigen::Matrix3d back = site_from_frame.linear().transpose();
  const Eigen::Vector3d o = back * (ray.origin - site_from_frame.translation()), d = back * ray.direction;
  Span span;
  if (!crossBox(o, d, {-half_m.x(), -half_m.y(), -below_m}, {half_m.x(), half_m.y(), height_m}, span))
    return std::nullopt;
  if (span.in < kNearest || span.in > max_distance_m) return std::nullopt;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal[span.axis] = d[span.axis] > 0.0 ? -1.0 : 1.0;
  SurfaceHit result{span.in, site_from_frame.linear() * normal, wall_reflectivity};
  if (span.axis == 2) return result;

  const int along = 1 - span.axis;
  const int wall = 2 * span.axis + (normal[span.axis] > 0.0 ? 1 : 0);
  const Eigen::Vector3d p = o + span.in * d;
  const auto opening = openingAt(*this, wall, p[along], p.z());
  if (!opening) return result;
  // Inside the recess the ray ends on the pane or on whichever reveal it reaches first.
  double distance = span.in + opening->depth / std::abs(d[span.axis]);
  result.reflectivity = opening->reflectivity;
  const auto reveal = [&](int axis, double place, double facing) {
    if (d[axis] * facing >= 0.0) return;
    const double t = (place - o[axis]) / d[axis];
    if (t >= distance) return;
    distance = t;
    result.normal = site_from_frame.linear() * (facing * Eigen::Vector3d::Unit(axis));
    result.reflectivity = wall_reflectivity;
  };
  reveal(along, opening->left, 1.0);
  reveal(along, opening->right, -1.0);
  reveal(2, opening->low, 1.0);
  reveal(2, opening->high, -1.0);
  result.distance_m = distance;
  if (distance > max_distance_m) return std::nullopt;
  return result;
}

double Facade::distance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d p = site_from_frame.inverse() * point;
  return std::max(
      {std::abs(p.x()) - half_m.x(), std::abs(p.y()) - half_m.y(), p.z() - height_m, -below_m - p.z()});
}

Eigen::AlignedBox3d Facade::bounds() const {
  return transformedBounds(site_from_frame, {-half_m.x(), -half_m.y(), -below_m},
                           {half_m.x(), half_m.y(), height_m});
}

std::optional<SurfaceHit> hitOf(const Shape& shape, const Ray& ray, double max_distance_m) {
  return std::visit([&](const auto& s) { return s.hit(ray, max_distance_m); }, shape);
}
double distanceOf(const Shape& shape, const Eigen::Vector3d& point) {
  return std::visit([&](const auto& s) { return s.distance(point); }, shape);
}
Eigen::AlignedBox3d boundsOf(const Shape& shape) {
  return std::visit([](const auto& s) { return s.bounds(); }, shape);
}

}  // namespace tiltmap
