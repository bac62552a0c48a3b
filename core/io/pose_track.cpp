#include "core/io/pose_track.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/base/text.h"
#include "core/geometry/body_axes.h"
#include "core/io/file_bytes.h"
#include "core/io/text_cursor.h"

namespace tiltmap {

namespace {

constexpr double kFurthest_m = 1e9;
constexpr double kUnitWithin = 0.01;
constexpr const char* kFields[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr const char* kRemedy = "a pose is a line of eight numbers: stamp x y z qx qy qz qw";

}  // namespace

Result<Pose> parsePoseWords(std::span<const std::string_view> words, const std::string& where) {
  std::array<double, std::size(kFields)> v{};
  if (words.size() != v.size()) throw std::invalid_argument("a pose has seven numbers");
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto value = parseReal(words[i]);
    if (!value || !std::isfinite(*value))
      return fail(std::string(kFields[i]) + ": " + printable(words[i]) + " is not a finite number", where,
                  kRemedy);
    if (std::abs(*value) > kFurthest_m)
      return fail(std::string(kFields[i]) + ": " + printable(words[i]) + " is too large", where,
                  "give metres, from an origin nearby");
    v[i] = *value;
  }
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (!(std::abs(rotation.norm() - 1.0) < kUnitWithin))
    return fail("qx qy qz qw: the quaternion is of length " + fixedReal(rotation.norm(), 3) + ", not 1",
                where, "send unit quaternions, with qw last");
  return Pose(rotation, Eigen::Vector3d(v[0], v[1], v[2]));
}

Result<StampedPose> parseStampedPose(std::string_view line, const std::string& where) {
  const auto words = splitWords(trimmed(line));
  if (words.size() != 1 + std::size(kFields))
    return fail("a pose needs 8 numbers, and there are " + std::to_string(words.size()), where, kRemedy);
  const auto stamp = parseReal(words[0]);
  if (!stamp || !std::isfinite(*stamp))
    return fail("stamp: " + printable(words[0]) + " is not a finite number", where, kRemedy);
  const auto pose = parsePoseWords(std::span(words).subspan(1), where);
  if (!pose) return fail(pose.error());
  return StampedPose{*stamp, *pose};
}

bool isPoseComment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.front() == '#';
}

Result<PoseTrack> PoseTrack::parse(std::string_view text, const std::string& file) {
  std::vector<StampedPose> poses;
  TextCursor cursor(text);
  std::string_view line;
  while (cursor.nextLine(line)) {
    if (isPoseComment(line)) continue;
    const std::string where = file + ":" + std::to_string(cursor.lineNumber());
    const auto pose = parseStampedPose(line, where);
    if (!pose) return fail(pose.error());
    if (!poses.empty() && !(pose->stamp_s > poses.back().stamp_s))
      return fail("stamp: " + shortestReal(pose->stamp_s) + " is not later than the one before, " +
                      shortestReal(poses.back().stamp_s),
                  where, "leave one line for each stamp, in their order");
    poses.push_back(*pose);
  }
  if (poses.empty()) return fail("the file holds no poses", file, kRemedy);
  return PoseTrack(std::move(poses));
}

Result<PoseTrack> PoseTrack::read(const std::filesystem::path& path) {
  const auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  return parse(*bytes, path.string());
}

Result<std::size_t> PoseTrack::nearest(double stamp_s, double within_s) const {
  if (!std::isfinite(stamp_s)) return fail("the stamp is not a finite number", "stamp", "give a number");
  const auto later = std::ranges::lower_bound(poses_, stamp_s, {}, &StampedPose::stamp_s);
  auto found = later;
  if (later == poses_.end() ||
      (later != poses_.begin() && stamp_s - std::prev(later)->stamp_s <= later->stamp_s - stamp_s))
    found = std::prev(later);
  if (std::abs(found->stamp_s - stamp_s) > within_s)
    return fail("there is no pose within " + shortestReal(within_s) + " of stamp " + shortestReal(stamp_s) +
                    "; the nearest is at " + shortestReal(found->stamp_s),
                "stamp", "choose a stamp of the file");
  return static_cast<std::size_t>(found - poses_.begin());
}

Result<Pose> stepInTrack(const PoseTrack& track, double last_stamp_s, double next_stamp_s, double within_s,
                         const Pose& scan_from_body) {
  const auto last = track.nearest(last_stamp_s, within_s), next = track.nearest(next_stamp_s, within_s);
  if (!last) return fail(last.error());
  if (!next) return fail(next.error());
  if (*last == *next)
    return fail(
        "both stops have the same pose of the file, that of stamp " + shortestReal(track.at(*last).stamp_s),
        "stamp", "choose another stamp for one of them");
  return stepBetween(track.at(*last).world_from_body, track.at(*next).world_from_body, scan_from_body);
}

}  // namespace tiltmap
