#include "core/io/tilted_grid.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

#include "core/geometry/pose.h"

namespace tiltmap {

namespace {

constexpr double kPi = std::numbers::pi;

std::size_t cellOf(int row, int column, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

// The angle that differs from `angle` by a multiple of `period` and lies nearest to `reference`.
double nearestTurn(double angle, double reference, double period) {
  return angle - period * std::round((angle - reference) / period);
}

struct Line {
  double start = 0.0;
  double step = 0.0;
};

// Weighted least squares of value = start + i * step.
std::optional<Line> straightLine(const std::vector<double>& value, const std::vector<double>& weight) {
  double w = 0.0, wi = 0.0, wv = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    w += weight[i];
    wi += weight[i] * static_cast<double>(i);
    wv += weight[i] * value[i];
  }
  if (!(w > 0.0)) return std::nullopt;
  const double mean_i = wi / w, mean_v = wv / w;
  double spread = 0.0, mixed = 0.0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double d = static_cast<double>(i) - mean_i;
    spread += weight[i] * d * d;
    mixed += weight[i] * d * (value[i] - mean_v);
  }
  if (!(spread > 0.0)) return std::nullopt;
  const double step = mixed / spread;
  return Line{mean_v - step * mean_i, step};
}

class GridFit {
 public:
  GridFit(int rows, int columns, const std::vector<Eigen::Vector3d>& points, const std::vector<bool>& valid)
      : rows_(rows), columns_(columns), points_(points), valid_(valid) {}

  // One tilt a row: the half plane through the x axis that its points lie in, by the principal axis of (y,
  // z).
  bool fitTilts() {
    tilt_.assign(static_cast<std::size_t>(rows_), 0.0);
    tilt_weight_.assign(static_cast<std::size_t>(rows_), 0.0);
    bool first = true;
    double before = 0.0;
    for (int row = 0; row < rows_; ++row) {
      double yy = 0.0, yz = 0.0, zz = 0.0, y = 0.0, z = 0.0;
      for (int column = 0; column < columns_; ++column) {
        const std::size_t cell = cellOf(row, column, columns_);
        if (!valid_[cell]) continue;
        const Eigen::Vector3d& p = points_[cell];
        yy += p.y() * p.y();
        yz += p.y() * p.z();
        zz += p.z() * p.z();
        y += p.y();
        z += p.z();
      }
      if (!(yy + zz > 1e-6)) continue;  // nothing, or only the poles, where every tilt is as good
      double e = 0.5 * std::atan2(2.0 * yz, yy - zz);
      // The axis has two ends. The first line looks to where most of it is, the others where their neighbour
      // looks.
      if (first && y * std::cos(e) + z * std::sin(e) < 0.0) e += kPi;
      if (!first) e = nearestTurn(e, before, kPi);
      const auto slot = static_cast<std::size_t>(row);
      tilt_[slot] = e;
      tilt_weight_[slot] = 1.0;
      before = e;
      first = false;
    }
    const auto line = straightLine(tilt_, tilt_weight_);
    if (!line || std::abs(line->step) < 1e-9) return false;
    nominal_tilt_ = *line;
    for (std::size_t row = 0; row < tilt_.size(); ++row)
      if (tilt_weight_[row] == 0.0) tilt_[row] = line->start + static_cast<double>(row) * line->step;
    return true;
  }

  // One azimuth a column: the direction of the sum of its points within their scan planes.
  bool fitAzimuths() {
    const auto count = static_cast<std::size_t>(columns_);
    std::vector<double> along(count, 0.0), across(count, 0.0);
    for (int row = 0; row < rows_; ++row) {
      const double c = std::cos(tilt_[static_cast<std::size_t>(row)]);
      const double s = std::sin(tilt_[static_cast<std::size_t>(row)]);
      for (int column = 0; column < columns_; ++column) {
        const std::size_t cell = cellOf(row, column, columns_);
        if (!valid_[cell]) continue;
        along[static_cast<std::size_t>(column)] += points_[cell].x();
        across[static_cast<std::size_t>(column)] += c * points_[cell].y() + s * points_[cell].z();
      }
    }
    std::vector<double> azimuth(count, 0.0), weight(count, 0.0);
    bool first = true;
    double before = 0.0;
    for (std::size_t column = 0; column < count; ++column) {
      const double length = std::hypot(along[column], across[column]);
      if (!(length > 0.0)) continue;
      azimuth[column] = std::atan2(across[column], along[column]);
      if (!first) azimuth[column] = nearestTurn(azimuth[column], before, 2.0 * kPi);
      before = azimuth[column];
      weight[column] = length;
      first = false;
    }
    const auto line = straightLine(azimuth, weight);
    if (!line || std::abs(line->step) < 1e-9) return false;
    azimuth_ = *line;
    return true;
  }

  std::optional<TiltedGrid> verified(double tolerance_m, bool round) const {
    TiltedGrid grid;
    grid.geometry.rows = rows_;
    grid.geometry.columns = columns_;
    grid.geometry.azimuth_start_rad = round ? rounded(azimuth_.start) : azimuth_.start;
    grid.geometry.azimuth_step_rad = round ? rounded(azimuth_.step) : azimuth_.step;
    grid.geometry.tilt_start_rad = nominal_tilt_.start;
    grid.geometry.tilt_step_rad = nominal_tilt_.step;
    if (grid.geometry.azimuth_step_rad == 0.0) return std::nullopt;
    grid.line_tilt_rad = tilt_;
    grid.range_m.assign(points_.size(), 0.0F);
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const std::size_t cell = cellOf(row, column, columns_);
        if (!valid_[cell]) continue;
        const double tilt = tilt_[static_cast<std::size_t>(row)];
        const double azimuth = grid.geometry.azimuthOfColumn(column);
        const Eigen::Vector3d beam(std::cos(azimuth), std::sin(azimuth) * std::cos(tilt),
                                   std::sin(azimuth) * std::sin(tilt));
        const auto range = static_cast<float>(beam.dot(points_[cell]));
        if (!(range > 0.0F)) return std::nullopt;
        if (!((static_cast<double>(range) * beam - points_[cell]).norm() <= tolerance_m)) return std::nullopt;
        grid.range_m[cell] = range;
      }
    }
    return grid;
  }

 private:
  // To a multiple of 0.01 deg where that is within 1e-4 deg: what a scanner is set to, without the print's
  // rounding.
  static double rounded(double angle_rad) {
    const double hundredths = angle_rad / kDegree * 100.0;
    const double whole = std::round(hundredths);
    return std::abs(hundredths - whole) < 0.01 ? whole / 100.0 * kDegree : angle_rad;
  }

  int rows_, columns_;
  const std::vector<Eigen::Vector3d>& points_;
  const std::vector<bool>& valid_;
  std::vector<double> tilt_, tilt_weight_;
  Line nominal_tilt_, azimuth_;
};

}  // namespace

std::optional<TiltedGrid> fitTiltedGrid(int rows, int columns, const std::vector<Eigen::Vector3d>& points,
                                        const std::vector<bool>& valid, double tolerance_m) {
  if (rows < 2 || columns < 2) return std::nullopt;
  GridFit fit(rows, columns, points, valid);
  if (!fit.fitTilts() || !fit.fitAzimuths()) return std::nullopt;
  if (auto grid = fit.verified(tolerance_m, true)) return grid;
  return fit.verified(tolerance_m, false);
}

std::optional<int> lineLength(const std::vector<Eigen::Vector3d>& points, const std::vector<bool>& valid) {
  // The angle to the x axis needs no tilt. Within a line it changes little from point to point; at a line's
  // end it jumps back by the whole field of view.
  std::vector<std::size_t> index;
  std::vector<double> angle;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!valid[i]) continue;
    index.push_back(i);
    angle.push_back(std::atan2(std::hypot(points[i].y(), points[i].z()), points[i].x()));
  }
  if (index.size() < 16) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(angle);
  const double jump = (high - low) / 3.0;
  if (jump < 0.01) return std::nullopt;
  std::size_t up = 0, down = 0;
  for (std::size_t k = 1; k < angle.size(); ++k) {
    if (angle[k] - angle[k - 1] > jump) ++up;
    if (angle[k - 1] - angle[k] > jump) ++down;
  }
  const double sign = down >= up ? 1.0 : -1.0;
  std::map<std::size_t, std::size_t> lengths;
  std::size_t before = 0;
  for (std::size_t k = 1; k < angle.size(); ++k) {
    if (sign * (angle[k - 1] - angle[k]) <= jump) continue;
    ++lengths[index[k] - before];
    before = index[k];
  }
  std::size_t length = 0, votes = 0;
  for (const auto& [candidate, count] : lengths)
    if (count > votes) length = candidate, votes = count;
  if (length < 8 || points.size() % length != 0 || points.size() / length < 2) return std::nullopt;
  return static_cast<int>(length);
}

}  // namespace tiltmap
