// The stops of the experiments: where the machine really stood, and where its odometry says it did.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry/pose.h"
#include "core/world/ground.h"
#include "core/world/street_grid.h"

namespace tiltmap {

// One row of the thesis' tables 5.1 to 6.3: metres, heading vector.
struct TableRow {
  double x_m, y_m, z_m;
  double heading_x, heading_y, heading_z;

  Pose pose() const { return Pose::fromHeading({x_m, y_m, z_m}, {heading_x, heading_y, heading_z}); }
};

// Experiment 1 as measured (table 5.1) and as registered (table 5.2). Stop 1 of the latter has its heading's
// x negative: the print gives +0.603065 for a measured -0.707, and one of the two signs is wrong.
const std::vector<TableRow>& experiment1Measured();
const std::vector<TableRow>& experiment1Result();
// Experiment 2 as measured (table 6.1) and relaxed (table 6.3).
const std::vector<TableRow>& experiment2Measured();
const std::vector<TableRow>& experiment2Result();
// As measured, with the two rows mended that both results contradict: y of stop 1 (1.4 for 2.8) and the
// heading of stop 13 ((0,1,0) for (1,0,0)).
std::vector<TableRow> experiment2Mended();

// A place on the way of a drive along the streets, in the grid's own plane.
struct CoursePlace {
  double u_m = 0.0, v_m = 0.0;
  double heading_rad = 0.0;  // against +v, left positive
};

// `count` places step_m apart along the streets of a style, from v = start_v_m of a main street towards +v,
// in the middle of the lane, corners rounded with radius kCornerM. At each crossing turn_at(number of the
// crossing) says -1 right, 0 straight, +1 left.
inline constexpr double kCornerM = 6.0;
std::vector<CoursePlace> courseAlongStreets(const QuarterStyle& style, std::size_t count, double step_m,
                                            double start_v_m, const std::function<int(std::size_t)>& turn_at);

}  // namespace tiltmap
