// Scans of scenes one can work out by hand: a matrix of the default scanner that looks at a set of planes.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "core/scan/range_image.h"

namespace tiltmap::test_support {

// normal . p = offset, in the world frame.
struct ScenePlane {
  Eigen::Vector3d normal;
  double offset_m;
};

// Floor 1 m below the world's origin, two walls to the left and right, one in front at an angle, and one
// behind a step: every direction is determined.
inline std::vector<ScenePlane> roomScene() {
  return {{{0, 0, 1}, -1.0},
          {{1, 0, 0}, 4.0},
          {{-1, 0, 0}, 5.0},
          {Eigen::Vector3d(0.2, 1, 0.1).normalized(), 7.0},
          {Eigen::Vector3d(0.0, 0.5, 1).normalized(), 4.5}};
}
inline std::vector<ScenePlane> groundScene() {
  return {{{0, 0, 1}, -1.0}};
}

// What the default scanner at the pose sees: the first plane along each beam, up to 30 m, with normal noise.
// The scan claims the default geometry; `really` is what its beams follow.
inline Scan sceneScan(const std::vector<ScenePlane>& planes, const Pose& world_from_scan,
                      double noise_m = 0.0, std::uint64_t seed = 1, const ScannerGeometry& really = {}) {
  Scan scan;
  RangeImageData data;
  data.rows = scan.geometry.rows;
  data.columns = scan.geometry.columns;
  RandomStream random(seed);
  for (int row = 0; row < data.rows; ++row) {
    data.line_tilt_rad.push_back(scan.geometry.tiltOfRow(row));
    for (int column = 0; column < data.columns; ++column) {
      const double tilt = scan.geometry.tiltOfRow(row), azimuth = scan.geometry.azimuthOfColumn(column);
      const Eigen::Vector3d ray = world_from_scan.quaternion() * really.direction(tilt, azimuth);
      const Eigen::Vector3d mirror = world_from_scan * really.point(tilt, azimuth, -really.range_offset_m);
      double range = std::numeric_limits<double>::infinity();
      for (const ScenePlane& plane : planes) {
        const double towards = plane.normal.dot(ray);
        const double r = (plane.offset_m - plane.normal.dot(mirror)) / towards;
        if (std::abs(towards) > 1e-9 && r > 0.1 && r < range) range = r;
      }
      if (range < 30.0) range += noise_m * random.normal() - really.range_offset_m;
      data.range_m.push_back(range < 30.0 ? static_cast<float>(range) : 0.0F);
      data.code.push_back(range < 30.0 ? cell_code::kMeasured : cell_code::kLmsOverflow);
    }
  }
  scan.image = RangeImage::make(std::move(data)).value();
  scan.name = "scene";
  scan.source = "test";
  return scan;
}

// A matrix with nothing in it, but for the cells given.
inline Scan almostEmptyScan(int points) {
  Scan scan;
  RangeImageData data;
  data.rows = scan.geometry.rows;
  data.columns = scan.geometry.columns;
  data.range_m.assign(data.cells(), 0.0F);
  data.code.assign(data.cells(), cell_code::kNoReturn);
  for (int row = 0; row < data.rows; ++row) data.line_tilt_rad.push_back(scan.geometry.tiltOfRow(row));
  for (int i = 0; i < points; ++i) {
    data.range_m[static_cast<std::size_t>(20 * 361 + 180 + i)] = 5.0F;
    data.code[static_cast<std::size_t>(20 * 361 + 180 + i)] = cell_code::kMeasured;
  }
  scan.image = RangeImage::make(std::move(data)).value();
  return scan;
}

}  // namespace tiltmap::test_support
