#include "core/multiview/overlap_candidates.h"

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

// Points on a line of 20 m along x from the scan, one a metre.
PreparedScanPtr lineScan() {
  auto scan = std::make_shared<PreparedScan>();
  for (int i = 0; i < 20; ++i) {
    scan->elements.position.emplace_back(i + 0.5, 0.5, 0.5);
    scan->elements.normal.emplace_back(0.0, 0.0, 1.0);
  }
  return scan;
}

std::vector<Pose> along(const std::vector<double>& x_m) {
  std::vector<Pose> poses;
  for (const double x : x_m) poses.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, 0.0, 0.0));
  return poses;
}

TEST(OverlapCandidates, ScansThatShareSpaceAndOnlyThose) {
  const std::vector<PreparedScanPtr> scans(4, lineScan());
  RelaxationSettings settings;
  settings.cell_m = 1.0;
  settings.min_shared_cells = 0.3;
  // 0 and 3 share 15 of 20 cells; 1 stands alone; 2 shares 2 of 20 with 0, but is not its neighbour in time.
  const Pairs pairs = overlapCandidates(scans, along({0.0, 500.0, 18.0, 5.0}), settings, 2);
  EXPECT_EQ(pairs, (Pairs{{0, 3}, {2, 3}}));
}

TEST(OverlapCandidates, NeighboursInTimeNeedOneCellOnly) {
  const std::vector<PreparedScanPtr> scans(3, lineScan());
  RelaxationSettings settings;
  settings.cell_m = 1.0;
  settings.min_shared_cells = 0.9;
  EXPECT_EQ(overlapCandidates(scans, along({0.0, 19.0, 60.0}), settings, 1), (Pairs{{0, 1}}));
}

TEST(OverlapCandidates, EachScanKeepsItsBest) {
  const std::vector<PreparedScanPtr> scans(5, lineScan());
  RelaxationSettings settings;
  settings.cell_m = 1.0;
  settings.min_shared_cells = 0.0;
  settings.max_links_per_scan = 1;
  // The neighbours in time, and 0 with 4, which stands closest to it.
  const Pairs pairs = overlapCandidates(scans, along({0.0, 8.0, 16.0, 24.0, 1.0}), settings, 1);
  EXPECT_EQ(pairs, (Pairs{{0, 1}, {0, 4}, {1, 2}, {1, 4}, {2, 3}}));
}

TEST(OverlapCandidates, EmptyScansAndNoScans) {
  const RelaxationSettings settings;
  EXPECT_TRUE(overlapCandidates({}, {}, settings, 2).empty());
  const std::vector<PreparedScanPtr> scans{lineScan(), std::make_shared<PreparedScan>(), lineScan()};
  EXPECT_EQ(overlapCandidates(scans, along({0.0, 0.0, 0.0}), settings, 2), (Pairs{{0, 2}}));
}

TEST(OverlapCandidates, TheSameForAnyNumberOfThreads) {
  const std::vector<PreparedScanPtr> scans(60, lineScan());
  std::vector<double> x;
  for (int i = 0; i < 60; ++i) x.push_back(3.7 * (i % 17) + 0.1 * i);
  RelaxationSettings settings;
  settings.max_links_per_scan = 4;
  const Pairs one = overlapCandidates(scans, along(x), settings, 1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, overlapCandidates(scans, along(x), settings, 4));
}

}  // namespace
}  // namespace tiltmap
