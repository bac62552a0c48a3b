#include "core/scan/reduction.h"

#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace tiltmap {

namespace {

// A point on its way through the passes, or a voxel that fills.
struct Merged {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_sum = Eigen::Vector3d::Zero();
  double intensity_sum = 0.0;
  double count = 1.0;      // points that went in
  std::uint32_t cell = 0;  // of the first
};

Merged midpoint(const Merged& a, const Merged& b) {
  return {0.5 * (a.point + b.point), a.normal_sum + b.normal_sum, a.intensity_sum + b.intensity_sum,
          a.count + b.count, a.cell};
}

// One pass over a run: pairs from its start on, each point in one pair at most. False where none was near
// enough.
bool mergePairs(std::vector<Merged>& run, double squared_distance) {
  std::size_t kept = 0;
  const std::size_t size = run.size();
  for (std::size_t i = 0; i < size; ++kept) {
    const bool merge = i + 1 < size && (run[i].point - run[i + 1].point).squaredNorm() < squared_distance;
    run[kept] = merge ? midpoint(run[i], run[i + 1]) : run[i];
    i += merge ? 2 : 1;
  }
  run.resize(kept);
  return kept < size;
}

Eigen::Vector3d unitOrZero(const Eigen::Vector3d& sum) {
  const double length = sum.norm();
  return length > 1e-9 ? Eigen::Vector3d(sum / length) : Eigen::Vector3d::Zero();  // opposite normals cancel
}

void append(const Merged& merged, bool with_normals, bool with_intensity, PointCloud& cloud) {
  cloud.points.push_back(merged.point);
  cloud.cell.push_back(merged.cell);
  if (with_normals) cloud.normals.push_back(unitOrZero(merged.normal_sum));
  if (with_intensity) cloud.intensity.push_back(static_cast<float>(merged.intensity_sum / merged.count));
}

using VoxelKey = std::array<long long, 3>;

std::size_t scattered(const VoxelKey& key) {
  std::uint64_t h = 0;
  for (const long long part : key) {
    h = (h ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 32;
  }
  return static_cast<std::size_t>(h);
}

// Voxels by key: open addressing in a table of at least twice as many slots as points.
class VoxelTable {
 public:
  explicit VoxelTable(std::size_t points) : slots_(std::bit_ceil(2 * points + 2), kFree) {}

  // The voxel's number, in order of first appearance.
  std::size_t number(const VoxelKey& key) {
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t at = scattered(key) & mask;; at = (at + 1) & mask) {
      if (slots_[at] == kFree) {
        slots_[at] = keys_.size();
        keys_.push_back(key);
        return slots_[at];
      }
      if (keys_[slots_[at]] == key) return slots_[at];
    }
  }

 private:
  static constexpr std::size_t kFree = ~std::size_t{0};
  std::vector<std::size_t> slots_;
  std::vector<VoxelKey> keys_;
};

VoxelKey voxelOf(const Eigen::Vector3d& point, double size_m) {
  VoxelKey key{};
  for (int axis = 0; axis < 3; ++axis) {
    const double place = std::floor(point[axis] / size_m);
    if (!(std::abs(place) < 0x1p53))
      throw std::invalid_argument("voxelReduced: a point is not finite or too far for voxels of this size");
    key[static_cast<std::size_t>(axis)] = static_cast<long long>(place);
  }
  return key;
}

PointCloud pointsOf(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                    const std::vector<Eigen::Vector3d>& normals) {
  PointCloud cloud;
  for (std::size_t cell = 0; cell < image.cells(); ++cell) {
    if (!image.hasPoint(cell)) continue;
    cloud.points.push_back(points[cell]);
    cloud.cell.push_back(static_cast<std::uint32_t>(cell));
    if (!normals.empty()) cloud.normals.push_back(normals[cell]);
    if (image.hasIntensity()) cloud.intensity.push_back(image.intensity(cell));
  }
  return cloud;
}

}  // namespace

PointCloud reducedAlongLines(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                             const std::vector<Eigen::Vector3d>& normals, double distance_m) {
  if (points.size() != image.cells() || (!normals.empty() && normals.size() != image.cells()))
    throw std::invalid_argument("reducedAlongLines: there is not one point or normal a cell");
  if (!(distance_m >= 0.0) || !std::isfinite(distance_m))
    throw std::invalid_argument("reducedAlongLines: the distance must be finite and not negative");
  if (distance_m == 0.0) return pointsOf(image, points, normals);
  if (!image.isMatrix()) return voxelReduced(pointsOf(image, points, normals), distance_m);

  PointCloud cloud;
  const bool with_normals = !normals.empty();
  const double squared_distance = distance_m * distance_m;
  std::vector<Merged> run;
  run.reserve(static_cast<std::size_t>(image.columns()));
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns();) {
      run.clear();
      for (; column < image.columns() && image.hasPoint(row, column); ++column) {
        const std::size_t cell = image.index(row, column);
        run.push_back({points[cell], with_normals ? normals[cell] : Eigen::Vector3d::Zero(),
                       image.hasIntensity() ? static_cast<double>(image.intensity(cell)) : 0.0, 1.0,
                       static_cast<std::uint32_t>(cell)});
      }
      while (mergePairs(run, squared_distance)) {
      }
      for (const Merged& merged : run) append(merged, with_normals, image.hasIntensity(), cloud);
      while (column < image.columns() && !image.hasPoint(row, column)) ++column;
    }
  }
  return cloud;
}

PointCloud voxelReduced(const PointCloud& cloud, double size_m) {
  if (!(size_m > 0.0) || !std::isfinite(size_m))
    throw std::invalid_argument("voxelReduced: the edge must be finite and positive");
  const auto fits = [&](std::size_t size) { return size == 0 || size == cloud.size(); };
  if (!fits(cloud.normals.size()) || !fits(cloud.intensity.size()) || !fits(cloud.cell.size()))
    throw std::invalid_argument("voxelReduced: an array of the cloud has another length");

  VoxelTable table(cloud.size());
  std::vector<Merged> voxels;  // `point` is the sum until the end
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t number = table.number(voxelOf(cloud.points[i], size_m));
    if (number == voxels.size()) {
      voxels.push_back({});
      voxels.back().count = 0.0;
      if (!cloud.cell.empty()) voxels.back().cell = cloud.cell[i];
    }
    Merged& voxel = voxels[number];
    voxel.point += cloud.points[i];
    if (!cloud.normals.empty()) voxel.normal_sum += cloud.normals[i];
    if (!cloud.intensity.empty()) voxel.intensity_sum += static_cast<double>(cloud.intensity[i]);
    voxel.count += 1.0;
  }
  PointCloud result;
  for (Merged& voxel : voxels) {
    voxel.point /= voxel.count;
    append(voxel, !cloud.normals.empty(), !cloud.intensity.empty(), result);
  }
  if (cloud.cell.empty()) result.cell.clear();
  return result;
}

}  // namespace tiltmap
