#include "core/registration/patches.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Eigenvalues>

namespace tiltmap {

namespace {

using Points = std::span<Eigen::Vector3d>;

struct Moments {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

Moments momentsOf(Points points) {
  Moments m;
  for (const Eigen::Vector3d& p : points) m.mean += p;
  const double n = static_cast<double>(points.size());
  m.mean /= n;
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (const Eigen::Vector3d& p : points) {
    const double x = p.x() - m.mean.x(), y = p.y() - m.mean.y(), z = p.z() - m.mean.z();
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
  }
  m.covariance << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  m.covariance /= n;
  return m;
}

// Halves a group until it is planar and appends what is.
class Splitter {
 public:
  Splitter(const RegistrationSettings& settings, SurfaceElements& out)
      : settings_(settings), minimum_(static_cast<std::size_t>(settings.patch_min_points)), out_(out) {}

  void split(Points points, int splits_left) {
    if (points.size() < minimum_) return;
    const Moments m = momentsOf(points);
    solver_.computeDirect(m.covariance);
    const Eigen::Vector3d values = solver_.eigenvalues();
    const Eigen::Matrix3d axes = solver_.eigenvectors();
    const bool last = splits_left == 0 || points.size() < 2 * minimum_;
    const double noise = last ? settings_.patch_rough_noise_m : settings_.patch_noise_m;
    const double floor = last ? settings_.patch_rough_floor_m : settings_.patch_floor_m;
    if (isPlanar(m, values, axes.col(0), noise, floor)) {
      append(m, values, axes, points.size());
      return;
    }
    if (last) return;
    const Eigen::Vector3d longest = axes.col(2);
    const double middle = longest.dot(m.mean);
    const auto second = std::partition(points.begin(), points.end(),
                                       [&](const Eigen::Vector3d& p) { return longest.dot(p) < middle; });
    const auto first_size = static_cast<std::size_t>(second - points.begin());
    split(points.first(first_size), splits_left - 1);
    split(points.subspan(first_size), splits_left - 1);
  }

 private:
  bool isPlanar(const Moments& m, const Eigen::Vector3d& values, const Eigen::Vector3d& normal,
                double range_noise, double floor) const {
    const double range = m.mean.norm();
    const double cos_incidence = range > 0.0 ? std::abs(normal.dot(m.mean)) / range : 1.0;
    const double noise = range_noise * cos_incidence;
    return values[0] < 4.0 * (noise * noise + floor * floor);
  }

  void append(const Moments& m, const Eigen::Vector3d& values, const Eigen::Matrix3d& axes,
              std::size_t count) {
    // Points along a line span no plane: the second extent must stand out of the residual.
    if (values[1] < 9.0 * values[0] || !(values[1] > 0.0)) return;
    Eigen::Vector3d normal = axes.col(0);
    if (normal.dot(m.mean) > 0.0) normal = -normal;
    const double n = static_cast<double>(count);
    const double residual = std::max(values[0], 0.0) + kResidualFloor * kResidualFloor;
    PatchShape shape;
    shape.u = axes.col(2);
    shape.v = axes.col(1);
    shape.offset_variance_m2 = residual / n + kOffsetFloor * kOffsetFloor;
    shape.tilt_variance_u = residual / (n * values[2]);
    shape.tilt_variance_v = residual / (n * values[1]);
    shape.extent_u_m = std::sqrt(values[2]);
    shape.extent_v_m = std::sqrt(values[1]);
    shape.residual_m = std::sqrt(std::max(values[0], 0.0));
    shape.count = static_cast<std::uint32_t>(count);
    out_.position.push_back(m.mean);
    out_.normal.push_back(normal);
    out_.shape.push_back(shape);
  }

  static constexpr double kResidualFloor = 0.002;  // no surface measured by us is known better, ours
  static constexpr double kOffsetFloor = 0.001;
  const RegistrationSettings& settings_;
  std::size_t minimum_;
  SurfaceElements& out_;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver_;
};

// Which cells take part: those with a point and, where asked, not on an edge. On any plane 1/r is linear in
// the grid (up to the step's cosine), at any incidence; at edges, mixed pixels and leaves it is not. The
// bound is on the depth.
class CellChoice {
 public:
  CellChoice(const RangeImage& image, const ScannerGeometry& geometry, bool drop_edges)
      : image_(image),
        drop_edges_(drop_edges && image.isMatrix() && image.isRegular()),
        two_cos_azimuth_(2.0 * std::cos(geometry.azimuth_step_rad)) {
    const int rows = image.rows();
    const double tilt_step = rows > 1 ? (image.lineTilt(rows - 1) - image.lineTilt(0)) / (rows - 1) : 0.0;
    two_cos_tilt_ = 2.0 * std::cos(tilt_step);
  }
  bool operator()(int row, int column) const {
    return image_.hasPoint(row, column) && (!drop_edges_ || isSmooth(row, column));
  }

 private:
  bool isSmooth(int row, int column) const {
    if (row == 0 || row + 1 == image_.rows() || column == 0 || column + 1 == image_.columns()) return false;
    return isStraight(row, column, 0, 1, two_cos_azimuth_) && isStraight(row, column, 1, 0, two_cos_tilt_);
  }
  bool isStraight(int row, int column, int down, int across, double two_cos) const {
    if (!image_.hasPoint(row - down, column - across) || !image_.hasPoint(row + down, column + across))
      return false;
    const auto at = [&](int sign) {
      return static_cast<double>(image_.range(row + sign * down, column + sign * across));
    };
    const double r = at(0);
    return std::abs((1.0 / at(-1) + 1.0 / at(1) - two_cos / r) * r * r) < kBend;
  }

  static constexpr double kBend = 0.2;  // m
  const RangeImage& image_;
  bool drop_edges_;
  double two_cos_azimuth_, two_cos_tilt_ = 2.0;
};

SurfaceElements blockPatches(const RangeImage& image, const ScannerGeometry& geometry,
                             const std::vector<Eigen::Vector3d>& points,
                             const RegistrationSettings& settings) {
  SurfaceElements out;
  Splitter splitter(settings, out);
  const CellChoice usable(image, geometry, settings.patch_drop_edges);
  std::vector<Eigen::Vector3d> group;
  group.reserve(static_cast<std::size_t>(settings.patch_rows) *
                static_cast<std::size_t>(settings.patch_columns));
  for (int top = 0; top < image.rows(); top += settings.patch_rows) {
    const int bottom = std::min(image.rows(), top + settings.patch_rows);
    for (int left = 0; left < image.columns(); left += settings.patch_columns) {
      const int right = std::min(image.columns(), left + settings.patch_columns);
      group.clear();
      for (int row = top; row < bottom; ++row)
        for (int column = left; column < right; ++column)
          if (usable(row, column)) group.push_back(points[image.index(row, column)]);
      splitter.split(group, settings.patch_splits);
    }
  }
  return out;
}

// Points by cube, each cube's points side by side, cubes in order of first appearance.
std::vector<std::size_t> groupByCube(const std::vector<Eigen::Vector3d>& points, double size_m,
                                     std::vector<Eigen::Vector3d>& grouped) {
  std::size_t capacity = 1024;
  while (capacity < points.size() / 2) capacity *= 2;
  struct Slot {
    std::int64_t key = 0;
    std::uint32_t group = 0xffffffffU;
  };
  std::vector<Slot> slots(capacity);
  std::vector<std::uint32_t> group_of(points.size());
  std::vector<std::size_t> start{0};
  std::size_t used = 0;
  const auto grow = [&] {
    std::vector<Slot> larger(slots.size() * 2);
    for (const Slot& slot : slots) {
      if (slot.group == 0xffffffffU) continue;
      std::size_t at =
          (static_cast<std::uint64_t>(slot.key) * 0x9e3779b97f4a7c15ULL >> 20) & (larger.size() - 1);
      while (larger[at].group != 0xffffffffU) at = (at + 1) & (larger.size() - 1);
      larger[at] = slot;
    }
    slots.swap(larger);
  };
  const double inverse = 1.0 / size_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto part = [&](double x) {
      return static_cast<std::int64_t>(std::floor(std::clamp(x * inverse, -1e6, 1e6))) & 0x1fffff;
    };
    const std::int64_t key = part(points[i].x()) << 42 | part(points[i].y()) << 21 | part(points[i].z());
    std::size_t at = (static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15ULL >> 20) & (slots.size() - 1);
    while (slots[at].group != 0xffffffffU && slots[at].key != key) at = (at + 1) & (slots.size() - 1);
    if (slots[at].group == 0xffffffffU) {
      slots[at] = {key, static_cast<std::uint32_t>(used++)};
      start.push_back(0);
    }
    group_of[i] = slots[at].group;
    ++start[group_of[i] + 1];
    if (used * 2 > slots.size()) grow();
  }
  for (std::size_t g = 1; g < start.size(); ++g) start[g] += start[g - 1];
  grouped.resize(points.size());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) grouped[next[group_of[i]]++] = points[i];
  return start;
}

SurfaceElements cubePatches(const RangeImage& image, const ScannerGeometry& geometry,
                            const std::vector<Eigen::Vector3d>& points,
                            const RegistrationSettings& settings) {
  std::vector<Eigen::Vector3d> valid, grouped;
  valid.reserve(image.validCells());
  const CellChoice usable(image, geometry, settings.patch_drop_edges);
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column)
      if (usable(row, column)) valid.push_back(points[image.index(row, column)]);
  const std::vector<std::size_t> start = groupByCube(valid, settings.patch_size_m, grouped);
  SurfaceElements out;
  Splitter splitter(settings, out);
  for (std::size_t g = 0; g + 1 < start.size(); ++g)
    splitter.split(Points(grouped).subspan(start[g], start[g + 1] - start[g]), settings.patch_splits);
  return out;
}

}  // namespace

SurfaceElements planePatches(const RangeImage& image, const ScannerGeometry& geometry,
                             const std::vector<Eigen::Vector3d>& points,
                             const RegistrationSettings& settings) {
  return image.isMatrix() && settings.patch_grouping == PatchGrouping::Blocks
             ? blockPatches(image, geometry, points, settings)
             : cubePatches(image, geometry, points, settings);
}

}  // namespace tiltmap
