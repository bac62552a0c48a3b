// Small scans, links and edits for tests of projects, and a project's visible state as one text to compare.
#pragma once

#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/project/project.h"

namespace tiltmap::test {

struct ImageOptions {
  int rows = 5;
  int columns = 7;
  bool intensity = true;
  bool times = true;
  bool directions = false;
};

// Every kind of cell, different for each seed.
inline RangeImagePtr sampleImage(std::uint64_t seed, const ImageOptions& options = {}) {
  RandomStream random(seed);
  RangeImageData data;
  data.rows = options.rows;
  data.columns = options.columns;
  const CellCode codes[] = {cell_code::kMissing,     cell_code::kNoReturn,    cell_code::kLmsOverflow,
                            cell_code::kOutOfBounds, cell_code::kLmsNoSignal, cell_code::kReplaced};
  for (std::size_t i = 0; i < data.cells(); ++i) {
    const CellCode code = random.below(4) == 0 ? codes[random.below(6)] : cell_code::kMeasured;
    data.code.push_back(code);
    data.range_m.push_back(cell_code::hasPoint(code) ? static_cast<float>(random.uniform(0.5, 80.0)) : 0.0F);
    if (options.intensity) data.intensity.push_back(static_cast<float>(random.uniform()));
    if (options.directions)
      data.direction.push_back(cell_code::hasPoint(code)
                                   ? Eigen::Vector3f(static_cast<float>(random.normal()), 1.0F,
                                                     static_cast<float>(random.normal()))
                                         .normalized()
                                   : Eigen::Vector3f::Zero());
  }
  for (int row = 0; row < options.rows; ++row) {
    data.line_tilt_rad.push_back(-0.5 + 0.01 * row + 1e-4 * random.normal());
    if (options.times) data.line_time_s.push_back(1.9e9 + 0.5 * row + random.uniform());
  }
  auto image = RangeImage::make(std::move(data));
  if (!image) throw std::logic_error(image.error().what);
  return *image;
}

inline Pose samplePose(std::uint64_t seed) {
  RandomStream random(seed * 7919 + 1);
  return Pose::planar(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-3, 3))
      .moved((Vector6d() << 0.01 * random.normal(), 0.01 * random.normal(), 0.01 * random.normal(),
              random.normal(), random.normal(), random.normal())
                 .finished());
}

inline Scan sampleScan(std::uint64_t seed, const ImageOptions& options = {}) {
  Scan scan;
  scan.geometry.rows = options.rows;
  scan.geometry.columns = options.columns;
  scan.geometry.tilt_zero_rad = 0.001;
  scan.geometry.lever_arm_m = {0.01, 0.02, 0.03};
  scan.geometry.mounting = rotationExp({0.001, 0.002, 0.003});
  scan.image = sampleImage(seed, options);
  scan.odometry = samplePose(seed);
  scan.name = "stop " + std::to_string(seed);
  scan.source = "sample " + std::to_string(seed);
  return scan;
}

inline std::vector<Scan> sampleScans(int count, const ImageOptions& options = {}) {
  std::vector<Scan> scans;
  for (int i = 0; i < count; ++i) scans.push_back(sampleScan(static_cast<std::uint64_t>(i + 1), options));
  return scans;
}

inline Link sampleLink(ScanId fixed, ScanId moving, std::uint64_t seed = 1) {
  Link link;
  link.fixed = fixed;
  link.moving = moving;
  link.fixed_from_moving = samplePose(seed + 1000);
  link.iterations = 12;
  link.correspondences = 3456;
  link.rms_m = 0.0123;
  link.overlap = 0.61;
  link.milliseconds = 98.5;
  link.stop_reason = "converged";
  link.succeeded = true;
  link.information = Matrix6d::Identity() * (1e7 * static_cast<double>(seed));
  (*link.information)(0, 5) = (*link.information)(5, 0) = 0.25;
  return link;
}

// The value of a Result that must be there.
template <class T>
T must(Result<T> result) {
  if (!result)
    throw std::runtime_error(result.error().what + " | " + result.error().where + " | " +
                             result.error().remedy);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

inline std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%a", value);  // every bit
  return buffer;
}

inline std::string text(const Pose& pose) {
  std::string out;
  for (int i = 0; i < 3; ++i) out += text(pose.translation()[i]) + " ";
  for (int i = 0; i < 4; ++i) out += text(pose.quaternion().coeffs()[i]) + " ";
  return out;
}

// Everything a user can see of a project but history, every bit of every number; matrices as a checksum.
inline std::string visibleState(const ProjectSnapshot& snapshot) {
  std::ostringstream out;
  for (const ScanEntry& scan : snapshot.scans()) {
    out << "scan " << scan.id << " " << scan.name << " | " << scan.source << " | " << scan.note << " | "
        << (scan.colour ? std::to_string(*scan.colour) : "own colour") << " | "
        << scan.rows << "x" << scan.columns << " lines " << scan.lines << " valid " << scan.valid_cells
        << " lever " << text(scan.geometry.lever_arm_m.x()) << " zero " << text(scan.geometry.tilt_zero_rad)
        << "\n";
    for (const auto& [stage, pose] : scan.poses) out << "  " << stageName(stage) << " " << text(pose) << "\n";
    for (const Photograph& p : scan.photographs)
      out << "  photograph " << p.id << " " << p.caption << " " << p.media_type << " " << p.path << " "
          << p.bytes << "\n";
    const auto image = scan.image();
    if (!image) {
      out << "  NO IMAGE: " << image.error().what << "\n";
      continue;
    }
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < (*image)->cells(); ++i)
      sum =
          sum * 1099511628211ULL + (*image)->code(i) + static_cast<std::uint64_t>((*image)->range(i) * 1e6F);
    out << "  image " << sum << "\n";
  }
  for (const Link& link : snapshot.links()) {
    out << "link " << link.id << " " << link.fixed << "-" << link.moving << " "
        << text(link.fixed_from_moving) << link.iterations << " " << link.correspondences << " "
        << text(link.rms_m) << " " << text(link.overlap) << " " << text(link.milliseconds) << " "
        << link.stop_reason << " " << link.succeeded << " " << linkOriginName(link.origin) << " "
        << linkStateName(link.state);
    if (link.information)
      for (int i = 0; i < 36; ++i) out << " " << text(link.information->data()[i]);
    out << "\n";
  }
  for (const JobRecord& job : snapshot.jobs())
    out << "job " << job.id << " " << job.operation << " " << job.preset << " "
        << parametersToJson(job.values) << " " << job.program_version << " " << job.started << " "
        << job.finished << " " << jobStateName(job.state) << "\n";
  const SurveyInfo& survey = snapshot.survey();
  out << "survey " << survey.site << " | " << survey.operator_name << " | " << survey.device << " | "
      << survey.date << "\n";
  return out.str();
}

inline std::vector<ScanId> scanIds(const ProjectSnapshot& snapshot) {
  std::vector<ScanId> ids;
  for (const ScanEntry& scan : snapshot.scans()) ids.push_back(scan.id);
  return ids;
}

// Links of a chain and pairwise poses, as registering neighbours makes them.
inline ProjectEdit sampleRegister(const SnapshotPtr& snapshot, std::uint64_t seed = 1) {
  std::vector<Link> links;
  std::vector<std::pair<ScanId, Pose>> poses;
  const auto ids = scanIds(*snapshot);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i > 0) links.push_back(sampleLink(ids[i - 1], ids[i], seed + i));
    poses.emplace_back(ids[i], samplePose(seed + 100 + i));
  }
  return registerEdit(snapshot, std::move(links), std::move(poses));
}

inline ProjectEdit sampleRelax(const SnapshotPtr& snapshot, std::uint64_t seed = 1) {
  std::vector<std::pair<ScanId, Pose>> poses;
  for (const ScanId id : scanIds(*snapshot))
    poses.emplace_back(id, samplePose(seed * 1000 + static_cast<std::uint64_t>(id)));
  return relaxEdit(snapshot, std::move(poses));
}

}  // namespace tiltmap::test
