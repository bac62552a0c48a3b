// The points of an export, scan by scan, in the world frame: what the writers of merged clouds share.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <ostream>
#include <span>
#include <string>

#include <Eigen/Core>

#include "core/io/cloud_writer.h"

namespace tiltmap {

struct ExportPoint {
  Eigen::Vector3d position;  // metres
  Eigen::Vector3d normal;    // zero where there is none
  float intensity = 0.0F;
  int scan = 0;
  std::array<std::uint8_t, 3> colour{};
};

using Rgb = std::array<std::uint8_t, 3>;

// The colour of a point, as CloudColour has it.
class PointColours {
 public:
  PointColours(CloudColour colour, ColourScale scale) : colour_(colour), scale_(scale) {}

  bool any() const { return colour_ != CloudColour::None; }
  Rgb of(const Eigen::Vector3d& in_world, float intensity, const ExportScan& scan) const;

 private:
  CloudColour colour_;
  ColourScale scale_;
};

// What the records of a file hold beside x y z and the scan's index.
struct ExportLayout {
  std::size_t points = 0;
  bool normals = false;
  bool intensity = false;
  bool colour = false;
  bool doubles = false;
};

// Goes through the export once to count, then as often as the format needs.
class CloudStream {
 public:
  // `source` and `control` must outlive this. Error: no points, a scan that cannot be had, cancelled.
  static Result<CloudStream> prepare(const CloudForExport& source, const WriteOptions& options,
                                     const PointColours& colours, const std::string& file,
                                     const JobControl& control);

  const ExportLayout& layout() const { return layout_; }
  // Calls `use` for every point. Error: as above, the stream gone bad (what says why comes from the file's
  // owner), or not the number of points that were counted.
  Status forEach(const std::ostream& out, const std::function<void(const ExportPoint&)>& use) const;
  // For writing all but the points: polls for cancellation while `use` is called with 0, 1, 2, ...
  Status forIndices(const std::ostream& out, const std::function<void(std::size_t)>& use) const;
  Error cancelled() const;

 private:
  CloudStream(const CloudForExport& source, const PointColours& colours, std::string file,
              const JobControl& control)
      : source_(source), colours_(colours), file_(std::move(file)), control_(control) {}
  Status count();

  const CloudForExport& source_;
  PointColours colours_;
  std::string file_;
  const JobControl& control_;
  ExportLayout layout_;
};

// The cloud of a scan to be exported: the one given, else the cells of its matrix.
PointCloud exportedCloud(const ExportScan& scan);

// Numbers into buffers, without a locale and fast.
void appendFixed(std::string& text, double value, int decimals);
void appendShortest(std::string& text, float value);
template <class T>
void appendBytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
template <class T>
void appendBigEndian(std::string& bytes, T value) {
  const char* at = reinterpret_cast<const char*>(&value);
  for (std::size_t i = sizeof(value); i-- > 0;) bytes += at[i];
}

// Before world_from_scan as x y z qx qy qz qw, in a PLY whose vertices lie in the world frame.
inline constexpr const char* kPlyPoseComment = "tiltmap world_from_scan";

// One per kind of file; `out` is a binary stream at its beginning.
Status writePly(std::ostream& out, const CloudStream& stream);
Status writePcd(std::ostream& out, const CloudStream& stream);
Status writeXyz(std::ostream& out, const CloudStream& stream);
Status writeCsv(std::ostream& out, const CloudStream& stream);
Status writeVtk(std::ostream& out, const CloudStream& stream);
// Of scans that keep their matrix, in the scan's frame.
struct MatrixOptions {
  bool doubles = false;  // as in WriteOptions
  PointColours colours{CloudColour::None, {}};
  std::string file;
};
Status writePtx(std::ostream& out, const CloudForExport& source, const MatrixOptions& options,
                const JobControl& control);
Status writeOrganisedPcd(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                         const JobControl& control);
Status writeOrganisedPly(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                         const JobControl& control);
Status writeUos(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                const JobControl& control);
// PCL's way to put a colour into a float: the bytes 0 r g b of a 32-bit word.
float packedColour(const Rgb& colour);

}  // namespace tiltmap
