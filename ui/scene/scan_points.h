// The points of one scan as the 3D view needs them, and their colours.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/products/colour.h"
#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

enum class SceneColouring { Scan, Height, Range, Intensity, Normal, Age, Residual };
inline constexpr SceneColouring kSceneColourings[] = {
    SceneColouring::Scan,   SceneColouring::Height, SceneColouring::Range,   SceneColouring::Intensity,
    SceneColouring::Normal, SceneColouring::Age,    SceneColouring::Residual};
// "scan", "height", "range", "intensity", "normal", "age", "residual": for flags.
const std::string& sceneColouringName(SceneColouring colouring);
Result<SceneColouring> parseSceneColouring(const std::string& name);
std::string sceneColouringTitle(SceneColouring colouring);  // "Height (m)"

// Scan frame, metres; parallel arrays. In an order of which every beginning is spread evenly over the
// surfaces that were seen: the first thousand points are a coarse picture of all of them.
struct ScanPoints {
  ScanId scan = 0;
  std::int64_t matrix = 0;  // identity of what they were made from
  int lines = 0;            // that it held; it grows while it is captured
  std::int64_t geometry = 0;
  bool reduced = false;
  bool with_normals = false;
  int columns = 0;
  std::vector<float> xyz;           // three a point
  std::vector<std::uint32_t> cell;  // row-major
  std::vector<float> intensity;     // empty, or one a point
  std::vector<float> normal;        // three a point; filled on demand
  std::vector<double> line_time_s;  // empty, or one a row
  std::vector<double> density;      // at 257 places from the first point to the last, see countAtDensity()
  std::size_t size() const { return cell.size(); }
  // How many of the first points make so many a square metre (of a surface that faces the scanner; in units
  // that are the same for all scans of one kind). Drawing several scans to one density spreads them alike.
  std::size_t countAtDensity(double density) const;
};

inline constexpr double kReducedDistance_m = 0.25;  // neighbours of a line nearer than this become one

// Error: the project's file cannot be read.
Result<ScanPoints> scanPointsOf(const ScanEntry& scan, bool reduced);
void addNormals(ScanPoints& points, const ScanEntry& scan);

// Points of one scan that somebody has to read.
struct PointsWanted {
  ScanEntry scan;
  bool reduced = false;
  bool normals = false;
};
// Points with the same key are the same, within a project.
struct PointsKey {
  ScanId scan = 0;
  std::int64_t matrix = 0;
  int lines = 0;
  std::int64_t geometry = 0;
  bool reduced = false;
  bool normals = false;
  auto operator<=>(const PointsKey&) const = default;
};
PointsKey keyOf(const PointsWanted& wanted);
PointsKey keyOf(const ScanPoints& points);
// scanPointsOf() and, where wanted, addNormals(). Stopped: what it has by then.
Result<ScanPoints> readPoints(const PointsWanted& wanted, const std::stop_token& stop);

// What colours mean, over all scans that are shown.
struct ColourRange {
  double low = 0.0;
  double high = 1.0;
  bool known = false;  // something has a value
};

// Orders the points evenly and fills in `density`. What scanPointsOf() does last.
void orderEvenly(ScanPoints& points, bool is_matrix, bool is_regular);

// Values of the colouring, one a point (heights in the world frame); empty where it has none. Age: seconds
// since `first_time_s`, or `index`, the scan's place in the survey, where that is not known.
std::vector<float> colourValues(const ScanPoints& points, SceneColouring colouring,
                                const Pose& world_from_scan, std::size_t index,
                                std::optional<double> first_time_s);
// Between these lie most of the values given.
ColourRange colourRangeOf(std::vector<float> values, SceneColouring colouring);
// `count` indices evenly spread over 0 .. size-1, ascending; all of them where count >= size.
std::vector<std::uint32_t> evenlyStrided(std::size_t size, std::size_t count);

}  // namespace tiltmap::ui
