#include "core/scan/scan_health.h"

#include <gtest/gtest.h>

#include "tests/support/room_scene.h"
#include "tests/support/stop_scenes.h"

namespace tiltmap {
namespace {

using namespace test_support;

const Scan& room() {
  static const Scan scan = sceneScan(roomScene(), Pose(), 0.012);
  return scan;
}
ScanHealth healthOf(const Scan& scan, bool whole = true) {
  return scanHealth(*scan.image, scan.geometry, whole);
}

TEST(ScanHealth, AFreeViewIsGood) {
  const ScanHealth health = healthOf(room());
  EXPECT_TRUE(health.good) << health.reason;
  EXPECT_EQ(health.sectors.size(), 18U);
  EXPECT_EQ(health.lines, 101);
  EXPECT_EQ(health.shares.dead, 0.0);
  EXPECT_LT(health.hidden, 0.2);
}

TEST(ScanHealth, ADirtyWindowIsNamedByItsSector) {
  const ScanHealth health = healthOf(dirtyWindow(room(), 120, 181, 3));
  EXPECT_FALSE(health.good);
  EXPECT_NE(health.reason.find("60° to 90°"), std::string::npos) << health.reason;
  EXPECT_NE(health.reason.find("Clean"), std::string::npos) << health.reason;
  EXPECT_TRUE(health.sectors[7].bad);
  EXPECT_FALSE(health.sectors[2].bad);
  EXPECT_NEAR(health.shares.too_short, 61.0 / 361.0, 0.01);
}

TEST(ScanHealth, DazzleIsTold) {
  const ScanHealth health = healthOf(coveredWindow(room(), 0, 60, cell_code::kLmsDazzled));
  EXPECT_FALSE(health.good);
  EXPECT_NE(health.reason.find("dazzled"), std::string::npos) << health.reason;
}

TEST(ScanHealth, AWindowThatSwallowsTheGroundIsToldFromAnOpenSky) {
  // Nothing comes back from the upper lines: an open field. Nothing from the lower ones: a covered window.
  EXPECT_FALSE(healthOf(coveredWindow(room(), 200, 260, cell_code::kLmsNoSignal)).good);
  const Scan field = sceneScan(groundScene(), Pose(), 0.012);
  EXPECT_TRUE(healthOf(field).good) << healthOf(field).reason;
}

TEST(ScanHealth, ThingsCloseAroundHideTheView) {
  const std::vector<ScenePlane> box = {
      {{0, 0, 1}, -1.0}, {{1, 0, 0}, 1.2}, {{-1, 0, 0}, 1.2}, {{0, 1, 0}, 1.5}};
  const ScanHealth health = healthOf(sceneScan(box, Pose(), 0.012));
  EXPECT_FALSE(health.good);
  EXPECT_GT(health.hidden, 0.8);
  EXPECT_NE(health.reason.find("hide"), std::string::npos) << health.reason;
}

TEST(ScanHealth, LinesNotTakenYetAreNoFaultOfAPart) {
  const Scan part = firstLines(room(), 30);
  EXPECT_TRUE(healthOf(part, false).good) << healthOf(part, false).reason;
  EXPECT_EQ(healthOf(part, false).lines, 30);
  EXPECT_FALSE(healthOf(part, true).good);
  EXPECT_FALSE(healthOf(firstLines(room(), 0), false).good);
}

TEST(ScanHealth, MaskedCellsCountNowhere) {
  const ScanHealth health = healthOf(coveredWindow(room(), 0, 40, cell_code::kMasked));
  EXPECT_TRUE(health.good) << health.reason;
  EXPECT_EQ(health.shares.dead, 0.0);
}

}  // namespace
}  // namespace tiltmap
