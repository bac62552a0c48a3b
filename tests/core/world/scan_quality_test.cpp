// What whole scans of the experiments look like: enough cells, overlap, and points that fit together under
// the truth.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/scan/reduction.h"
#include "core/world/experiment.h"

namespace tiltmap {
namespace {

void expectEnoughCells(const SimulatedStop& stop) {
  EXPECT_GE(stop.scan.image->validCells(), 20000U) << stop.scan.source << " " << stop.scan.name;
  EXPECT_LE(stop.scan.image->validCells(), 31000U) << stop.scan.source << " " << stop.scan.name;
}

// The thesis' experiments: 8,000 to 9,500 points a scan were left at half a metre.
void expectThesisScans(ExperimentId id) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto stops = simulateExperiment(id, seed, 0, 2).value();
    for (const SimulatedStop& stop : stops) {
      expectEnoughCells(stop);
      const Scan& scan = stop.scan;
      const auto kept = reducedAlongLines(*scan.image, cellPoints(*scan.image, scan.geometry), {}, 0.5);
      EXPECT_GE(kept.size(), 8000U) << scan.source << " " << scan.name;
      EXPECT_LE(kept.size(), 9500U) << scan.source << " " << scan.name;
    }
  }
}

TEST(ScanQuality, PointsOfExp1) {
  expectThesisScans(ExperimentId::Exp1);
}
TEST(ScanQuality, PointsOfExp2Fixed) {
  expectThesisScans(ExperimentId::Exp2Fixed);
}
TEST(ScanQuality, ValidCellsLoop) {
  const auto stops = simulateExperiment(ExperimentId::Loop, 1, 0, 2).value();
  for (const SimulatedStop& stop : stops) expectEnoughCells(stop);
}
TEST(ScanQuality, ValidCellsSurvey) {
  const auto drive = Experiment::make(ExperimentId::Survey, 1, 100).value();
  for (int stop = 0; stop < drive.stops(); stop += 6) expectEnoughCells(drive.simulate(stop, 2).value());
}

// Where points of one scan fall on smooth parts of the other's matrix, how far are they from its plane there,
// and what share of them is there at all? A plane through three neighbouring cells serves; edges are left
// out.
struct Fit {
  double median_m = 0.0;
  double overlap = 0.0;  // share of the moving scan's points with a fixed surface within 0.5 m
};

Fit fitOf(const Scan& fixed, const Scan& moving, const Pose& fixed_from_moving) {
  const auto model = cellPoints(*fixed.image, fixed.geometry);
  const auto data = cellPoints(*moving.image, moving.geometry);
  std::vector<double> distances;
  int total = 0, near = 0;
  for (std::size_t cell = 0; cell < data.size(); cell += 3) {
    if (!moving.image->hasPoint(cell)) continue;
    ++total;
    const Eigen::Vector3d p = fixed_from_moving * data[cell];
    const auto place = fixed.geometry.place(p);
    if (!place) continue;
    const int row = static_cast<int>(std::floor(place->row)),
              column = static_cast<int>(std::floor(place->column));
    if (row < 0 || column < 20 || row + 2 >= fixed.image->rows() || column + 22 >= fixed.image->columns())
      continue;
    const RangeImage& image = *fixed.image;
    if (!image.hasPoint(row, column) || !image.hasPoint(row, column + 2) || !image.hasPoint(row + 2, column))
      continue;
    const Eigen::Vector3d a = model[image.index(row, column)], b = model[image.index(row, column + 2)],
                          c = model[image.index(row + 2, column)];
    if ((a - p).norm() > 0.5) continue;
    ++near;
    if ((b - a).norm() > 0.4 || (c - a).norm() > 0.4) continue;
    // Smooth: the fourth corner lies in the plane of the three (not so in foliage and across edges).
    if (!image.hasPoint(row + 2, column + 2)) continue;
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    if (std::abs(normal.dot(model[image.index(row + 2, column + 2)] - a)) > 0.05) continue;
    distances.push_back(std::abs(normal.dot(p - a)));
  }
  if (distances.empty()) return {};
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                   distances.end());
  return {distances[distances.size() / 2], static_cast<double>(near) / total};
}

TEST(ScanQuality, PointsOfNeighbouringStopsMeetUnderTheTruthOnly) {
  for (const ExperimentId id :
       {ExperimentId::Exp1, ExperimentId::Exp2Fixed, ExperimentId::Loop, ExperimentId::Survey}) {
    const auto drive =
        Experiment::make(id, 2, id == ExperimentId::Exp1 || id == ExperimentId::Exp2Fixed ? 0 : 12).value();
    const int last = id == ExperimentId::Exp1 ? 4 : 9;
    for (const int first : {0, 2, last - 1}) {
      const auto fixed = drive.simulate(first, 2).value(), moving = drive.simulate(first + 1, 2).value();
      const Pose truth = fixed.truth.inverse() * moving.truth;
      const Fit fit = fitOf(fixed.scan, moving.scan, truth);
      const std::string where = std::string(nameOf(id)) + " " + std::to_string(first);
      EXPECT_LT(fit.median_m, 0.022) << where;
      EXPECT_GT(fit.median_m, 0.002) << where << ": no noise?";
      RecordProperty("median_mm_" + where, std::to_string(1e3 * fit.median_m));
      Vector6d off;
      off << 0.0, 0.02, 0.0, 0.04, 0.04, 0.08;
      EXPECT_GT(fitOf(fixed.scan, moving.scan, truth.moved(off)).median_m, 2.0 * fit.median_m) << where;
    }
  }
}

TEST(ScanQuality, NeighboursOverlap) {
  const auto scans = simulateExperiment(ExperimentId::Exp2Fixed, 1, 0, 2).value();
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const Pose truth = scans[i].truth.inverse() * scans[i + 1].truth;
    const double overlap = fitOf(scans[i].scan, scans[i + 1].scan, truth).overlap;
    EXPECT_GT(overlap, i == 9 ? 0.2 : 0.35) << "stops " << i << " and " << i + 1;
  }
}

TEST(ScanQuality, ScanSaysWhatItIs) {
  const auto drive = Experiment::make(ExperimentId::Exp2Fixed, 1).value();
  const auto stop = drive.simulate(3, 2).value();
  EXPECT_EQ(stop.scan.name, "stop 3");
  EXPECT_EQ(stop.scan.source, "simulated exp2fixed seed 1");
  const RangeImage& image = *stop.scan.image;
  ASSERT_TRUE(image.hasTimes());
  ASSERT_TRUE(image.hasIntensity());
  for (int row = 0; row < image.rows(); ++row) {
    EXPECT_DOUBLE_EQ(image.lineTilt(row), stop.scan.geometry.tiltOfRow(row));
    if (row > 0) {
      EXPECT_NEAR(image.lineTime(row) - image.lineTime(row - 1), 0.32, 1e-6);
    }
  }
  EXPECT_GT(drive.simulate(4, 2).value().scan.image->lineTime(0), image.lineTime(100));
}

TEST(ScanQuality, PlantedTiltErrorBendsTheScan) {
  const auto drive = Experiment::make(ExperimentId::Exp1, 1).value();
  SimulationSettings wrong;
  wrong.true_geometry.emplace();
  wrong.true_geometry->tilt_zero_rad = 0.5 * kDegree;
  const auto right_stop = drive.simulate(0, 2).value(), wrong_stop = drive.simulate(0, 2, {}, wrong).value();
  EXPECT_EQ(wrong_stop.scan.geometry.tilt_zero_rad, 0.0);
  // With the true geometry the points are back where they belong.
  Scan mended = wrong_stop.scan;
  mended.geometry = *wrong.true_geometry;
  const double bent = fitOf(right_stop.scan, wrong_stop.scan, Pose()).median_m;
  const double straight = fitOf(right_stop.scan, mended, Pose()).median_m;
  EXPECT_LT(straight, 0.012);
  EXPECT_GT(bent, 1.5 * straight);

  wrong.true_geometry->rows = 50;
  EXPECT_FALSE(drive.simulate(0, 2, {}, wrong));
}

TEST(ScanQuality, ContinuousTiltMovesTheOddBeams) {
  const auto drive = Experiment::make(ExperimentId::Exp1, 1).value();
  SimulationSettings moving;
  moving.continuous_tilt = true;
  moving.line_period_s = 0.03;
  moving.beam.noise_m = 0.0;
  SimulationSettings still = moving;
  still.continuous_tilt = false;
  const auto a = drive.simulate(0, 2, {}, moving).value(), b = drive.simulate(0, 2, {}, still).value();
  int differing = 0;
  const RangeImage &ia = *a.scan.image, &ib = *b.scan.image;
  for (std::size_t cell = 0; cell < ia.cells(); ++cell)
    if (ia.hasPoint(cell) && ib.hasPoint(cell) && std::abs(ia.range(cell) - ib.range(cell)) > 0.005F)
      ++differing;
  EXPECT_GT(differing, 5000);
}

}  // namespace
}  // namespace tiltmap
