#include "core/products/residuals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/parallel.h"
#include "core/base/ranks.h"
#include "core/scan/normals.h"

namespace tiltmap {

using Eigen::Vector3d;

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr int kCloudNeighbours = 12;
constexpr std::size_t kSurfacesKept = 16;

// The mean over the cell and those around it whose normals point about the same way: the normal of one cell
// rests on four ranges, each with its noise.
std::vector<Vector3d> smoothed(const RangeImage& image, const std::vector<Vector3d>& normals) {
  std::vector<Vector3d> result(normals.size(), Vector3d::Zero());
  for (int row = 0; row < image.rows(); ++row)
    for (int column = 0; column < image.columns(); ++column) {
      const Vector3d& own = normals[image.index(row, column)];
      if (own.isZero()) continue;
      Vector3d sum = Vector3d::Zero();
      for (int r = std::max(0, row - 1); r <= std::min(image.rows() - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(image.columns() - 1, column + 1); ++c) {
          const Vector3d& other = normals[image.index(r, c)];
          if (other.dot(own) > 0.7) sum += other;
        }
      result[image.index(row, column)] = sum.normalized();
    }
  return result;
}

// A slot a cell, zero where there is no surface to speak of.
std::vector<Vector3d> surfaceNormals(const RangeImage& image, const std::vector<Vector3d>& points) {
  if (image.isMatrix()) return smoothed(image, matrixNormals(image, points));
  std::vector<Vector3d> valid;
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < image.cells(); ++cell)
    if (image.hasPoint(cell)) {
      valid.push_back(points[cell]);
      cells.push_back(cell);
    }
  std::vector<Vector3d> result(points.size(), Vector3d::Zero());
  if (valid.size() < 3) return result;
  const auto normals = cloudNormals(valid, kCloudNeighbours, Vector3d::Zero());
  for (std::size_t i = 0; i < cells.size(); ++i) result[cells[i]] = normals[i];
  return result;
}

void mixIn(std::uint64_t& hash, std::uint64_t value) {
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6) + (hash >> 2);
  hash *= 0xff51afd7ed558ccdULL;
  hash ^= hash >> 33;
}

void mixIn(std::uint64_t& hash, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  mixIn(hash, bits);
}

}  // namespace

ResidualSurface::ResidualSurface(std::vector<Vector3d> points, std::vector<Vector3d> normals)
    : points_(std::move(points)), normals_(std::move(normals)), tree_(points_) {}

ResidualSurface ResidualSurface::of(const RangeImage& image, const ScannerGeometry& geometry) {
  const std::vector<Vector3d> points = cellPoints(image, geometry);
  const std::vector<Vector3d> normals = surfaceNormals(image, points);
  std::vector<Vector3d> chosen, directions;
  for (std::size_t cell = 0; cell < normals.size(); ++cell)
    if (!normals[cell].isZero()) {
      chosen.push_back(points[cell]);
      directions.push_back(normals[cell]);
    }
  return ResidualSurface(std::move(chosen), std::move(directions));
}

ResidualSurface::ResidualSurface(const RangeImage& image, const ScannerGeometry& geometry)
    : ResidualSurface(of(image, geometry)) {}

std::optional<ResidualSurface::Found> ResidualSurface::distanceOf(const Vector3d& point,
                                                                  const Vector3d& facing, double least_cosine,
                                                                  double max_distance_m) const {
  KdTree::Neighbour nearest;
  if (tree_.empty() || !tree_.nearestWithin(point, max_distance_m, nearest)) return {};
  const Vector3d& normal = normals_[nearest.index];
  if (normal.dot(facing) < least_cosine) return {};
  return Found{normal.dot(point - points_[nearest.index]), std::sqrt(nearest.squared_distance)};
}

Result<std::vector<float>> cellResiduals(const RangeImage& image, const ScannerGeometry& geometry,
                                         const Pose& world_from_scan, std::span<const PlacedSurface> others,
                                         const ResidualSettings& settings, const JobControl& control,
                                         int threads) {
  std::vector<float> residuals(image.cells(), kNothing);
  const std::vector<Vector3d> points = cellPoints(image, geometry);
  const std::vector<Vector3d> normals = surfaceNormals(image, points);
  std::vector<Pose> other_from_scan;
  for (const PlacedSurface& other : others)
    other_from_scan.push_back(other.world_from_scan.inverse() * world_from_scan);
  // A cloud without a matrix is one long row: pieces of equal length either way.
  constexpr std::size_t kPiece = 512;
  const std::size_t pieces = (image.cells() + kPiece - 1) / kPiece;
  parallelFor(pieces, threads, [&](std::size_t piece) {
    if (control.stopRequested()) return;
    for (std::size_t cell = piece * kPiece; cell < std::min(image.cells(), (piece + 1) * kPiece); ++cell) {
      if (!image.hasPoint(cell)) continue;
      // Without a normal of its own the cell at least faces its scanner.
      const bool has_normal = !normals[cell].isZero();
      const Vector3d facing = has_normal ? normals[cell] : Vector3d(-points[cell].normalized());
      const double least_cosine = has_normal ? std::cos(settings.max_angle_rad) : 0.0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < others.size(); ++k) {
        const auto found = others[k].surface->distanceOf(other_from_scan[k] * points[cell],
                                                         other_from_scan[k].rotation() * facing, least_cosine,
                                                         settings.max_distance_m);
        if (!found || !(found->away_m < nearest)) continue;
        nearest = found->away_m;
        residuals[cell] = static_cast<float>(found->distance_m);
      }
    }
  });
  if (control.stopRequested()) return fail(kCancelled, "", "");
  return residuals;
}

std::vector<std::size_t> residualPartners(const ProjectSnapshot& snapshot, std::size_t scan) {
  std::vector<std::size_t> partners;
  const ScanId id = snapshot.scans().at(scan).id;
  for (const Link& link : snapshot.linksOf(id)) {
    if (!link.succeeded || link.state != LinkState::Active) continue;
    const auto other = snapshot.indexOf(link.fixed == id ? link.moving : link.fixed);
    if (other && *other != scan) partners.push_back(*other);
  }
  if (partners.empty()) {
    if (scan > 0) partners.push_back(scan - 1);
    if (scan + 1 < snapshot.scans().size()) partners.push_back(scan + 1);
  }
  std::sort(partners.begin(), partners.end());
  partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
  return partners;
}

ProjectResiduals::ProjectResiduals(SnapshotPtr snapshot, Stage stage, const ResidualSettings& settings,
                                   int threads)
    : snapshot_(std::move(snapshot)),
      settings_(settings),
      threads_(threads),
      world_from_scan_(snapshot_->filledPoses(stage)) {}

Result<std::shared_ptr<const ResidualSurface>> ProjectResiduals::surfaceOf(std::size_t scan) {
  Kept& kept = surfaces_[scan];
  kept.used = ++uses_;
  if (!kept.surface) {
    const ScanEntry& entry = snapshot_->scans()[scan];
    const auto image = entry.image();
    if (!image) {
      surfaces_.erase(scan);
      return fail(image.error());
    }
    kept.surface = std::make_shared<const ResidualSurface>(**image, entry.geometry);
  }
  const std::shared_ptr<const ResidualSurface> surface = kept.surface;
  if (surfaces_.size() > kSurfacesKept)
    surfaces_.erase(std::min_element(surfaces_.begin(), surfaces_.end(), [](const auto& a, const auto& b) {
      return a.second.used < b.second.used;
    }));
  return surface;
}

Result<std::vector<float>> ProjectResiduals::of(std::size_t scan, const JobControl& control) {
  const ScanEntry& entry = snapshot_->scans().at(scan);
  const auto image = entry.image();
  if (!image) return fail(image.error());
  std::vector<PlacedSurface> others;
  for (const std::size_t partner : residualPartners(*snapshot_, scan)) {
    if (control.stopRequested()) return fail(kCancelled, "", "");
    auto surface = surfaceOf(partner);
    if (!surface) return fail(surface.error());
    others.push_back({*surface, world_from_scan_[partner]});
  }
  return cellResiduals(**image, entry.geometry, world_from_scan_[scan], others, settings_, control, threads_);
}

std::uint64_t ProjectResiduals::fingerprint(const ProjectSnapshot& snapshot,
                                            const std::vector<Pose>& world_from_scan, std::size_t scan) {
  std::uint64_t hash = 0x51ab;
  const auto add = [&](std::size_t index) {
    const ScanEntry& entry = snapshot.scans().at(index);
    mixIn(hash, static_cast<std::uint64_t>(entry.id));
    mixIn(hash, static_cast<std::uint64_t>(entry.matrix));
    mixIn(hash, static_cast<std::uint64_t>(entry.lines));
    mixIn(hash, static_cast<std::uint64_t>(entry.geometry_id));
    for (int i = 0; i < 3; ++i) mixIn(hash, world_from_scan[index].translation()[i]);
    for (int i = 0; i < 4; ++i) mixIn(hash, world_from_scan[index].quaternion().coeffs()[i]);
  };
  add(scan);
  for (const std::size_t partner : residualPartners(snapshot, scan)) add(partner);
  return hash;
}

ResidualSummary summaryOf(const std::vector<float>& residuals) {
  std::vector<float> sizes;
  for (const float r : residuals)
    if (std::isfinite(r)) sizes.push_back(std::abs(r));
  if (sizes.empty()) return {};
  return {sizes.size(), medianOf(std::move(sizes))};
}

double largestShownResidual(double median_m) {
  return std::max(3.0 * 1.4826 * median_m, 1e-3);
}

}  // namespace tiltmap
