// Fewer points with the same shape (thesis 4.2.2.3).
#pragma once

#include "core/scan/point_cloud.h"

namespace tiltmap {

// Along each line of the matrix, disjoint pairs of neighbours nearer than distance_m become their midpoint, in
// passes, until no two neighbours of the line are nearer. Never the chasing kind, which lets a wall collapse into
// one point. Cells without a return are 0.71 m apart at 81.89 m, so they end a run and are then dropped.
// Normals of merged points are averaged and normalised, intensities averaged. `normals` is empty or one slot a cell.
// An unordered image (one row) is reduced on a voxel grid of distance_m instead.
PointCloud reducedAlongLines(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                             const std::vector<Eigen::Vector3d>& normals, double distance_m);

// One point, the mean, for each cube of edge size_m that holds any; order of first appearance.
PointCloud voxelReduced(const PointCloud& cloud, double size_m);

}  // namespace tiltmap
