#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>

#include "core/base/text.h"
#include "core/io/scan_reader.h"
#include "core/scan/kd_tree.h"
#include "core/scan/normals.h"
#include "core/scan/point_cloud.h"
#include "tests/benchmarks/pair_run.h"
#include "tests/benchmarks/pair_sets.h"

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

struct RealSet {
  std::string subject;
  std::vector<Scan> scans;  // odometry: where the search starts from
  bool odometry_is_reference =
      false;             // the poses that came with the scans are better than nothing as a truth
  double good_m = 0.01;  // a triangle that closes better counts as right
};

Result<Scan> readScan(const fs::path& path, const ReadOptions& options) {
  Result<ReadResult> read = readScans(path, options);
  if (!read) return fail(read.error());
  return read->scans.front().scan;
}

std::string numbered(const char* pattern, int number) {
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), pattern, number);
  return name.data();
}

Result<std::vector<Scan>> readNumbered(const fs::path& folder, const char* pattern, int count,
                                       const ReadOptions& options) {
  std::vector<Scan> scans;
  for (int i = 0; i < count; ++i) {
    Result<Scan> scan = readScan(folder / numbered(pattern, i), options);
    if (!scan) return fail(scan.error());
    scans.push_back(std::move(*scan));
  }
  return scans;
}

// Lines `name m00 m01 m02 m03 m10 ...`, world_from_scan; a # begins a remark.
Result<std::vector<Pose>> readMatrices(const fs::path& path) {
  std::ifstream file(path);
  std::vector<Pose> poses;
  for (std::string line; std::getline(file, line);) {
    const std::vector<std::string_view> words = splitWords(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    if (words.size() != 17)
      return fail("a line is not a name and 16 numbers", path.string(), "check the file");
    Eigen::Matrix4d m;
    for (int k = 0; k < 16; ++k) {
      const std::optional<double> value = parseReal(words[static_cast<std::size_t>(k) + 1]);
      if (!value) return fail("a word is no number", path.string(), "check the file");
      m(k / 4, k % 4) = *value;
    }
    poses.emplace_back(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), Eigen::Vector3d(m.topRightCorner<3, 1>()));
  }
  return poses;
}

Result<RealSet> garage(const fs::path& data) {
  Result<std::vector<Scan>> scans = readNumbered(data / "bedkowski_13", "scan%03d.pcd", 13, {});
  if (!scans) return fail(scans.error());
  const Result<std::vector<Pose>> poses = readMatrices(data / "bedkowski_13" / "initial_poses.txt");
  if (!poses) return fail(poses.error());
  if (poses->size() != scans->size())
    return fail("poses and scans differ in number", "bedkowski_13", "check the files");
  for (std::size_t i = 0; i < scans->size(); ++i) (*scans)[i].odometry = (*poses)[i];
  return RealSet{"bedkowski_13, underground garage, 13 tripod stations: triangles (chained against direct)",
                 std::move(*scans)};
}

Result<RealSet> office(const fs::path& data) {
  ReadOptions options;
  options.minimum_range_m = 0.5;
  options.maximum_range_m = 32.0;
  Result<std::vector<Scan>> scans = readNumbered(data / "3dtk_dat", "scan%03d.3d", 3, options);
  if (!scans) return fail(scans.error());
  return RealSet{"3dtk_dat, indoor, tilted SICK: neighbours against their .pose", std::move(*scans), true};
}

Result<RealSet> outdoor(const fs::path& data) {
  Result<std::vector<Scan>> scans = readNumbered(data / "libpointmatcher", "cloud.%05d.vtk", 3, {});
  if (!scans) return fail(scans.error());
  for (Scan& scan : *scans) scan.odometry = Pose();
  return RealSet{"libpointmatcher, outdoor, from the identity: its triangle (chained against direct)",
                 std::move(*scans), false, 0.02};
}

// Neighbours first, then every second: triangle t is pair t, pair t + 1 and pair (count - 1) + t.
std::vector<PairProblem> trianglePairs(const RealSet& set) {
  std::vector<PairProblem> pairs;
  const auto add = [&](std::size_t i, std::size_t j) {
    const Pose start = set.scans[i].odometry.inverse() * set.scans[j].odometry;
    pairs.push_back({set.subject.substr(0, set.subject.find(',')) + ", pair " + std::to_string(i) + ":" +
                         std::to_string(j),
                     set.scans[i], set.scans[j], start,
                     set.odometry_is_reference ? std::optional(start) : std::nullopt});
  };
  for (std::size_t i = 0; i + 1 < set.scans.size(); ++i) add(i, i + 1);
  if (!set.odometry_is_reference)
    for (std::size_t i = 0; i + 2 < set.scans.size(); ++i) add(i, i + 2);
  return pairs;
}

// Surfaces of a fixed scan, to measure how well another lies on them: the same yardstick for all programs.
class Surfaces {
 public:
  explicit Surfaces(const Scan& scan)
      : points_(cloudOf(*scan.image, scan.geometry).points),
        normals_(cloudNormals(points_, 12, Eigen::Vector3d::Zero())),
        tree_(points_) {}

  // Median distance along the normal of every tenth point that has a surface within half a metre.
  double residual(const Scan& moving, const Pose& fixed_from_moving) const {
    const std::vector<Eigen::Vector3d> points = cloudOf(*moving.image, moving.geometry).points;
    std::vector<double> distances;
    for (std::size_t i = 0; i < points.size(); i += 10) {
      const Eigen::Vector3d p = fixed_from_moving * points[i];
      KdTree::Neighbour near;
      if (tree_.nearestWithin(p, 0.5, near) && !normals_[near.index].isZero())
        distances.push_back(std::abs(normals_[near.index].dot(p - points_[near.index])));
    }
    return median(std::move(distances));
  }

 private:
  std::vector<Eigen::Vector3d> points_, normals_;
  KdTree tree_;
};

using FoundPoses = std::vector<std::optional<Pose>>;  // one a pair

std::vector<PoseDifference> closures(const RealSet& set, const std::vector<PairProblem>& pairs,
                                     const FoundPoses& found) {
  const auto pose = [&](std::size_t pair) {
    return found[pair].value_or(pairs[pair].start_fixed_from_moving);
  };
  std::vector<PoseDifference> list;
  for (std::size_t t = 0; t + 2 < set.scans.size(); ++t)
    list.push_back(difference(pose(t) * pose(t + 1), pose(set.scans.size() - 1 + t)));
  return list;
}

void addRows(Table& table, const RealSet& set, const std::vector<PairMethod>& methods, int rounds,
             const std::function<void(const std::string&)>& tell) {
  const std::vector<PairProblem> pairs = trianglePairs(set);
  const std::vector<PairMeasurement> measured = runPairs(pairs, methods, rounds, tell);
  const std::size_t first_row = table.rows.size();
  addPairRows(table, set.subject, methods, measured);
  std::vector<std::vector<double>> residuals(methods.size());
  for (std::size_t i = 0; i + 1 < set.scans.size(); ++i) {
    const Surfaces surfaces(set.scans[i]);
    for (const PairMeasurement& m : measured)
      if (m.problem == i && m.fixed_from_moving)
        residuals[m.method].push_back(surfaces.residual(set.scans[i + 1], *m.fixed_from_moving));
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    Row& row = table.rows[first_row + m];
    if (!residuals[m].empty()) {
      std::array<char, 64> text{};
      std::snprintf(text.data(), text.size(), "residual %.1f mm", median(residuals[m]) * 1e3);
      row.remark = text.data() + (row.remark.empty() ? "" : "; " + row.remark);
    }
    if (set.odometry_is_reference) continue;
    FoundPoses found(pairs.size());
    for (const PairMeasurement& measurement : measured)
      if (measurement.method == m) found[measurement.problem] = measurement.fixed_from_moving;
    std::vector<double> metres, radians;
    std::size_t good = 0;
    for (const PoseDifference& closure : closures(set, pairs, found)) {
      metres.push_back(closure.translation_m);
      radians.push_back(closure.rotation_rad);
      good += closure.translation_m <= set.good_m ? 1 : 0;
    }
    row.median_mm = median(metres) * 1e3;
    row.median_deg = median(radians) / kDegree;
    row.most_mm = quantile(metres, 0.95) * 1e3;
    row.worst_mm = *std::max_element(metres.begin(), metres.end()) * 1e3;
    row.worst_deg = *std::max_element(radians.begin(), radians.end()) / kDegree;
    row.within = std::to_string(good) + "/" + std::to_string(metres.size()) + " (" +
                 std::to_string(static_cast<int>(std::lround(set.good_m * 100.0))) + " cm)";
  }
}

}  // namespace

fs::path sharedData() {
  const char* named = std::getenv("TILTMAP_SHARED_DATA");
  const fs::path path = named ? fs::path(named) : fs::path(TILTMAP_SOURCE_DIR) / ".." / "shared" / "data";
  std::error_code error;
  return fs::is_directory(path, error) ? path : fs::path();
}

void addRealRows(Table& table, const std::vector<PairMethod>& methods, int rounds,
                 const std::function<void(const std::string&)>& tell) {
  const fs::path data = sharedData();
  if (data.empty()) {
    table.notes.push_back(
        "Skipped: the real scans (no ../shared/data; TILTMAP_SHARED_DATA may name the folder).");
    return;
  }
  for (const auto& read : {garage, office, outdoor}) {
    const Result<RealSet> set = read(data);
    if (!set) {
      table.notes.push_back("Skipped: " + set.error().where + ": " + set.error().what);
      continue;
    }
    addRows(table, *set, methods, rounds, tell);
  }
}

}  // namespace tiltmap::benchmarks
