// Where each beam of a tilted planar scanner goes, and which beam sees a given point.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/result.h"

namespace tiltmap {

// A fractional place in the range matrix.
struct MatrixPlace {
  double row = 0.0;
  double column = 0.0;
  double range_m = 0.0;  // the range the scanner would print (range offset taken out)
};

// The scan frame: x right, y forward, z up, metres; the origin lies on the tilt axis, which is the x axis.
// With no lever arm that is the mirror centre.
//
// Column j looks at azimuth a = azimuth_start + j * azimuth_step (0 = right, pi = left); row i is taken at
// the tilt e of its line (nominally tilt_start + i * tilt_step, positive looks up). A beam of printed range r
// ends at
//
//   p = Rx(e + tilt_zero) * (lever_arm + mounting * ((r + range_offset) * (cos a, sin a, 0)))
//
// which without calibration is r * (cos a, sin a cos e, sin a sin e). Angles in radians.
struct ScannerGeometry {
  int rows = 101;
  int columns = 361;
  double azimuth_start_rad = 0.0;
  double azimuth_step_rad = 0.00872664625997164788;  // 0.5 deg
  double tilt_start_rad = -0.52359877559829887308;   // -30 deg
  double tilt_step_rad = 0.01396263401595463662;     // 0.8 deg

  // Calibration.
  double tilt_zero_rad = 0.0;                                    // added to every tilt angle
  Eigen::Vector3d lever_arm_m = Eigen::Vector3d::Zero();         // tilt axis to mirror centre, at tilt 0
  Eigen::Quaterniond mounting = Eigen::Quaterniond::Identity();  // mirror plane in the tilting frame
  double range_offset_m = 0.0;                                   // added to every printed range
  double minimum_range_m = 0.0;                                  // nearer is the machine's own body
  double maximum_range_m = 0.0;                                  // 0: no bound

  double tiltOfRow(int row) const { return tilt_start_rad + row * tilt_step_rad; }
  double azimuthOfColumn(int column) const { return azimuth_start_rad + column * azimuth_step_rad; }

  // Unit direction of a beam from the mirror centre, in the scan frame.
  Eigen::Vector3d direction(double tilt_rad, double azimuth_rad) const;
  // Where a beam with this printed range ends.
  Eigen::Vector3d point(double tilt_rad, double azimuth_rad, double range_m) const;
  // The other way: the place in the matrix (nominal tilts) whose beam goes through the point. Two beams may:
  // at the front of one tilt and at the back of another; the place inside the matrix or nearer to it is
  // given, either one where both are inside. It may lie outside: compare with rows and columns. Every row
  // sees a point on the tilt axis (without a lever arm); it is given the middle one. Nothing for a point that
  // no beam reaches: at the mirror, nearer than the range offset, or beside what the beam plane sweeps.
  std::optional<MatrixPlace> place(const Eigen::Vector3d& point_m) const;

  // Sizes positive, steps not zero, everything finite, range bounds in order.
  Status check() const;

 private:
  std::optional<MatrixPlace> placeAtTilt(double tilt_rad, const Eigen::Vector3d& point_m) const;
};

}  // namespace tiltmap
