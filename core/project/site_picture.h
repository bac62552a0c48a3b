// A picture of the site from above, and where it lies in the world.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/result.h"

namespace tiltmap {

class ProjectSnapshot;
struct ProjectEdit;

// A point that one finds again: where it is in the picture and where in the world.
struct SitePicturePoint {
  Eigen::Vector2d picture_px = Eigen::Vector2d::Zero();  // from the top left corner; x to the right, y down
  Eigen::Vector2d world_m = Eigen::Vector2d::Zero();     // x to the right, y forward, seen from above
};
using SitePicturePoints = std::array<SitePicturePoint, 2>;

// In the project. The bytes are read with ProjectSnapshot::sitePictureBytes().
struct SitePicture {
  std::int64_t attachment = 0;  // identity of the stored picture: same number, same bytes
  std::string name;             // of the file it came from
  std::string media_type;       // "image/jpeg"
  SitePicturePoints points;
};

// The similarity that two points determine: turned, scaled and moved, never sheared. The picture is looked at
// from above, so its y axis runs against the world's.
class SitePicturePlacement {
 public:
  // Error: the two points coincide in the picture or in the world, or are not finite.
  static Result<SitePicturePlacement> make(const SitePicturePoints& points);

  Eigen::Vector2d worldOf(const Eigen::Vector2d& picture_px) const;
  Eigen::Vector2d pictureOf(const Eigen::Vector2d& world_m) const;
  double metresPerPixel() const { return turn_.norm(); }

 private:
  // As complex numbers, with p = px - i py: world = turn * p + shift.
  Eigen::Vector2d turn_ = Eigen::Vector2d::UnitX();
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
};

// What an edit brings in: new bytes, or those that are there already, placed anew.
struct NewSitePicture {
  std::string name;
  std::string media_type;
  std::vector<unsigned char> bytes;  // empty: `attachment`
  std::int64_t attachment = 0;
  SitePicturePoints points;
};

// Error: the file cannot be read, is no picture or is larger than 200 MB, or the points place nothing.
Result<ProjectEdit> sitePictureEdit(const std::filesystem::path& file, const SitePicturePoints& points);
// Error: there is no picture to place, or the points place nothing.
Result<ProjectEdit> placeSitePictureEdit(const ProjectSnapshot& snapshot, const SitePicturePoints& points);
// Error: there is none.
Result<ProjectEdit> removeSitePictureEdit(const ProjectSnapshot& snapshot);

// The project file's text, and back; nothing for a text that is none.
std::string sitePictureText(const SitePicture& picture);
std::optional<SitePicture> parseSitePicture(const std::string& text);

}  // namespace tiltmap
