// Walls that one knows by heart, for looking at what the 3D view makes of them.
#pragma once

#include "core/project/project.h"
#include "tests/support/range_images.h"

namespace tiltmap::test {

struct WallGrid {
  int rows = 81, columns = 161;
  double high_deg = 40.0, wide_deg = 40.0;  // about straight ahead
};

// What a scanner sees of a wall `distance_m` ahead of it, that is at y = distance_m.
inline Scan wallOf(const Pose& odometry, const std::string& name, const WallGrid& grid = {},
                   double distance_m = 4.0) {
  Scan scan;
  scan.geometry.rows = grid.rows;
  scan.geometry.columns = grid.columns;
  scan.geometry.azimuth_start_rad = (90.0 - 0.5 * grid.wide_deg) * kDegree;
  scan.geometry.azimuth_step_rad = grid.wide_deg / (grid.columns - 1) * kDegree;
  scan.geometry.tilt_start_rad = -0.5 * grid.high_deg * kDegree;
  scan.geometry.tilt_step_rad = grid.high_deg / (grid.rows - 1) * kDegree;
  scan.image = testing_support::imageOfScene(
      scan.geometry, [distance_m](const Eigen::Vector3d& d) { return distance_m / d.y(); });
  scan.odometry = odometry;
  scan.name = name;
  scan.source = "a wall";
  return scan;
}

}  // namespace tiltmap::test
