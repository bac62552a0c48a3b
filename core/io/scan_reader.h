// Reading other people's scan files. The range matrix is kept wherever the file has one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/scan/range_image.h"

namespace tiltmap {

enum class ScanFormat {
  Auto,  // by extension, else by what the file begins with
  Pcd,   // Point Cloud Library, ascii, binary, binary_compressed
  Uos,   // 3DTK .3d with its .pose: centimetres, left-handed
  Ply,   // Stanford polygon file, the vertices of it
  Ptx,   // Leica, one or several scans a file
  Vtk,   // legacy VTK, the points of a POLYDATA or UNSTRUCTURED_GRID
  Xyz,   // .xyz, .txt, .csv, .asc, .pts: columns of numbers, their meaning guessed and told in the warnings
};

// The words of the command line: auto, pcd, uos, ply, ptx, vtk, xyz; for ParameterTable::choice and for
// messages.
const std::vector<std::pair<std::string, ScanFormat>>& scanFormatNames();
std::string scanFormatName(ScanFormat format);

struct ReadOptions {
  ScanFormat format = ScanFormat::Auto;
  double minimum_range_m = 0.0;  // nearer cells become cell_code::kOutOfBounds: the machine's own body
  double maximum_range_m =
      0.0;  // further ones too: no return in files that write one as a far point; 0: no bound
};

// One scan as the file has it. `scan.odometry` equals `pose` where there is one and is the identity
// elsewhere.
struct ImportedScan {
  Scan scan;
  // world_from_scan as the file tells it: PCD VIEWPOINT or PTX matrix unless the identity, the .pose beside a
  // .3d.
  std::optional<Pose> pose;
};

struct ReadResult {
  std::vector<ImportedScan> scans;    // at least one; several only from PTX
  std::vector<std::string> warnings;  // what was left out or guessed, each with the file's name
};

// Reads one file. A matrix of the file (PCD with HEIGHT above 1, PTX, the regular grid of a tilted scanner in
// any point list) becomes a RangeImage of that size: with a regular ScannerGeometry and one tilt a line where
// those re-make every point within kGridTolerance, else with a direction per cell. Everything else becomes an
// unordered image of 1 x N. Cells that are NaN or at the origin get cell_code::kMissing, cells outside the
// bounds cell_code::kOutOfBounds.
//
// A file that is longer or shorter than its header says, or malformed in any other way, is an Error that
// names the file and the line or byte; so are a missing file and bounds that make no sense. Nothing is
// allocated by a count that the length of the file does not bear out. Cancelled through `control` (Error
// kCancelled).
Result<ReadResult> readScans(const std::filesystem::path& path, const ReadOptions& options,
                             const JobControl& control = {});

// A point of a regular grid may lie this far from where the file has it, metres.
inline constexpr double kGridTolerance = 1e-4;

}  // namespace tiltmap
