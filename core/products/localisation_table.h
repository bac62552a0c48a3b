// Where the robot stood: the thesis' tables 5.1, 5.2 and 6.1 to 6.3, one for each stage of the poses.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace tiltmap {

struct LocalisationRow {
  std::size_t stop = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d heading = Eigen::Vector3d::UnitY();  // unit vector, R * (0,1,0)
};

struct LocalisationTable {
  std::string stage;    // "odometry", "pairwise", "relaxed", "truth"
  std::string caption;  // one line for a reader
  std::vector<LocalisationRow> rows;
};

// The poses as they are given (world_from_scan, scan 0 being the world), one row a stop. A stage of another
// name gets a caption that just names it.
LocalisationTable localisationTable(const std::string& stage, const std::vector<Pose>& world_from_scan);
std::string localisationCaption(const std::string& stage);

// The caption, a header with units, and right-aligned columns: positions to the millimetre, headings to four
// places (0.006 deg). Ends with a newline.
std::string textOf(const LocalisationTable& table);
// stop,x_m,y_m,z_m,heading_x,heading_y,heading_z with six places, comma and point whatever the locale.
std::string csvOf(const LocalisationTable& table);

}  // namespace tiltmap
