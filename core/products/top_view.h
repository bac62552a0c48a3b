// A map seen from above, as a picture: points, the path with its stops, a scale.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/parameter.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/products/rgb_image.h"

namespace tiltmap {

enum class TopViewColouring { Scan, Height, Density };
enum class TopViewBackground { Dark, White };  // for a screen, for paper

struct TopViewSettings {
  TopViewColouring colouring = TopViewColouring::Scan;
  TopViewBackground background = TopViewBackground::Dark;
  int width_px = 1600;        // of the picture; its height follows the map
  double point_px = 0.0;      // radius of a point; 0 chooses by how many points there are
  double shown_share = 0.98;  // of the points, along x and along y: the rest lies outside the picture
};
const ParameterTable<TopViewSettings>& topViewParameters();

struct TopViewCloud {
  std::size_t scan = 0;                 // chooses the colour
  std::vector<Eigen::Vector3d> points;  // world frame, metres; points that are not finite are left out
};

struct TopViewInput {
  std::string title;  // UTF-8
  std::vector<TopViewCloud> clouds;
  std::vector<Pose> world_from_scan;  // the stops in the order they were driven
  std::vector<Rgb> colours;           // by scan; those that are not there have the colour of their place
};

// Where the world is in the picture: x to the right, y up.
struct TopViewFrame {
  Eigen::Vector2d low_m = Eigen::Vector2d::Zero();  // the lower left corner of the map
  double px_per_m = 1.0;
  int map_width_px = 0;  // the map begins at the top left of the picture
  int map_height_px = 0;

  // In pixels from the top left corner of the picture; the middle of pixel (0,0) is (0.5, 0.5).
  Eigen::Vector2d pixelOf(const Eigen::Vector2d& world_m) const {
    const Eigen::Vector2d p = (world_m - low_m) * px_per_m;
    return {p.x(), map_height_px - p.y()};
  }
};

struct ScaleBar {
  double length_m = 0.0;              // 1, 2 or 5 times a power of ten
  Eigen::Vector2d left_px, right_px;  // its two ends
};

struct TopView {
  RgbImage image;
  TopViewFrame frame;
  ScaleBar scale_bar;
  std::size_t points_drawn = 0;
};

// The fullness of a pixel is shown in a logarithmic tone, so that the thousands of points around a stop do
// not drown the walls; colours are mixed as light. The same input gives the same picture. Error: neither
// points nor stops, a stop that is not finite, or a width that is out of range.
Result<TopView> drawTopView(const TopViewInput& input, const TopViewSettings& settings = {});

}  // namespace tiltmap
