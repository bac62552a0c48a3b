// Sweeps as they go wrong in the field: part of one, a dirty window, a view that is blocked.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/world/experiment.h"

namespace tiltmap::test_support {

inline Scan withData(const Scan& scan, RangeImageData data) {
  Scan changed = scan;
  changed.image = RangeImage::make(std::move(data)).value();
  return changed;
}

// The first lines of a sweep, the others not taken yet.
inline Scan firstLines(const Scan& scan, int lines) {
  RangeImageData data = scan.image->data();
  for (std::size_t cell = static_cast<std::size_t>(lines) * static_cast<std::size_t>(data.columns);
       cell < data.cells(); ++cell) {
    data.range_m[cell] = 0.0F;
    data.code[cell] = cell_code::kNotScanned;
  }
  return withData(scan, std::move(data));
}

// A sector of the beams, columns [first, last), that ends right behind the window in every line.
inline Scan dirtyWindow(const Scan& scan, int first, int last, std::uint64_t seed) {
  RangeImageData data = scan.image->data();
  RandomStream random = RandomStream::keyed({seed, 0xd1273ULL});
  for (int row = 0; row < data.rows; ++row)
    for (int column = first; column < last; ++column) {
      const std::size_t cell = scan.image->index(row, column);
      data.range_m[cell] = static_cast<float>(random.uniform(0.04, 0.25));
      data.code[cell] = cell_code::kMeasured;
    }
  return withData(scan, std::move(data));
}

// The same sector without any answer.
inline Scan coveredWindow(const Scan& scan, int first, int last, CellCode code) {
  RangeImageData data = scan.image->data();
  for (int row = 0; row < data.rows; ++row)
    for (int column = first; column < last; ++column) {
      const std::size_t cell = scan.image->index(row, column);
      data.range_m[cell] = 0.0F;
      data.code[cell] = code;
    }
  return withData(scan, std::move(data));
}

// The stop of an experiment scanned with a wall of crates and boards around the machine's front, 1.1 to 1.9 m
// away, higher than it looks up, with gaps.
inline Scan blockedStop(const Experiment& experiment, int stop, std::uint64_t seed) {
  const std::shared_ptr<const Site> free = experiment.siteAt(stop);
  const Pose site_from_scan = experiment.siteFromScan(stop);
  std::vector<Shape> shapes = free->shapes();
  RandomStream random = RandomStream::keyed({seed, static_cast<std::uint64_t>(stop), 0xb10cULL});
  for (double way = -10.0; way < 190.0; way += 20.0) {
    if (random.uniform() < 0.1) continue;  // a gap
    const double distance = random.uniform(1.1, 1.9), angle = (way + random.uniform(-3.0, 3.0)) * kDegree;
    const Eigen::Vector3d place =
        site_from_scan * Eigen::Vector3d(distance * std::cos(angle), distance * std::sin(angle), 0.0);
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d out =
        site_from_scan.rotation() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    frame.linear() =
        Eigen::AngleAxisd(std::atan2(out.y(), out.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    frame.translation() = place;
    shapes.emplace_back(Hull::box(frame, {0.0, -0.35 * distance, -1.2},
                                  {random.uniform(0.1, 0.6), 0.35 * distance, random.uniform(0.8, 1.6)},
                                  0.4));
  }
  const Site site(free->ground(), std::move(shapes));
  const SimulationSettings settings;
  Scan scan;
  RangeImageData data;
  data.rows = scan.geometry.rows;
  data.columns = scan.geometry.columns;
  data.range_m.resize(data.cells());
  data.code.resize(data.cells());
  for (int row = 0; row < data.rows; ++row) {
    const double tilt = scan.geometry.tiltOfRow(row);
    data.line_tilt_rad.push_back(tilt);
    const std::vector<Echo> echoes = castLine(
        site, site_from_scan, scan.geometry, [tilt](double) { return tilt; }, 0.0,
        RandomStream::keyed({seed, static_cast<std::uint64_t>(stop), static_cast<std::uint64_t>(row)}),
        settings.beam);
    for (int column = 0; column < data.columns; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row * data.columns + column);
      data.range_m[cell] = echoes[static_cast<std::size_t>(column)].range_m;
      data.code[cell] = echoes[static_cast<std::size_t>(column)].code;
    }
  }
  scan.image = RangeImage::make(std::move(data)).value();
  scan.odometry = experiment.poses()[static_cast<std::size_t>(stop)].odometry;
  return scan;
}

}  // namespace tiltmap::test_support
