#include "core/registration/cube_patches.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/registration/plane_patch.h"

namespace tiltmap {

namespace {

using Points = std::span<Eigen::Vector3d>;

struct Spread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

Spread spreadOf(Points points) {
  Spread m;
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
    const Spread m = spreadOf(points);
    const auto [values, axes] = planeAxes(m.covariance);
    const bool last = splits_left == 0 || points.size() < 2 * minimum_;
    const double noise = last ? settings_.patch_rough_noise_m : settings_.patch_noise_m;
    const double floor = last ? settings_.patch_rough_floor_m : settings_.patch_floor_m;
    if (fitsPlane(m.mean, values, axes.col(0), noise, floor)) {
      appendPatch(m.mean, values, axes, static_cast<double>(points.size()), out_);
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
  const RegistrationSettings& settings_;
  std::size_t minimum_;
  SurfaceElements& out_;
};

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

}  // namespace

SurfaceElements cubePatches(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                            const RegistrationSettings& settings) {
  std::vector<Eigen::Vector3d> valid, grouped;
  valid.reserve(image.validCells());
  for (std::size_t cell = 0; cell < image.cells(); ++cell)
    if (image.hasPoint(cell)) valid.push_back(points[cell]);
  const std::vector<std::size_t> start = groupByCube(valid, settings.patch_size_m, grouped);
  SurfaceElements out;
  Splitter splitter(settings, out);
  for (std::size_t g = 0; g + 1 < start.size(); ++g)
    splitter.split(Points(grouped).subspan(start[g], start[g + 1] - start[g]), settings.patch_splits);
  return out;
}

}  // namespace tiltmap
