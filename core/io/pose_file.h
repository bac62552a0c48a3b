// Poses as text files: TUM, CSV, KITTI, and 3DTK's .pose and .frames.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// world_from_scan by scan index, in the order of the indices.
using IndexedPoses = std::map<int, Pose>;

// TUM: lines `index x y z qx qy qz qw`, metres; blank lines and lines that begin with # are skipped. An index
// may be written as a real number (0.000000) but must be a whole one. Refuses, with file and line: another
// number of words, words that are no finite numbers, an index that is negative, not whole or there twice, a
// quaternion whose length is not 1 within 1 %. A file without any pose is refused, too.
Result<IndexedPoses> readPosesTum(const std::filesystem::path& path);
// The same of text in memory; `file` is what errors name.
Result<IndexedPoses> parsePosesTum(std::string_view text, const std::string& file);

// Writers replace the file only when the new one is complete. Numbers read back as the same doubles.
Status writePosesTum(const std::filesystem::path& path, const IndexedPoses& world_from_scan);
// The TUM columns under a header line, with the position first and the heading (thesis 5.1.6) after:
// index,x_m,y_m,z_m,qx,qy,qz,qw,heading_x,heading_y,heading_z
Status writePosesCsv(const std::filesystem::path& path, const IndexedPoses& world_from_scan);
// KITTI: the upper three rows of the 4 x 4 matrix a line, row-major. It has no index: a gap in them is
// refused.
Status writePosesKitti(const std::filesystem::path& path, const IndexedPoses& world_from_scan);

// Its text; the Error names the gap and `where`.
Result<std::string> posesKittiText(const IndexedPoses& world_from_scan, const std::string& where);

// The text TUM lines that writePosesTum writes, for standard output.
std::string posesTumText(const IndexedPoses& world_from_scan);
std::string posesCsvText(const IndexedPoses& world_from_scan);

// 3DTK's frame is left-handed: x right, y up, z forward, centimetres. Ours has (x, z, y) / 100 of it.
Eigen::Vector3d pointFrom3dtk(const Eigen::Vector3d& point_cm);
Eigen::Vector3d pointTo3dtk(const Eigen::Vector3d& point_m);
// Position and Euler angles about x, y, z, with R = Rx Ry Rz, all in 3DTK's frame; and back (angle y in
// [-90, 90] degrees; at its ends the angle about z is zero).
struct Pose3dtk {
  Eigen::Vector3d position_cm = Eigen::Vector3d::Zero();
  Eigen::Vector3d angles_deg = Eigen::Vector3d::Zero();
};
Pose poseFrom3dtk(const Pose3dtk& pose);
Pose3dtk poseTo3dtk(const Pose& pose);
// A .pose file: six finite numbers and nothing else.
Result<Pose> readPose3dtk(const std::filesystem::path& path);
Result<Pose> parsePose3dtk(std::string_view text, const std::string& file);
Status writePose3dtk(const std::filesystem::path& path, const Pose& world_from_scan);
// A .frames file: the pose as a column-major 4 x 4 matrix in 3DTK's frame and a number for its colour (2:
// final).
Status writeFrames3dtk(const std::filesystem::path& path, const Pose& world_from_scan);

enum class Poses3dtk { PoseFiles, FramesFiles };
// One a scan, scan000.pose or scan000.frames and so on, into the folder, which is made where it is missing.
// Returns the files' paths.
Result<std::vector<std::string>> writePoses3dtk(const std::filesystem::path& folder, Poses3dtk kind,
                                                const IndexedPoses& world_from_scan);

}  // namespace tiltmap
