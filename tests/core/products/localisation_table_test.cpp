#include "core/products/localisation_table.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

std::vector<Pose> threeStops() {
  return {Pose(), Pose::planar(1.4, 2.8, -45 * kDegree),
          Pose::fromHeading({-12.3456, 4, -0.0001}, {1, 0, 0})};
}

TEST(LocalisationTable, PrintsPositionsAndHeadingsInAlignedColumns) {
  EXPECT_EQ(textOf(localisationTable("odometry", threeStops())),
            "Stops as the odometry measured them\n"
            "stop    x [m]  y [m]  z [m]  heading x  heading y  heading z\n"
            "   0    0.000  0.000  0.000     0.0000     1.0000     0.0000\n"
            "   1    1.400  2.800  0.000     0.7071     0.7071     0.0000\n"
            "   2  -12.346  4.000  0.000     1.0000     0.0000     0.0000\n");
}

TEST(LocalisationTable, WritesCsvThatSpreadsheetsTake) {
  EXPECT_EQ(csvOf(localisationTable("pairwise", threeStops())),
            "stop,x_m,y_m,z_m,heading_x,heading_y,heading_z\n"
            "0,0.000000,0.000000,0.000000,0.000000,1.000000,0.000000\n"
            "1,1.400000,2.800000,0.000000,0.707107,0.707107,0.000000\n"
            "2,-12.345600,4.000000,-0.000100,1.000000,0.000000,0.000000\n");
}

TEST(LocalisationTable, HeadsEachStageWithItsOwnCaption) {
  EXPECT_EQ(localisationTable("odometry", {}).caption, "Stops as the odometry measured them");
  EXPECT_EQ(localisationTable("pairwise", {}).caption, "Stops after pairwise registration");
  EXPECT_EQ(localisationTable("relaxed", {}).caption, "Stops after global relaxation");
  EXPECT_EQ(localisationTable("truth", {}).caption, "Stops as they truly are");
  EXPECT_EQ(localisationTable("by-hand", {}).caption, "Stops at stage by-hand");
}

TEST(LocalisationTable, HoldsTheHeadingVectorOfAPitchedStop) {
  // 30 degrees nose up, looking along -x.
  const Pose pose = Pose::fromHeading({1, 2, 3}, {-std::cos(30 * kDegree), 0, std::sin(30 * kDegree)});
  const LocalisationTable table = localisationTable("truth", {pose});
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_TRUE(table.rows[0].heading.isApprox(Eigen::Vector3d(-0.8660254038, 0, 0.5), 1e-9));
  EXPECT_TRUE(table.rows[0].position_m.isApprox(Eigen::Vector3d(1, 2, 3)));
}

TEST(LocalisationTable, OfNoStopsIsItsHeader) {
  EXPECT_EQ(csvOf(localisationTable("truth", {})), "stop,x_m,y_m,z_m,heading_x,heading_y,heading_z\n");
  EXPECT_EQ(textOf(localisationTable("truth", {})),
            "Stops as they truly are\nstop  x [m]  y [m]  z [m]  heading x  heading y  heading z\n");
}

}  // namespace
}  // namespace tiltmap
