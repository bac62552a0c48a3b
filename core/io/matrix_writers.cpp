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

// Calls `append` for every cell in order, which adds to `bytes`, and hands these over piece by piece.
template <class Append>
Status forCells(std::ostream& out, std::string& bytes, std::size_t cells, const std::string& file,
                const JobControl& control, Append append) {
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if ((cell & 8191U) == 0) {
      if (control.stopRequested()) return fail(kCancelled, file, "start again when you like");
      put(out, bytes);
      bytes.clear();
      if (!out) return {};  // whoever owns the file knows why
    }
    append(cell);
  }
  put(out, bytes);
  bytes.clear();
  return {};
}

Rgb colourOf(const ExportScan& scan, const Matrix& matrix, std::size_t cell, const PointColours& colours) {
  return colours.of(scan.world_from_scan * matrix.points[cell],
                    matrix.intensity.empty() ? 0.0F : matrix.intensity[cell], scan);
}

Status writePtxScan(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
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
        return fail(kCancelled, options.file, "start again when you like");
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
      if (options.colours.any())
        for (const std::uint8_t c : p.isZero(0.0) ? Rgb{} : colourOf(scan, matrix, cell, options.colours))
          text += ' ' + std::to_string(c);
      text += '\n';
    }
    put(out, text);
    if (!out) return {};
  }
  return {};
}

}  // namespace

Status writePtx(std::ostream& out, const CloudForExport& source, const MatrixOptions& options,
                const JobControl& control) {
  for (std::size_t i = 0; i < source.scans; ++i) {
    control.tell(static_cast<double>(i) / static_cast<double>(source.scans),
                 "writing scan " + std::to_string(i + 1));
    if (control.stopRequested()) return fail(kCancelled, options.file, "start again when you like");
    const auto scan = source.scan(i);
    if (!scan) return fail(scan.error());
    if (!scan->image && scan->cloud.empty())
      return fail("scan " + std::to_string(scan->index) + " has no points", options.file, "leave it out");
    if (auto written = writePtxScan(out, *scan, options, control); !written) return written;
  }
  return {};
}

Status writeOrganisedPcd(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                         const JobControl& control) {
  control.tell(0.0, "writing scan " + std::to_string(scan.index));
  const Matrix matrix(scan);
  const Eigen::Vector3d& t = scan.world_from_scan.translation();
  const Eigen::Quaterniond& q = scan.world_from_scan.quaternion();
  const bool intensity = !matrix.intensity.empty(), colour = options.colours.any();
  const std::string size = options.doubles ? " 8 8 8" : " 4 4 4";
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z";
  bytes += std::string(intensity ? " intensity" : "") + (colour ? " rgb" : "") + "\nSIZE" + size +
           (intensity ? " 4" : "") + (colour ? " 4" : "") + "\nTYPE F F F" + (intensity ? " F" : "") +
           (colour ? " F" : "") + "\nCOUNT 1 1 1" + (intensity ? " 1" : "") + (colour ? " 1" : "");
  bytes += "\nWIDTH " + std::to_string(matrix.columns) + "\nHEIGHT " + std::to_string(matrix.rows) +
           "\nVIEWPOINT " + words({t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) + "\nPOINTS " +
           std::to_string(matrix.points.size()) + "\nDATA binary\n";
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  return forCells(out, bytes, matrix.points.size(), options.file, control, [&](std::size_t cell) {
    const bool empty = matrix.points[cell].isZero(0.0);
    appendVector(bytes, empty ? none : matrix.points[cell], options.doubles);
    if (intensity) appendBytes(bytes, matrix.intensity[cell]);
    if (colour)
      appendBytes(bytes, packedColour(empty ? Rgb{} : colourOf(scan, matrix, cell, options.colours)));
  });
}

// The cells with a point as vertices in the world frame, so that every program shows them in their place; the
// matrix as a range_grid of their numbers, as Stanford's range scans and PCL have it; the pose in a comment,
// since PCL takes the points of a file with a camera element for points of the camera's frame.
Status writeOrganisedPly(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                         const JobControl& control) {
  control.tell(0.0, "writing scan " + std::to_string(scan.index));
  const Matrix matrix(scan);
  const bool intensity = !matrix.intensity.empty(), colour = options.colours.any();
  std::size_t count = 0;
  for (const Eigen::Vector3d& p : matrix.points) count += p.isZero(0.0) ? 0U : 1U;
  const Eigen::Vector3d& t = scan.world_from_scan.translation();
  const Eigen::Quaterniond& q = scan.world_from_scan.quaternion();
  const std::string real = options.doubles ? "double " : "float ";
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment tiltmap, metres, world frame\n";
  bytes += std::string("comment ") + kPlyPoseComment + " " +
           words({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) + "\n";
  bytes += "obj_info num_cols " + std::to_string(matrix.columns) + "\n";
  bytes += "obj_info num_rows " + std::to_string(matrix.rows) + "\n";
  bytes += "element vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z"}) bytes += "property " + real + name + "\n";
  if (intensity) bytes += "property float intensity\n";
  if (colour)
    for (const char* name : {"red", "green", "blue"}) bytes += std::string("property uchar ") + name + "\n";
  bytes += "element range_grid " + std::to_string(matrix.points.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto vertices =
      forCells(out, bytes, matrix.points.size(), options.file, control, [&](std::size_t cell) {
        if (matrix.points[cell].isZero(0.0)) return;
        appendVector(bytes, scan.world_from_scan * matrix.points[cell], options.doubles);
        if (intensity) appendBytes(bytes, matrix.intensity[cell]);
        if (colour)
          for (const std::uint8_t c : colourOf(scan, matrix, cell, options.colours)) appendBytes(bytes, c);
      });
  if (!vertices) return vertices;
  std::int32_t vertex = 0;
  return forCells(out, bytes, matrix.points.size(), options.file, control, [&](std::size_t cell) {
    const bool empty = matrix.points[cell].isZero(0.0);
    appendBytes(bytes, static_cast<std::uint8_t>(empty ? 0 : 1));
    if (!empty) appendBytes(bytes, vertex++);
  });
}

Status writeUos(std::ostream& out, const ExportScan& scan, const MatrixOptions& options,
                const JobControl& control) {
  control.tell(0.0, "writing scan " + std::to_string(scan.index));
  const Matrix matrix(scan);
  std::string text;
  return forCells(out, text, matrix.points.size(), options.file, control, [&](std::size_t cell) {
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
  });
}

}  // namespace tiltmap
