// Fewer points with the same shape (thesis 4.2.2.3).
#pragma once

#include "core/scan/point_cloud.h"

namespace tiltmap {

// Along each line of the matrix, disjoint pairs of neighbours nearer than distance_m become their midpoint,
// in passes, until no two neighbours of the line are nearer. Never the chasing kind, which lets a wall
// collapse into one point. A cell that holds no point ends the run: points to either side of a gap never
// merge across it. Normals of merged points are averaged and normalised, intensities averaged, over all
// points that went in. `points` are cellPoints() of the same image; `normals` is empty or one slot a cell. An
// unordered image is reduced on a voxel grid of distance_m instead. A distance of zero reduces nothing.
// Throws std::invalid_argument for sizes that do not fit and a distance that is negative or not finite.
PointCloud reducedAlongLines(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                             const std::vector<Eigen::Vector3d>& normals, double distance_m);

// One point, the mean, for each cube of edge size_m that holds any; order of first appearance. Normals and
// intensities as above. Throws std::invalid_argument for an edge that is not positive, points that are not
// finite or more than 2^53 edges from the origin, and optional arrays of another length.
PointCloud voxelReduced(const PointCloud& cloud, double size_m);

}  // namespace tiltmap
