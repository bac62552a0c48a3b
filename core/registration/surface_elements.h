// What registration works on: points with normals, or plane patches, in the scan frame.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tiltmap {

// How well a patch's plane is known. u and v are the in-plane axes (unit, scan frame).
struct PatchShape {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  double offset_variance_m2 = 0.0;  // of the plane's place along its normal, at the centre
  double tilt_variance_u =
      0.0;  // of the slope along u: the plane at distance d along u is off by d^2 times this
  double tilt_variance_v = 0.0;
  double extent_u_m = 0.0;  // deviation of the patch's points along u and v
  double extent_v_m = 0.0;
  double residual_m = 0.0;  // deviation of the points across the plane
  std::uint32_t count = 0;  // points
};

struct SurfaceElements {
  std::vector<Eigen::Vector3d> position;  // metres: a point, or a patch's centre
  std::vector<Eigen::Vector3d> normal;    // unit, towards the scanner; zero where there is none
  std::vector<PatchShape> shape;          // one an element, or empty for points
  std::vector<std::uint32_t> cell;        // row-major cell a point comes from; empty for patches

  std::size_t size() const { return position.size(); }
  bool empty() const { return position.empty(); }
  bool arePatches() const { return !shape.empty(); }
};

}  // namespace tiltmap
