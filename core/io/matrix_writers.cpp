// Files that keep the range matrix and the pose: PTX, organised PCD and PLY, 3DTK .3d.
#include <limits>

#include "core/base/text.h"
#include "core/io/cloud_stream.h"
#include "core/io/pose_file.h"

namespace tiltmap {

namespace {

void put(std::ostream& out, const std::string& bytes) {
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string words(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + shortestReal(value);
  return text;
}

void appendVector(std::string& bytes, const Eigen::Vector3d& v, bool doubles) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (doubles)
      appendBytes(bytes, v[k]);
    else
      appendBytes(bytes, static_cast<float>(v[k]));
  }
}

// A reduced or unordered scan has no matrix to keep: one column of its points, so that pose and intensity are
// kept.
struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::vector<Eigen::Vector3d> points;
  std::vector<float> intensity;

  explicit Matrix(const ExportScan& scan) {
    if (!scan.image) {
      rows = scan.cloud.size();
      columns = 1;
      points = scan.cloud.points;
      intensity = scan.cloud.intensity;
      return;
    }
    rows = static_cast<std::size_t>(scan.image->rows());
    columns = static_cast<std::size_t>(scan.image->columns());
    points = cellPoints(*scan.image, scan.geometry);  // zero where there is none
    intensity = scan.image->data().intensity;
  }
};

Status writePtxScan(std::ostream& out, const ExportScan& scan, const std::string& file,
                    const JobControl& control) {
  const Matrix matrix(scan);
  const Eigen::Matrix3d r = scan.world_from_scan.rotation();
  const Eigen::Vector3d& t = scan.world_from_scan.translation();
  std::string text = std::to_string(matrix.columns) + "\n" + std::to_string(matrix.rows) + "\n" +
                     words({t.x(), t.y(), t.z()}) + "\n";
  // The axes a line each, then the matrix that acts on row vectors: its rows are our columns, the last the
  // position.
  for (Eigen::Index k = 0; k < 3; ++k) text += words({r(0, k), r(1, k), r(2, k)}) + "\n";
  for (Eigen::Index k = 0; k < 3; ++k) text += words({r(0, k), r(1, k), r(2, k), 0.0}) + "\n";
  text += words({t.x(), t.y(), t.z(), 1.0}) + "\n";
  put(out, text);
  // Column by column, each from the first row on: lower rows first, as our tilt begins below.
  for (std::size_t column = 0; column < matrix.columns; ++column) {
    text.clear();
    for (std::size_t row = 0; row < matrix.rows; ++row) {
      if ((row & 8191U) == 0 && control.stopRequested())
        return fail(kCancelled, file, "start again when you like");
      const std::size_t cell = row * matrix.columns + column;
      const Eigen::Vector3d& p = matrix.points[cell];
      if (p.isZero(0.0)) {
        text += "0 0 0 ";
      } else {
        for (Eigen::Index k = 0; k < 3; ++k) {
          appendFixed(text, p[k], 6);
          text += ' ';
        }
      }
      appendShortest(text, matrix.intensity.empty() ? 0.5F : matrix.intensity[cell]);
      text += '\n';
    }
    put(out, text);
    if (!out) return {};
  }
  return {};
}

}  // namespace

Status writePtx(std::ostream& out, const CloudForExport& source, const std::string& file,
                const JobControl& control) {
  for (std::size_t i = 0; i < source.scans; ++i) {
    control.tell(static_cast<double>(i) / static_cast<double>(source.scans),
                 "writing scan " + std::to_string(i + 1));
    if (control.stopRequested()) return fail(kCancelled, file, "start again when you like");
    const auto scan = source.scan(i);
    if (!scan) return fail(scan.error());
    if (!scan->image && scan->cloud.empty())
      return fail("scan " + std::to_string(scan->index) + " has no points", file, "leave it out");
    if (auto written = writePtxScan(out, *scan, file, control); !written) return written;
  }
  return {};
}

Status writeOrganisedPcd(std::ostream& out, const ExportScan& scan, bool doubles) {
  const Matrix matrix(scan);
  const Eigen::Vector3d& t = scan.world_from_scan.translation();
  const Eigen::Quaterniond& q = scan.world_from_scan.quaternion();
  const bool intensity = !matrix.intensity.empty();
  const std::string size = doubles ? " 8 8 8" : " 4 4 4";
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z";
  bytes += intensity ? " intensity\nSIZE" + size + " 4\nTYPE F F F F\nCOUNT 1 1 1 1"
                     : "\nSIZE" + size + "\nTYPE F F F\nCOUNT 1 1 1";
  bytes += "\nWIDTH " + std::to_string(matrix.columns) + "\nHEIGHT " + std::to_string(matrix.rows) +
           "\nVIEWPOINT " + words({t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) + "\nPOINTS " +
           std::to_string(matrix.points.size()) + "\nDATA binary\n";
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t cell = 0; cell < matrix.points.size(); ++cell) {
    appendVector(bytes, matrix.points[cell].isZero(0.0) ? none : matrix.points[cell], doubles);
    if (intensity) appendBytes(bytes, matrix.intensity[cell]);
  }
  put(out, bytes);
  return {};
}

// The cells with a point as vertices in the world frame, so that every program shows them in their place; the
// matrix as a range_grid of their numbers, as Stanford's range scans and PCL have it; the pose in a comment,
// since PCL takes the points of a file with a camera element for points of the camera's frame.
Status writeOrganisedPly(std::ostream& out, const ExportScan& scan, bool doubles) {
  const Matrix matrix(scan);
  const bool intensity = !matrix.intensity.empty();
  std::size_t count = 0;
  for (const Eigen::Vector3d& p : matrix.points) count += p.isZero(0.0) ? 0U : 1U;
  const Eigen::Vector3d& t = scan.world_from_scan.translation();
  const Eigen::Quaterniond& q = scan.world_from_scan.quaternion();
  const std::string real = doubles ? "double " : "float ";
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment tiltmap, metres, world frame\n";
  bytes += std::string("comment ") + kPlyPoseComment + " " +
           words({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) + "\n";
  bytes += "obj_info num_cols " + std::to_string(matrix.columns) + "\n";
  bytes += "obj_info num_rows " + std::to_string(matrix.rows) + "\n";
  bytes += "element vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z"}) bytes += "property " + real + name + "\n";
  if (intensity) bytes += "property float intensity\n";
  bytes += "element range_grid " + std::to_string(matrix.points.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t cell = 0; cell < matrix.points.size(); ++cell) {
    if (matrix.points[cell].isZero(0.0)) continue;
    appendVector(bytes, scan.world_from_scan * matrix.points[cell], doubles);
    if (intensity) appendBytes(bytes, matrix.intensity[cell]);
  }
  std::int32_t vertex = 0;
  for (const Eigen::Vector3d& p : matrix.points) {
    appendBytes(bytes, static_cast<std::uint8_t>(p.isZero(0.0) ? 0 : 1));
    if (!p.isZero(0.0)) appendBytes(bytes, vertex++);
  }
  put(out, bytes);
  return {};
}

Status writeUos(std::ostream& out, const ExportScan& scan) {
  const Matrix matrix(scan);
  std::string text;
  for (std::size_t cell = 0; cell < matrix.points.size(); ++cell) {
    const Eigen::Vector3d p = pointTo3dtk(matrix.points[cell]);
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (k > 0) text += ' ';
      appendFixed(text, p[k], 4);
    }
    if (!matrix.intensity.empty()) {
      text += ' ';
      appendShortest(text, matrix.intensity[cell]);
    }
    text += '\n';
  }
  put(out, text);
  return {};
}

}  // namespace tiltmap
