// Real scans for tests: where they are, and the least that reads them. Not the program's readers (core/io),
// which have tests of their own; these trust their files.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/scan/range_image.h"

namespace tiltmap::test_support {

// The folder of real scans: TILTMAP_SHARED_DATA, else beside the source tree; nothing where it is absent.
inline std::optional<std::filesystem::path> realData(const std::string& folder) {
  const char* set = std::getenv("TILTMAP_SHARED_DATA");
  std::filesystem::path root = set ? std::filesystem::path(set) : std::filesystem::path();
#ifdef TILTMAP_SOURCE_DIR
  if (!set) root = std::filesystem::path(TILTMAP_SOURCE_DIR).parent_path() / "shared" / "data";
#endif
  root /= folder;
  if (!std::filesystem::is_directory(root)) return std::nullopt;
  return root;
}

// An unordered cloud as a scan of one row; points nearer or further than the bounds are left out.
inline Scan cloudScan(const std::vector<Eigen::Vector3d>& points, const std::string& name,
                      double min_range_m = 0.1, double max_range_m = 1e4) {
  RangeImageData data;
  data.rows = 1;
  data.line_tilt_rad = {0.0};
  for (const Eigen::Vector3d& p : points) {
    const double range = p.norm();
    if (!(range >= min_range_m) || !(range <= max_range_m)) continue;
    data.range_m.push_back(static_cast<float>(range));
    data.code.push_back(cell_code::kMeasured);
    data.direction.push_back((p / range).cast<float>().normalized());
  }
  data.columns = static_cast<int>(data.range_m.size());
  Scan scan;
  scan.geometry.rows = 1;
  scan.geometry.columns = data.columns;
  scan.image = RangeImage::make(std::move(data)).value();
  scan.name = name;
  return scan;
}

// ASCII PCD: the first three fields of each line after DATA.
inline std::vector<Eigen::Vector3d> readAsciiPcd(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line) && line.rfind("DATA", 0) != 0) {
  }
  std::vector<Eigen::Vector3d> points;
  while (std::getline(in, line)) {
    Eigen::Vector3d p;
    if (std::sscanf(line.c_str(), "%lf %lf %lf", &p.x(), &p.y(), &p.z()) == 3) points.push_back(p);
  }
  return points;
}

// Legacy ASCII VTK: the POINTS.
inline std::vector<Eigen::Vector3d> readAsciiVtk(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string word;
  while (in >> word && word != "POINTS") {
  }
  std::size_t count = 0;
  in >> count >> word;
  std::vector<Eigen::Vector3d> points(count);
  for (auto& p : points) in >> p.x() >> p.y() >> p.z();
  return points;
}

// One scan of the 3DTK set: 226 x 360 cells, the pose beside it as its odometry. Theirs is left-handed (x
// right, y up, z forward), in centimetres; rotation Rx Ry Rz.
inline Scan readUosScan(const std::filesystem::path& folder, int index) {
  char name[16];
  std::snprintf(name, sizeof name, "scan%03d", index);
  Scan scan;
  scan.name = name;
  scan.geometry.rows = 226;
  scan.geometry.columns = 360;
  RangeImageData data;
  data.rows = 226;
  data.columns = 360;
  std::ifstream in(folder / (std::string(name) + ".3d"));
  double x = 0, y = 0, z = 0, tilt = 0, count = 0;
  while (in >> x >> y >> z) {
    const double range = 0.01 * std::sqrt(x * x + y * y + z * z);
    const bool far = range > 32.0, body = range < 0.5;
    data.range_m.push_back(far || body ? 0.0F : static_cast<float>(range));
    data.code.push_back(far ? cell_code::kNoReturn : body ? cell_code::kMasked : cell_code::kMeasured);
    const std::size_t column = (data.range_m.size() - 1) % 360;
    if (column > 60 && column < 300) tilt += std::atan2(y, z), count += 1.0;
    if (column == 359) data.line_tilt_rad.push_back(tilt / count), tilt = count = 0.0;
  }
  scan.geometry.tilt_start_rad = data.line_tilt_rad.front();
  scan.geometry.tilt_step_rad = (data.line_tilt_rad.back() - data.line_tilt_rad.front()) / 225.0;
  scan.image = RangeImage::make(std::move(data)).value();
  std::ifstream pose(folder / (std::string(name) + ".pose"));
  Eigen::Vector3d t, e;
  pose >> t.x() >> t.y() >> t.z() >> e.x() >> e.y() >> e.z();
  e *= kDegree;
  const Eigen::Matrix3d theirs = (Eigen::AngleAxisd(e.x(), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(e.y(), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(e.z(), Eigen::Vector3d::UnitZ()))
                                     .toRotationMatrix();
  Eigen::Matrix3d swap = Eigen::Matrix3d::Zero();
  swap(0, 0) = swap(1, 2) = swap(2, 1) = 1.0;
  scan.odometry = Pose(Eigen::Matrix3d(swap * theirs * swap), 0.01 * swap * t);
  return scan;
}

// The 13 stations with their planar starts (world_from_scan) as odometry.
inline std::vector<Scan> readStations(const std::filesystem::path& folder) {
  std::vector<Scan> scans;
  std::ifstream in(folder / "initial_poses.txt");
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name;
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m;
    words >> name;
    for (int i = 0; i < 16; ++i) words >> m.data()[i];
    Scan scan = cloudScan(readAsciiPcd(folder / (name + ".pcd")), name);
    scan.odometry = Pose(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), m.topRightCorner<3, 1>());
    scans.push_back(std::move(scan));
  }
  return scans;
}

}  // namespace tiltmap::test_support
