#include "core/multiview/stop_verdict.h"

#include <gtest/gtest.h>

#include "tests/support/room_scene.h"
#include "tests/support/stop_scenes.h"

namespace tiltmap {
namespace {

using namespace test_support;

// Two stops of the first experiment stand in the map, the third comes.
class StopVerdictTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    experiment_ = new Experiment(Experiment::make(ExperimentId::Exp1, 3, 3).value());
    stops_ = new std::vector<SimulatedStop>(experiment_->simulateAll(0).value());
    auto map = std::make_shared<StopMap>();
    for (std::size_t i = 0; i < 2; ++i) map->add((*stops_)[i].scan, (*stops_)[i].truth);
    map_ = new std::shared_ptr<const StopMap>(map);
  }
  static void TearDownTestSuite() {
    delete map_;
    delete stops_;
    delete experiment_;
  }

  const StopMap& map() const { return **map_; }
  const SimulatedStop& coming() const { return stops_->back(); }
  // How the odometry would put the new stop behind the truth of the previous one.
  Pose odometry() const {
    return (*stops_)[1].truth * (*stops_)[1].scan.odometry.inverse() * coming().scan.odometry;
  }
  PoseDifference error(const Pose& world_from_scan) const {
    return difference(coming().truth, world_from_scan);
  }

  static Experiment* experiment_;
  static std::vector<SimulatedStop>* stops_;
  static std::shared_ptr<const StopMap>* map_;
};
Experiment* StopVerdictTest::experiment_ = nullptr;
std::vector<SimulatedStop>* StopVerdictTest::stops_ = nullptr;
std::shared_ptr<const StopMap>* StopVerdictTest::map_ = nullptr;

TEST_F(StopVerdictTest, AGoodStopMovesOnAndStandsInItsPlace) {
  const StopVerdict verdict = stopVerdict(map(), coming().scan, odometry());
  EXPECT_EQ(verdict.light, StopLight::MoveOn) << verdict.reason;
  EXPECT_TRUE(verdict.placed);
  EXPECT_LT(error(verdict.world_from_scan).translation_m, 0.02);
  EXPECT_LT(error(verdict.world_from_scan).rotation_rad, 0.2 * kDegree);
  ASSERT_TRUE(verdict.best);
  EXPECT_EQ(verdict.links.front().stop, 1U) << "the previous stop first";
  EXPECT_GT(verdict.overlap, 0.2);
  EXPECT_FALSE(verdict.weak_directions.empty());
  EXPECT_FALSE(verdict.reason.empty());
}

TEST_F(StopVerdictTest, TheFirstStopIsJudgedByItsHealthAlone) {
  const StopMap none;
  EXPECT_EQ(stopVerdict(none, coming().scan, Pose()).light, StopLight::MoveOn);
  const StopVerdict dirty = stopVerdict(none, dirtyWindow(coming().scan, 100, 160, 1), Pose());
  EXPECT_EQ(dirty.light, StopLight::Rescan);
  EXPECT_NE(dirty.reason.find("Clean"), std::string::npos) << dirty.reason;
  EXPECT_FALSE(dirty.placed);
}

TEST_F(StopVerdictTest, ADirtyWindowIsScannedAgainThoughTheRestFits) {
  const StopVerdict verdict = stopVerdict(map(), dirtyWindow(coming().scan, 40, 100, 2), odometry());
  EXPECT_EQ(verdict.light, StopLight::Rescan);
  EXPECT_FALSE(verdict.health.good);
}

TEST_F(StopVerdictTest, ABlockedViewIsScannedAgain) {
  const StopVerdict verdict = stopVerdict(map(), blockedStop(*experiment_, 2, 5), odometry());
  EXPECT_EQ(verdict.light, StopLight::Rescan) << verdict.reason;
}

TEST_F(StopVerdictTest, AScanOfAnotherPlaceComesCloser) {
  const Experiment elsewhere = Experiment::make(ExperimentId::Survey, 7, 1).value();
  const StopVerdict verdict = stopVerdict(map(), elsewhere.simulate(0, 0)->scan, odometry());
  EXPECT_EQ(verdict.light, StopLight::Closer) << verdict.reason;
  EXPECT_FALSE(verdict.placed);
  EXPECT_EQ(verdict.world_from_scan, odometry()) << "no pose is made up";
}

TEST_F(StopVerdictTest, AWrongOdometryIsSurvivedOrTold) {
  for (const Pose& slip : {Pose::planar(1.5, -1.0, 0.1), Pose::planar(0, 0, 90 * kDegree),
                           Pose::planar(6.0, 5.0, -120 * kDegree)}) {
    const StopVerdict verdict = stopVerdict(map(), coming().scan, odometry() * slip);
    if (verdict.light != StopLight::MoveOn) continue;
    EXPECT_LT(error(verdict.world_from_scan).translation_m, 0.02) << verdict.reason;
    EXPECT_NE(verdict.reason.find("odometry was"), std::string::npos) << verdict.reason;
  }
}

TEST_F(StopVerdictTest, RefusesWhatIsNoScan) {
  EXPECT_THROW(stopVerdict(map(), Scan{}, Pose()), std::invalid_argument);
  EXPECT_THROW(
      stopVerdict(map(), coming().scan, Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(NAN, 0, 0))),
      std::invalid_argument);
  EXPECT_THROW(SweepRegistration(nullptr, Pose()), std::invalid_argument);
}

TEST_F(StopVerdictTest, TheSweepSlidesIntoPlace) {
  SweepRegistration sweep(*map_, odometry());
  const PoseDifference start = error(odometry());
  double last_overlap = -1.0;
  int first_sure = 0;
  for (int lines = 4; lines <= 101; lines += 4) {
    const SweepEstimate& estimate = sweep.update(firstLines(coming().scan, std::min(lines, 101)));
    EXPECT_EQ(estimate.lines, lines);
    EXPECT_FALSE(estimate.sentence.empty());
    // Never worse than the odometry by more than a hand's breadth, sure or not.
    EXPECT_LE(error(estimate.world_from_scan).translation_m, start.translation_m + 0.05) << lines;
    EXPECT_LE(error(estimate.world_from_scan).rotation_rad, start.rotation_rad + 0.5 * kDegree) << lines;
    if (estimate.sure && first_sure == 0) first_sure = lines;
    if (estimate.sure) {
      EXPECT_LT(error(estimate.world_from_scan).translation_m, 0.10) << lines << ": " << estimate.sentence;
      EXPECT_LT(error(estimate.world_from_scan).rotation_rad, 1.0 * kDegree) << lines;
      last_overlap = estimate.overlap;
    }
  }
  EXPECT_GT(first_sure, 0);
  EXPECT_LT(first_sure, 101) << "long before the last line";
  EXPECT_GT(last_overlap, 0.2);
  EXPECT_FALSE(sweep.estimate().from_odometry);
  const StopVerdict verdict = stopVerdict(map(), coming().scan, odometry(), &sweep.estimate());
  EXPECT_EQ(verdict.light, StopLight::MoveOn) << verdict.reason;
  EXPECT_LT(error(verdict.world_from_scan).translation_m, 0.02);
}

TEST_F(StopVerdictTest, FewLinesAreNotYet) {
  SweepRegistration sweep(*map_, odometry());
  for (const int lines : {0, 1, 5}) {
    const SweepEstimate& estimate = sweep.update(firstLines(coming().scan, lines));
    EXPECT_FALSE(estimate.sure);
    EXPECT_TRUE(estimate.from_odometry);
    EXPECT_EQ(estimate.world_from_scan, odometry());
    EXPECT_NE(estimate.sentence.find("not yet"), std::string::npos) << estimate.sentence;
  }
  SweepRegistration first(std::make_shared<StopMap>(), Pose());
  EXPECT_FALSE(first.update(coming().scan).sure) << "nothing to register to";
}

TEST_F(StopVerdictTest, ASweepOfAnotherPlaceKeepsItsOdometry) {
  const Experiment elsewhere = Experiment::make(ExperimentId::Survey, 7, 1).value();
  const Scan scan = elsewhere.simulate(0, 0)->scan;
  SweepRegistration sweep(*map_, odometry());
  for (int lines = 20; lines <= 101; lines += 27) {
    EXPECT_FALSE(sweep.update(firstLines(scan, lines)).sure) << lines;
    EXPECT_EQ(sweep.estimate().world_from_scan, odometry()) << lines;
  }
}

TEST(StopMap, NamesTheNearestStopsAndAlwaysTheLast) {
  StopMap map;
  for (const double y : {0.0, 10.0, 20.0, 60.0}) map.add(almostEmptyScan(0), Pose::planar(0, y, 0));
  EXPECT_EQ(map.neighbours({0, 9, 0}, 2, 40), (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(map.neighbours({0, 9, 0}, 9, 15), (std::vector<std::size_t>{1, 0, 2, 3}));
  EXPECT_TRUE(StopMap().neighbours({0, 0, 0}, 3, 40).empty());
  map.setPose(3, Pose::planar(0, 9, 0));
  EXPECT_EQ(map.neighbours({0, 9, 0}, 1, 40), (std::vector<std::size_t>{3}));
  EXPECT_THROW(map.setPose(4, Pose()), std::out_of_range);
}

}  // namespace
}  // namespace tiltmap
