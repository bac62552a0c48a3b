#include "core/world/experiment.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/world/route.h"

namespace tiltmap {
namespace {

// FNV-1a over everything a stop holds.
std::uint64_t hashOf(const SimulatedStop& stop) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto eat = [&hash](const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ULL;
  };
  const RangeImageData& d = stop.scan.image->data();
  eat(d.range_m.data(), d.range_m.size() * sizeof(float));
  eat(d.code.data(), d.code.size() * sizeof(CellCode));
  eat(d.intensity.data(), d.intensity.size() * sizeof(float));
  eat(d.line_tilt_rad.data(), d.line_tilt_rad.size() * sizeof(double));
  eat(d.line_time_s.data(), d.line_time_s.size() * sizeof(double));
  for (const Pose& pose : {stop.truth, stop.scan.odometry}) {
    eat(pose.quaternion().coeffs().data(), 4 * sizeof(double));
    eat(pose.translation().data(), 3 * sizeof(double));
  }
  return hash;
}

void expectRow(const Pose& pose, const TableRow& row, const std::string& where) {
  const Eigen::Vector3d heading = Eigen::Vector3d(row.heading_x, row.heading_y, row.heading_z).normalized();
  EXPECT_NEAR((pose.translation() - Eigen::Vector3d(row.x_m, row.y_m, row.z_m)).norm(), 0.0, 1e-12) << where;
  EXPECT_NEAR((pose.heading() - heading).norm(), 0.0, 1e-9) << where;
}

TEST(Experiment, NamesGoBothWays) {
  for (const ExperimentId id : {ExperimentId::Exp1, ExperimentId::Exp2, ExperimentId::Exp2Fixed,
                                ExperimentId::Loop, ExperimentId::Survey})
    EXPECT_EQ(experimentNamed(nameOf(id)).value(), id);
  const auto unknown = experimentNamed("exp3");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().what.find("exp3"), std::string::npos);
  EXPECT_NE(unknown.error().remedy.find("survey"), std::string::npos);
}

TEST(Experiment, PosesAreTheThesisTables) {
  struct Case {
    ExperimentId id;
    std::vector<TableRow> measured, result;
  };
  for (const Case& c : {Case{ExperimentId::Exp1, experiment1Measured(), experiment1Result()},
                        Case{ExperimentId::Exp2, experiment2Measured(), experiment2Result()},
                        Case{ExperimentId::Exp2Fixed, experiment2Mended(), experiment2Result()}}) {
    const auto poses = experimentPoses(c.id, 3, 0).value();
    ASSERT_EQ(poses.size(), c.result.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::string where = std::string(nameOf(c.id)) + " stop " + std::to_string(i);
      expectRow(poses[i].odometry, c.measured[i], where);
      expectRow(poses[i].truth, c.result[i], where);
      EXPECT_NEAR((poses[i].odometry.rotation() * Eigen::Vector3d::UnitZ()).z(), 1.0, 1e-12)
          << where << ": not planar";
    }
    EXPECT_LT(difference(poses[0].truth, Pose()).rotation_rad, 1e-12);
    EXPECT_LT(difference(poses[0].odometry, Pose()).rotation_rad, 1e-12);
  }
}

// Spot checks of the constants against the printed tables, so that a slip in one place shows.
TEST(Experiment, TablesAreAsPrinted) {
  EXPECT_EQ(experiment1Measured().size(), 5U);
  EXPECT_EQ(experiment2Measured().size(), 14U);
  EXPECT_EQ(experiment1Result()[1].heading_x, -0.603065);  // printed without the sign
  EXPECT_EQ(experiment1Result()[4].z_m, -0.22);
  EXPECT_EQ(experiment2Measured()[1].y_m, 2.8);
  EXPECT_EQ(experiment2Measured()[13].heading_x, 1.0);
  EXPECT_EQ(experiment2Mended()[1].y_m, 1.4);
  EXPECT_EQ(experiment2Mended()[13].heading_y, 1.0);
  EXPECT_EQ(experiment2Mended()[13].heading_x, 0.0);
  EXPECT_EQ(experiment2Result()[9].heading_x, -0.0242);
  EXPECT_EQ(experiment2Result()[13].y_m, 19.25);
  double sum = 0.0;  // of all numbers of table 6.3
  for (const TableRow& r : experiment2Result())
    sum += r.x_m + r.y_m + r.z_m + r.heading_x + r.heading_y + r.heading_z;
  EXPECT_NEAR(sum, 275.0429, 1e-9);
}

TEST(Experiment, SameSeedSameBytesForAnyThreadCount) {
  const auto one = simulateExperiment(ExperimentId::Exp1, 7, 2, 1).value();
  const auto two = simulateExperiment(ExperimentId::Exp1, 7, 2, 2).value();
  const auto other = simulateExperiment(ExperimentId::Exp1, 8, 2, 2).value();
  const auto alone = Experiment::make(ExperimentId::Exp1, 7, 0).value().simulate(1, 2).value();
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(hashOf(one[i]), hashOf(two[i]));
    EXPECT_NE(hashOf(one[i]), hashOf(other[i]));
  }
  EXPECT_EQ(hashOf(one[1]), hashOf(alone));
  EXPECT_EQ(one[1].scan.name, "stop 1");
  EXPECT_EQ(one[1].scan.source, "simulated exp1 seed 7");
}

TEST(Experiment, RefusesWhatItCannotDrive) {
  EXPECT_FALSE(Experiment::make(ExperimentId::Exp1, 1, 6));
  EXPECT_FALSE(Experiment::make(ExperimentId::Survey, 1, -1));
  EXPECT_EQ(Experiment::make(ExperimentId::Exp2, 1, 3).value().stops(), 3);
  EXPECT_EQ(Experiment::make(ExperimentId::Loop, 1, 0).value().stops(), 40);
}

TEST(Experiment, StopsWhenAsked) {
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  job.report = [&](const Progress&) { source.request_stop(); };
  const auto result = simulateExperiment(ExperimentId::Exp2, 1, 0, 1, job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
