// Poses over time, as odometry and trajectories come: text lines `stamp x y z qx qy qz qw` (TUM).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/pose.h"

namespace tiltmap {

struct StampedPose {
  double stamp_s = 0.0;  // on the clock of who writes the poses
  Pose world_from_body;  // metres; body and world as the writer has them (core/geometry/body_axes.h)
};

// The seven words `x y z qx qy qz qw`. Fails, naming the word's field, where one is no finite number, is
// further than 1e9 m away, or where the quaternion's length is not 1 within 1 %. Throws std::invalid_argument
// for another number of words.
Result<Pose> parsePoseWords(std::span<const std::string_view> words, const std::string& where);
// One line of eight words: the stamp, any finite number, comes first. Not for blank lines and comments.
Result<StampedPose> parseStampedPose(std::string_view line, const std::string& where);
// Blank, or begins with #.
bool isPoseComment(std::string_view line);

// In the order of their stamps; at least one pose.
class PoseTrack {
 public:
  // Fails with file and line, for what parseStampedPose() refuses, for a stamp that is not later than the one
  // before, and for text without any pose.
  static Result<PoseTrack> parse(std::string_view text, const std::string& file);
  static Result<PoseTrack> read(const std::filesystem::path& path);

  std::size_t size() const { return poses_.size(); }
  const StampedPose& at(std::size_t index) const { return poses_.at(index); }
  // The index of the pose whose stamp is nearest, the earlier one of two that are equally near. Fails where
  // that is further away than `within_s`, and for a stamp that is not finite.
  Result<std::size_t> nearest(double stamp_s, double within_s) const;

 private:
  explicit PoseTrack(std::vector<StampedPose> poses) : poses_(std::move(poses)) {}
  std::vector<StampedPose> poses_;
};

// last_from_next between the poses nearest to two stamps, as stepBetween() has it. Fails where nearest()
// does, and where both stamps have the same pose.
Result<Pose> stepInTrack(const PoseTrack& track, double last_stamp_s, double next_stamp_s, double within_s,
                         const Pose& scan_from_body);

}  // namespace tiltmap
