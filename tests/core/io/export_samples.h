// Scans to be written and read back.
#pragma once

#include <vector>

#include "core/base/random.h"
#include "core/io/cloud_writer.h"

namespace tiltmap::test {

// A sweep through a made-up room, some cells empty, with intensity and a pose that turns about every axis.
inline ExportScan sweep(int index, bool regular = true) {
  RandomStream random(static_cast<std::uint64_t>(index) + 40);
  RangeImageData data;
  data.rows = 41;
  data.columns = 91;
  ExportScan scan;
  scan.geometry.rows = 41;
  scan.geometry.columns = 91;
  scan.geometry.azimuth_step_rad = 2.0 * kDegree;
  scan.geometry.tilt_step_rad = 1.5 * kDegree;
  for (int row = 0; row < data.rows; ++row) {
    data.line_tilt_rad.push_back(scan.geometry.tiltOfRow(row));
    for (int column = 0; column < data.columns; ++column) {
      const bool empty = random.uniform() < 0.1;
      data.code.push_back(empty ? cell_code::kNoReturn : cell_code::kMeasured);
      data.range_m.push_back(empty ? 0.0F : static_cast<float>(random.uniform(1.0, 40.0)));
      data.intensity.push_back(static_cast<float>(random.uniform()));
      if (!regular)
        data.direction.push_back(
            Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized().cast<float>());
    }
  }
  scan.index = index;
  scan.image = *RangeImage::make(std::move(data));
  Vector6d d;
  d << 0.1, -0.2, 0.7, 12.25 + index, -7.5, 0.5;
  scan.world_from_scan = Pose().moved(d);
  return scan;
}

// Points in the world frame, in the order of the scans.
inline std::vector<Eigen::Vector3d> worldPoints(const std::vector<ExportScan>& scans) {
  std::vector<Eigen::Vector3d> points;
  for (const ExportScan& scan : scans)
    for (const Eigen::Vector3d& p : cloudOf(*scan.image, scan.geometry).points)
      points.push_back(scan.world_from_scan * p);
  return points;
}

}  // namespace tiltmap::test
