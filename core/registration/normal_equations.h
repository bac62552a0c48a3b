// Sums of a linearised system while they are gathered.
#pragma once

#include <Eigen/Core>

#include "core/registration/metric.h"

namespace tiltmap {

// The upper triangle of sum w J J^T and sum w J r, J = (a, n).
struct NormalEquations {
  double h[21] = {};
  double b[6] = {};

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& n, double w, double r) {
    const double j[6] = {a.x(), a.y(), a.z(), n.x(), n.y(), n.z()};
    int k = 0;
    for (int row = 0; row < 6; ++row) {
      const double wj = w * j[row];
      for (int column = row; column < 6; ++column) h[k++] += wj * j[column];
      b[row] += wj * r;
    }
  }
  void addTo(LinearSystem& system) const {
    int k = 0;
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column, ++k) {
        system.h(row, column) += h[k];
        if (row != column) system.h(column, row) += h[k];
      }
      system.b[row] += b[row];
    }
  }
};

}  // namespace tiltmap
