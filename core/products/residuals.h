// How far each measured cell lies from the surfaces that other scans saw, once the poses place them: what a
// registration left over, cell by cell.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/progress.h"
#include "core/project/project_snapshot.h"
#include "core/scan/kd_tree.h"

namespace tiltmap {

struct ResidualSettings {
  // A cell with no measured surface point of another scan this near does not overlap.
  double max_distance_m = 0.5;
  // Nor does one whose own surface faces elsewhere: the two sides of a wall, a kerb's edge.
  double max_angle_rad = 0.9;
};

// The points of one scan that lie on a surface, with its normals. Immutable: any thread.
class ResidualSurface {
 public:
  ResidualSurface(const RangeImage& image, const ScannerGeometry& geometry);

  bool empty() const { return tree_.empty(); }
  std::size_t size() const { return tree_.size(); }
  struct Found {
    double distance_m = 0.0;  // along the surface's normal, positive on the scanner's side
    double away_m = 0.0;      // from the nearest point
  };
  // Scan frame. Nothing where the nearest point is further than max_distance_m, or its normal turned further
  // from the direction `facing` (unit) than the cosine allows.
  std::optional<Found> distanceOf(const Eigen::Vector3d& point, const Eigen::Vector3d& facing,
                                  double least_cosine, double max_distance_m) const;

 private:
  explicit ResidualSurface(std::vector<Eigen::Vector3d> points, std::vector<Eigen::Vector3d> normals);
  static ResidualSurface of(const RangeImage& image, const ScannerGeometry& geometry);

  std::vector<Eigen::Vector3d> points_, normals_;
  KdTree tree_;
};

struct PlacedSurface {
  std::shared_ptr<const ResidualSurface> surface;
  Pose world_from_scan;
};

// One value a cell, row-major, metres; NaN where the cell holds no point or overlaps nothing. Of several
// surfaces the one with the nearest point counts. Error: cancelled.
Result<std::vector<float>> cellResiduals(const RangeImage& image, const ScannerGeometry& geometry,
                                         const Pose& world_from_scan, std::span<const PlacedSurface> others,
                                         const ResidualSettings& settings, const JobControl& control = {},
                                         int threads = 0);

// What the residuals of a scan are taken against: the scans it is linked with (links that succeeded and are
// active), and its neighbours in the survey's order where it has no such link. Indices, ascending.
std::vector<std::size_t> residualPartners(const ProjectSnapshot& snapshot, std::size_t scan);

// The residuals of a project's scans, one after the other; surfaces made for one serve the next. One thread
// at a time.
class ProjectResiduals {
 public:
  ProjectResiduals(SnapshotPtr snapshot, Stage stage, const ResidualSettings& settings = {}, int threads = 0);

  // Error: a scan that cannot be read, cancelled.
  Result<std::vector<float>> of(std::size_t scan, const JobControl& control = {});

  // Two that are equal stand for the same residuals.
  static std::uint64_t fingerprint(const ProjectSnapshot& snapshot, const std::vector<Pose>& world_from_scan,
                                   std::size_t scan);

 private:
  Result<std::shared_ptr<const ResidualSurface>> surfaceOf(std::size_t scan);

  SnapshotPtr snapshot_;
  ResidualSettings settings_;
  int threads_;
  std::vector<Pose> world_from_scan_;
  struct Kept {
    std::shared_ptr<const ResidualSurface> surface;
    std::uint64_t used = 0;
  };
  std::map<std::size_t, Kept> surfaces_;
  std::uint64_t uses_ = 0;
};

// Of residuals: how many cells overlap, and the median of their sizes.
struct ResidualSummary {
  std::size_t cells = 0;
  double median_m = 0.0;
};
ResidualSummary summaryOf(const std::vector<float>& residuals);
// Where a colour scale about zero ends, metres: three deviations, as the median of the sizes tells them, so
// that trees do not make everything else grey; at least a millimetre.
double largestShownResidual(double median_m);

}  // namespace tiltmap
