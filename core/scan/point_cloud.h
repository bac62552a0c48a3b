// Points derived from a range image; never stored as truth.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/scan/range_image.h"

namespace tiltmap {

// Parallel arrays; an optional one is empty or has one entry a point. Scan frame unless the name says
// otherwise.
struct PointCloud {
  std::vector<Eigen::Vector3d> points;   // metres
  std::vector<Eigen::Vector3d> normals;  // unit, towards the scanner; zero where a point has none
  std::vector<float> intensity;
  std::vector<std::uint32_t> cell;  // row-major cell the point comes from (the first of merged ones)

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
  bool hasNormal(std::size_t i) const { return !normals.empty() && !normals[i].isZero(); }
};

// Every cell that holds a point, in row-major order.
PointCloud cloudOf(const RangeImage& image, const ScannerGeometry& geometry);

}  // namespace tiltmap
