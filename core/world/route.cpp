#include "core/world/route.h"

#include <cmath>
#include <functional>

namespace tiltmap {

const std::vector<TableRow>& experiment1Measured() {
  static const std::vector<TableRow> rows{{0, 0, 0, 0, 1, 0},
                                          {0, 0, 0, -0.707, 0.707, 0},
                                          {0, 4, 0, 0, 1, 0},
                                          {0, 6, 0, 0, 1, 0},
                                          {0, 6, 0, 0.707, 0.707, 0}};
  return rows;
}

const std::vector<TableRow>& experiment1Result() {
  static const std::vector<TableRow> rows{{0, 0, 0, 0, 1, 0},
                                          {-0.15, -0.07, 0, -0.603065, 0.796474, 0.044066},
                                          {0.34, 3.67, -0.14, 0.018828, 0.999814, 0.004127},
                                          {0.48, 6.05, -0.16, 0.011945, 0.999929, 0.000166},
                                          {0.96, 5.94, -0.22, 0.668880, 0.743350, 0.005261}};
  return rows;
}

const std::vector<TableRow>& experiment2Measured() {
  static const std::vector<TableRow> rows{{0, 0, 0, 0, 1, 0},
                                          {1.4, 2.8, 0, 0.7071, 0.7071, 0},
                                          {2.8, 2.8, 0, 0.7071, 0.7071, 0},
                                          {4.2, 4.2, 0, 1, 0, 0},
                                          {4.2, 4.2, 0, 0.7071, 0.7071, 0},
                                          {7, 7, 0, 0.7071, 0.7071, 0},
                                          {9.9, 9.9, 0, 0.7071, 0.7071, 0},
                                          {11, 11, 0, 0.7071, 0.7071, 0},
                                          {14, 14, 0, 0.7071, 0.7071, 0},
                                          {15.5, 15.5, 0, 0, 1, 0},
                                          {15.5, 15.5, 0, 1, 0, 0},
                                          {15.5, 15.5, 0, 0.7071, 0.7071, 0},
                                          {18.4, 18.4, 0, 0.7071, 0.7071, 0},
                                          {18.4, 18.4, 0, 1, 0, 0}};
  return rows;
}

const std::vector<TableRow>& experiment2Result() {
  static const std::vector<TableRow> rows{{0, 0, 0, 0, 1, 0},
                                          {1.37, 1.40, -0.16, 0.6438, 0.7648, -0.0223},
                                          {2.64, 2.73, -0.27, 0.6235, 0.7817, -0.0141},
                                          {4.39, 4.20, -0.33, 0.9834, 0.1811, 0.009},
                                          {4.07, 4.52, -0.39, 0.6213, 0.7834, -0.0139},
                                          {6.34, 7.20, -0.51, 0.5941, 0.8025, 0.0555},
                                          {8.95, 10.07, -0.78, 0.6411, 0.7658, 0.0504},
                                          {10.12, 11.40, -0.85, 0.6243, 0.78, 0.0432},
                                          {12.57, 14.56, -1.15, 0.6341, 0.7712, 0.0564},
                                          {13.50, 16.82, -1.36, -0.0242, 0.9987, -0.0449},
                                          {13.98, 16.22, -1.19, 0.9889, 0.1439, -0.0373},
                                          {13.77, 16.24, -1.28, 0.6168, 0.7854, 0.052},
                                          {16.50, 19.33, -1.54, 0.6009, 0.7978, -0.05},
                                          {16.25, 19.25, -1.53, 0.0402, 0.9986, -0.0342}};
  return rows;
}

std::vector<TableRow> experiment2Mended() {
  std::vector<TableRow> rows = experiment2Measured();
  rows[1].y_m = 1.4;
  rows[13].heading_x = 0.0;
  rows[13].heading_y = 1.0;
  return rows;
}

std::vector<CoursePlace> courseAlongStreets(const QuarterStyle& style, std::size_t count, double step_m,
                                            double start_v_m,
                                            const std::function<int(std::size_t)>& turn_at) {
  std::vector<CoursePlace> places;
  places.reserve(count);
  CoursePlace here{0.0, start_v_m, 0.0};  // where the present piece of the way begins
  double length = style.pitch_v - kCornerM - start_v_m;
  double done = 0.0;  // of the present piece
  int bend = 0;       // of the present piece: -1 right, 0 straight, +1 left
  bool at_crossing = false;
  std::size_t crossing = 0;
  const auto on = [&](double s) {
    CoursePlace p = here;
    const double fu = -std::sin(here.heading_rad), fv = std::cos(here.heading_rad);  // forward
    if (bend == 0) {
      p.u_m += s * fu;
      p.v_m += s * fv;
    } else {
      const double turned = s / kCornerM;
      const double side = kCornerM * (1.0 - std::cos(turned)) * bend, forward = kCornerM * std::sin(turned);
      p.u_m += forward * fu - side * fv;
      p.v_m += forward * fv + side * fu;
      p.heading_rad += bend * turned;
    }
    return p;
  };
  for (std::size_t k = 0; k < count; ++k) {
    while (done >= length) {
      here = on(length);
      done -= length;
      at_crossing = !at_crossing;
      if (at_crossing) {
        bend = turn_at(crossing++);
        length = bend == 0 ? 2.0 * kCornerM : 0.5 * 3.14159265358979323846 * kCornerM;
      } else {
        bend = 0;
        const bool main = std::abs(std::cos(here.heading_rad)) > 0.5;
        length = (main ? style.pitch_v : style.pitch_u) - 2.0 * kCornerM;
      }
    }
    places.push_back(on(done));
    done += step_m;
  }
  return places;
}

}  // namespace tiltmap
