// Getting a tilted planar scanner's angles back from the points it measured.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/scan/scanner_geometry.h"

namespace tiltmap {

// A regular grid found in a matrix of points: every point lies within the tolerance of
// geometry.point(line_tilt_rad[row], geometry.azimuthOfColumn(column), range_m[cell]).
struct TiltedGrid {
  ScannerGeometry
      geometry;  // without calibration; tilt start and step are the straight line through the tilts
  std::vector<double> line_tilt_rad;  // one a row
  std::vector<float> range_m;         // one a cell; 0 where there is no point
};

// Fits azimuth start and step and one tilt a row to points (row-major, metres). `valid` says which cells hold
// a point. Angles that lie within 1e-4 deg of a multiple of 0.01 deg are taken as that, where all points
// still agree. Nothing when any point is further than tolerance_m from its beam.
std::optional<TiltedGrid> fitTiltedGrid(int rows, int columns, const std::vector<Eigen::Vector3d>& points,
                                        const std::vector<bool>& valid, double tolerance_m);

// The number of points a line, in a list that runs line by line through a grid: the usual distance between
// the places where the azimuth jumps back, where it divides the list into at least two equal lines of at
// least 8 points.
std::optional<int> lineLength(const std::vector<Eigen::Vector3d>& points, const std::vector<bool>& valid);

}  // namespace tiltmap
