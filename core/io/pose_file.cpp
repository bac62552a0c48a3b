#include "core/io/pose_file.h"

#include <array>
#include <cmath>

#include "core/base/atomic_file.h"
#include "core/base/text.h"
#include "core/io/file_bytes.h"
#include "core/io/pose_track.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

tl::unexpected<Error> refuseLine(const std::string& path, std::size_t line, std::string what,
                                 std::string remedy = "correct the line: index x y z qx qy qz qw") {
  return fail(std::move(what), path + ":" + std::to_string(line), std::move(remedy));
}

// `index` as a whole number, also where it is written as 3.000000.
std::optional<int> wholeIndex(std::string_view word) {
  const auto value = parseReal(word);
  if (!value || !(*value >= 0.0) || *value > 1e9 || std::floor(*value) != *value) return std::nullopt;
  return static_cast<int>(*value);
}

std::string numbers(std::initializer_list<double> values, char separator) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += separator;
    text += shortestReal(value);
  }
  return text;
}

void checkFinite(const Pose& pose) {
  if (!pose.isFinite()) throw std::invalid_argument("a pose to be written is not finite");
}

// 3DTK's x y z are our x z y: its own inverse, and a reflection.
Eigen::Matrix3d swapped() {
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  s(0, 0) = s(1, 2) = s(2, 1) = 1.0;
  return s;
}

}  // namespace

Result<IndexedPoses> readPosesTum(const std::filesystem::path& path) {
  const auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  return parsePosesTum(*bytes, path.string());
}

Result<IndexedPoses> parsePosesTum(std::string_view bytes, const std::string& path) {
  IndexedPoses poses;
  TextCursor cursor(bytes);
  std::string_view line;
  while (cursor.nextLine(line)) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const auto words = splitWords(text);
    const std::size_t number = cursor.lineNumber();
    if (words.size() != 8)
      return refuseLine(path, number,
                        "a pose needs 8 numbers, and there are " + std::to_string(words.size()));
    const auto index = wholeIndex(words[0]);
    if (!index) return refuseLine(path, number, printable(words[0]) + " is not the index of a scan");
    const auto pose = parsePoseWords(std::span(words).subspan(1), "");
    if (!pose) return refuseLine(path, number, pose.error().what);
    if (!poses.emplace(*index, *pose).second)
      return refuseLine(path, number, "there is a second pose of scan " + std::to_string(*index),
                        "leave one pose for each scan");
  }
  if (poses.empty())
    return fail("the file holds no poses", path, "write a line a scan: index x y z qx qy qz qw");
  return poses;
}

std::string posesTumText(const IndexedPoses& world_from_scan) {
  std::string text;
  for (const auto& [index, pose] : world_from_scan) {
    checkFinite(pose);
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Quaterniond& q = pose.quaternion();
    text +=
        std::to_string(index) + ' ' + numbers({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}, ' ') + '\n';
  }
  return text;
}

std::string posesCsvText(const IndexedPoses& world_from_scan) {
  std::string text = "index,x_m,y_m,z_m,qx,qy,qz,qw,heading_x,heading_y,heading_z\n";
  for (const auto& [index, pose] : world_from_scan) {
    checkFinite(pose);
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Quaterniond& q = pose.quaternion();
    const Eigen::Vector3d h = pose.heading();
    text += std::to_string(index) + ',' +
            numbers({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), h.x(), h.y(), h.z()}, ',') + '\n';
  }
  return text;
}

Status writePosesTum(const std::filesystem::path& path, const IndexedPoses& world_from_scan) {
  return writeFileAtomically(path, posesTumText(world_from_scan));
}

Status writePosesCsv(const std::filesystem::path& path, const IndexedPoses& world_from_scan) {
  return writeFileAtomically(path, posesCsvText(world_from_scan));
}

Result<std::string> posesKittiText(const IndexedPoses& world_from_scan, const std::string& where) {
  std::string text;
  int expected = world_from_scan.empty() ? 0 : world_from_scan.begin()->first;
  for (const auto& [index, pose] : world_from_scan) {
    checkFinite(pose);
    if (index != expected++)
      return fail(
          "there is no pose of scan " + std::to_string(expected - 1), where,
          "KITTI files have a line for every scan: write TUM, which has indices, or register all scans");
    const Eigen::Matrix4d m = pose.matrix();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        text += shortestReal(m(row, column)) + (row == 2 && column == 3 ? '\n' : ' ');
  }
  return text;
}

Status writePosesKitti(const std::filesystem::path& path, const IndexedPoses& world_from_scan) {
  return posesKittiText(world_from_scan, path.string()).and_then([&](const std::string& text) {
    return writeFileAtomically(path, text);
  });
}

Eigen::Vector3d pointFrom3dtk(const Eigen::Vector3d& point_cm) {
  return Eigen::Vector3d(point_cm.x(), point_cm.z(), point_cm.y()) / 100.0;
}

Eigen::Vector3d pointTo3dtk(const Eigen::Vector3d& point_m) {
  return Eigen::Vector3d(point_m.x(), point_m.z(), point_m.y()) * 100.0;
}

Pose poseFrom3dtk(const Pose3dtk& pose) {
  const Eigen::Vector3d a = pose.angles_deg * kDegree;
  const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(a.x(), Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(a.y(), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(a.z(), Eigen::Vector3d::UnitZ()))
                                       .toRotationMatrix();
  return {Eigen::Matrix3d(swapped() * rotation * swapped()), pointFrom3dtk(pose.position_cm)};
}

Pose3dtk poseTo3dtk(const Pose& pose) {
  // R = Rx Ry Rz: R(0,2) = sin y, R(0,0) and R(0,1) = cos y (cos z, -sin z), R(1,2) and R(2,2) = cos y (-sin
  // x, cos x).
  const Eigen::Matrix3d r = swapped() * pose.rotation() * swapped();
  const double cos_y = std::hypot(r(0, 0), r(0, 1));
  const double y = std::atan2(r(0, 2), cos_y);
  const bool locked = cos_y < 1e-9;
  const double x = locked ? std::atan2(r(2, 1), r(1, 1)) : std::atan2(-r(1, 2), r(2, 2));
  const double z = locked ? 0.0 : std::atan2(-r(0, 1), r(0, 0));
  return {pointTo3dtk(pose.translation()), Eigen::Vector3d(x, y, z) / kDegree};
}

Result<Pose> readPose3dtk(const std::filesystem::path& path) {
  const auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  return parsePose3dtk(*bytes, path.string());
}

Result<Pose> parsePose3dtk(std::string_view bytes, const std::string& path) {
  const char* const remedy = "a .pose file holds x y z in cm and three angles in degrees";
  TextCursor cursor(bytes);
  std::string_view word;
  std::array<double, 6> v{};
  std::size_t count = 0;
  for (; cursor.nextWord(word); ++count) {
    const std::size_t line = cursor.lineNumber() + 1;
    if (count == v.size()) return refuseLine(path, line, "there are more than six numbers", remedy);
    const auto value = parseReal(word);
    if (!value || !std::isfinite(*value) || std::abs(*value) > 100.0 * 1e9)
      return refuseLine(path, line, printable(word) + " is not a number of a pose", remedy);
    v[count] = *value;
  }
  if (count < v.size())
    return fail("there are " + std::to_string(count) + " numbers instead of six", path, remedy);
  return poseFrom3dtk({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}});
}

Status writePose3dtk(const std::filesystem::path& path, const Pose& world_from_scan) {
  checkFinite(world_from_scan);
  const Pose3dtk p = poseTo3dtk(world_from_scan);
  return writeFileAtomically(path,
                             numbers({p.position_cm.x(), p.position_cm.y(), p.position_cm.z()}, ' ') + '\n' +
                                 numbers({p.angles_deg.x(), p.angles_deg.y(), p.angles_deg.z()}, ' ') + '\n');
}

Status writeFrames3dtk(const std::filesystem::path& path, const Pose& world_from_scan) {
  checkFinite(world_from_scan);
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = swapped() * world_from_scan.rotation() * swapped();
  m.topRightCorner<3, 1>() = pointTo3dtk(world_from_scan.translation());
  std::string text;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) text += shortestReal(m(row, column)) + ' ';
  return writeFileAtomically(path, text + "2\n");
}

Result<std::vector<std::string>> writePoses3dtk(const std::filesystem::path& folder, Poses3dtk kind,
                                                const IndexedPoses& world_from_scan) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    return fail("the folder cannot be made" + (error ? ": " + error.message() : ""), folder.string(),
                "choose another name, or a place where you may write");
  std::vector<std::string> files;
  for (const auto& [index, pose] : world_from_scan) {
    std::string number = std::to_string(index);
    if (number.size() < 3) number.insert(0, 3 - number.size(), '0');
    const bool frames = kind == Poses3dtk::FramesFiles;
    const auto path = folder / ("scan" + number + (frames ? ".frames" : ".pose"));
    if (Status status = frames ? writeFrames3dtk(path, pose) : writePose3dtk(path, pose); !status)
      return fail(status.error());
    files.push_back(path.string());
  }
  return files;
}

}  // namespace tiltmap
