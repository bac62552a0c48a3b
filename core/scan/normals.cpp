#include "core/scan/normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "core/base/parallel.h"
#include "core/scan/kd_tree.h"

namespace tiltmap {

namespace {

// An arm seen under a smaller part of the mean angle belongs to a pole. 0.2 leaves out the 8 degrees next to
// either end of a line, where rows of 0.8 degrees are less than 0.2 degrees apart and a point 10 m away has
// arms of 3 cm, hardly more than the scanner's noise.
constexpr double kPoleShare = 0.2;
// Sine between the two arms below which they count as parallel.
constexpr double kParallelSine = 0.02;
// Ratio of the middle to the largest eigenvalue (m^2 over m^2) of points on a line.
constexpr double kLineRatio = 1e-6;

struct Arms {
  Eigen::Vector3d down, right;       // x(i-1,j) - x(i+1,j) and x(i,j-1) - x(i,j+1), metres
  double down_angle2, right_angle2;  // squared angle (chord) between the neighbours' directions
};

// Calls use(cell, arms) for every cell that has a point and four neighbours with points.
template <class Use>
void forEachCross(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                  const std::vector<Eigen::Vector3d>& directions, const Use& use) {
  const auto columns = static_cast<std::size_t>(image.columns());
  for (int row = 1; row + 1 < image.rows(); ++row) {
    for (int column = 1; column + 1 < image.columns(); ++column) {
      const std::size_t cell = image.index(row, column);
      const std::size_t up = cell - columns, down = cell + columns, left = cell - 1, right = cell + 1;
      if (!image.hasPoint(cell) || !image.hasPoint(up) || !image.hasPoint(down) || !image.hasPoint(left) ||
          !image.hasPoint(right))
        continue;
      use(cell, Arms{points[up] - points[down], points[left] - points[right],
                     (directions[up] - directions[down]).squaredNorm(),
                     (directions[left] - directions[right]).squaredNorm()});
    }
  }
}

Eigen::Vector3d planeNormal(const KdTree& tree, const std::vector<Eigen::Vector3d>& points,
                            const Eigen::Vector3d& point, std::size_t neighbours,
                            const Eigen::Vector3d& origin, std::vector<KdTree::Neighbour>& found) {
  tree.nearestSeveral(point, neighbours, found);
  if (found.size() < 3) return Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& neighbour : found)
    mean += points[neighbour.index] - point;  // small numbers keep their digits
  mean /= static_cast<double>(found.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& neighbour : found) {
    const Eigen::Vector3d d = points[neighbour.index] - point - mean;
    scatter.noalias() += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter);
  const Eigen::Vector3d& spread = solver.eigenvalues();  // ascending
  if (!(spread[1] > kLineRatio * spread[2])) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
  return normal.dot(origin - point) < 0.0 ? Eigen::Vector3d(-normal) : normal;
}

}  // namespace

std::vector<Eigen::Vector3d> matrixNormals(const RangeImage& image,
                                           const std::vector<Eigen::Vector3d>& points) {
  if (points.size() != image.cells())
    throw std::invalid_argument("matrixNormals: there is not one point a cell");
  std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::Zero());
  if (!image.isMatrix()) return normals;

  std::vector<Eigen::Vector3d> directions(points.size());
  for (std::size_t cell = 0; cell < points.size(); ++cell) {
    const double length = points[cell].norm();
    directions[cell] = length > 0.0 ? Eigen::Vector3d(points[cell] / length) : Eigen::Vector3d::Zero();
  }
  double down_sum = 0.0, right_sum = 0.0, count = 0.0;
  forEachCross(image, points, directions, [&](std::size_t, const Arms& arms) {
    down_sum += std::sqrt(arms.down_angle2);
    right_sum += std::sqrt(arms.right_angle2);
    count += 1.0;
  });
  if (count == 0.0) return normals;
  const double down_least = kPoleShare * down_sum / count, right_least = kPoleShare * right_sum / count;
  const double down_least2 = down_least * down_least, right_least2 = right_least * right_least;

  forEachCross(image, points, directions, [&](std::size_t cell, const Arms& arms) {
    if (arms.down_angle2 < down_least2 || arms.right_angle2 < right_least2) return;
    const Eigen::Vector3d cross = arms.down.cross(arms.right);
    const double length2 = cross.squaredNorm();
    const double arms2 = arms.down.squaredNorm() * arms.right.squaredNorm();
    if (!(length2 > kParallelSine * kParallelSine * arms2)) return;
    const Eigen::Vector3d normal = cross / std::sqrt(length2);
    // As printed it points at the scanner where rows run upwards and columns leftwards; other matrices exist.
    normals[cell] = normal.dot(points[cell]) > 0.0 ? Eigen::Vector3d(-normal) : normal;
  });
  return normals;
}

std::vector<Eigen::Vector3d> cloudNormals(const std::vector<Eigen::Vector3d>& points, int neighbours,
                                          const Eigen::Vector3d& origin, int threads) {
  if (neighbours < 3) throw std::invalid_argument("cloudNormals: a plane needs three neighbours");
  const KdTree tree(points);
  std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::Zero());
  constexpr std::size_t kBlock = 512;
  parallelFor((points.size() + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    std::vector<KdTree::Neighbour> found;
    const std::size_t end = std::min(points.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i)
      normals[i] = planeNormal(tree, points, points[i], static_cast<std::size_t>(neighbours), origin, found);
  });
  return normals;
}

}  // namespace tiltmap
