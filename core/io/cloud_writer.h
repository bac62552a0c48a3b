// Writing points for other programs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/scan/point_cloud.h"
#include "core/scan/range_image.h"

namespace tiltmap {

enum class CloudFormat {
  Ply,  // binary little-endian
  Pcd,  // binary
  Xyz,  // text: x y z [intensity] [r g b], no header; .xyz, .txt, .asc
  Csv,  // text with a header line naming the columns
  Ptx,  // text, one block a scan with its matrix and pose
  Vtk,  // legacy, binary
  Uos,  // 3DTK .3d (and the .pose beside it), one scan a file
};

// By extension: ply, pcd, xyz, txt, asc, csv, ptx, vtk, 3d. Anything else is an Error that lists them.
Result<CloudFormat> cloudFormatOf(const std::filesystem::path& path);

enum class CloudColour {
  None,
  Scan,       // ExportScan::colour
  Height,     // z in the world, blue to red over 1 to 99 % of the points
  Intensity,  // grey over 1 to 99 %
};

// One scan to be written, in its own frame.
struct ExportScan {
  int index = 0;         // written as the field `scan`
  Pose world_from_scan;  // points leave the program in the world frame unless the format carries a pose
  PointCloud cloud;      // raw (cloudOf) or reduced
  // The range matrix, for the formats that can keep it (see writeCloud). The others write `cloud`, or, where
  // that is empty, the cells with a point.
  RangeImagePtr image;
  ScannerGeometry geometry;
  std::optional<std::array<std::uint8_t, 3>> colour;  // for CloudColour::Scan; nothing: a hue by index
};

// What to write, scan by scan, so that only one need be in memory. `scan` is called several times for each
// number (to count, to write, in VTK for each attribute) and must give the same every time.
struct CloudForExport {
  std::size_t scans = 0;
  std::function<Result<ExportScan>(std::size_t)> scan;
  bool intensity = false;  // write the intensity; a scan without it gets 0
  bool normals = false;    // write normals; a point without one gets 0 0 0
};
// From scans in memory; intensity and normals are written when any scan has them.
CloudForExport cloudForExport(std::vector<ExportScan> scans);

// What becomes the first and the last colour: heights in the world (m) or intensities.
struct ColourScale {
  double low = 0.0, high = 1.0;
};

struct WriteOptions {
  std::optional<CloudFormat> format;  // nothing: by extension
  CloudColour colour = CloudColour::None;
  // For CloudColour::Height and Intensity; nothing: colourScale of what is written.
  std::optional<ColourScale> scale = std::nullopt;
  // PLY, PCD, VTK: coordinates as 8-byte floats, for maps in national grid coordinates; 4-byte floats, which
  // every reader takes, hold 0.1 mm up to 1 km from the origin.
  bool double_precision = false;
};

// The scale over 1 to 99 % of the points, so that several files of one survey can share it. Error: a scan
// that cannot be had, cancelled.
Result<ColourScale> colourScale(const CloudForExport& cloud, CloudColour colour,
                                const JobControl& control = {});

// Writes beside `path` and renames when complete: on an Error (full disk, no permission, cancelled, a scan
// that cannot be had) the file that was there before is untouched and no other is left.
//
// A single scan whose `image` is a matrix stays one, unless normals are to be written: as organised PCD
// (HEIGHT = rows, cells without a point NaN, scan frame, the pose as VIEWPOINT), and as PLY with a range_grid
// and the pose in a comment (vertices in the world frame, which a comment tells). So does every scan in a PTX
// (cells without a point 0 0 0; intensity as it is, 0.5 where there is none) and the one of a .3d (at the
// origin; .pose beside it). Everything else holds points in the world frame. XYZ has no normals, 3D no
// colours.
Status writeCloud(const std::filesystem::path& path, const CloudForExport& cloud,
                  const WriteOptions& options = {}, const JobControl& control = {});

}  // namespace tiltmap
