// Clouds in the world frame, all scans in one: PLY, PCD, XYZ, CSV, VTK.
#include <stdexcept>

#include "core/io/cloud_stream.h"

namespace tiltmap {

namespace {

void put(std::ostream& out, const std::string& bytes) {
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void appendVector(std::string& bytes, const Eigen::Vector3d& v, bool doubles) {
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (doubles)
      appendBytes(bytes, v[k]);
    else
      appendBytes(bytes, static_cast<float>(v[k]));
  }
}

void appendText(std::string& line, const ExportPoint& point, const ExportLayout& layout, char separator,
                bool normals) {
  line.clear();
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (k > 0) line += separator;
    appendFixed(line, point.position[k], 5);
  }
  for (Eigen::Index k = 0; normals && k < 3; ++k) {
    line += separator;
    appendFixed(line, point.normal[k], 5);
  }
  if (layout.intensity) {
    line += separator;
    appendShortest(line, point.intensity);
  }
  for (std::size_t k = 0; layout.colour && k < 3; ++k) {
    line += separator;
    line += std::to_string(point.colour[k]);
  }
}

}  // namespace

Status writePly(std::ostream& out, const CloudStream& stream) {
  const ExportLayout& layout = stream.layout();
  const std::string real = layout.doubles ? "double" : "float";
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment tiltmap, metres, world frame\nelement vertex " +
      std::to_string(layout.points) + "\n";
  for (const char* name : {"x", "y", "z"}) bytes += "property " + real + " " + name + "\n";
  if (layout.normals)
    for (const char* name : {"nx", "ny", "nz"}) bytes += std::string("property float ") + name + "\n";
  if (layout.intensity) bytes += "property float intensity\n";
  if (layout.colour)
    for (const char* name : {"red", "green", "blue"}) bytes += std::string("property uchar ") + name + "\n";
  put(out, bytes + "property int scan\nend_header\n");
  return stream.forEach(out, [&](const ExportPoint& point) {
    bytes.clear();
    appendVector(bytes, point.position, layout.doubles);
    if (layout.normals) appendVector(bytes, point.normal, false);
    if (layout.intensity) appendBytes(bytes, point.intensity);
    if (layout.colour)
      for (const std::uint8_t c : point.colour) appendBytes(bytes, c);
    appendBytes(bytes, static_cast<std::int32_t>(point.scan));
    put(out, bytes);
  });
}

Status writePcd(std::ostream& out, const CloudStream& stream) {
  const ExportLayout& layout = stream.layout();
  const std::string size = layout.doubles ? " 8" : " 4";
  std::string fields = "FIELDS x y z", sizes = "SIZE" + size + size + size, types = "TYPE F F F",
              counts = "COUNT 1 1 1";
  const auto field = [&](const char* name, char type) {
    fields += std::string(" ") + name;
    sizes += " 4";
    types += std::string(" ") + type;
    counts += " 1";
  };
  if (layout.normals)
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) field(name, 'F');
  if (layout.intensity) field("intensity", 'F');
  if (layout.colour) field("rgb", 'F');
  field("scan", 'U');
  const std::string count = std::to_string(layout.points);
  put(out, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + fields + "\n" + sizes + "\n" +
               types + "\n" + counts + "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
               count + "\nDATA binary\n");
  std::string bytes;
  return stream.forEach(out, [&](const ExportPoint& point) {
    bytes.clear();
    appendVector(bytes, point.position, layout.doubles);
    if (layout.normals) appendVector(bytes, point.normal, false);
    if (layout.intensity) appendBytes(bytes, point.intensity);
    if (layout.colour) appendBytes(bytes, packedColour(point.colour));
    appendBytes(bytes, static_cast<std::uint32_t>(point.scan));
    put(out, bytes);
  });
}

Status writeXyz(std::ostream& out, const CloudStream& stream) {
  std::string line;
  return stream.forEach(out, [&](const ExportPoint& point) {
    appendText(line, point, stream.layout(), ' ', false);
    line += '\n';
    put(out, line);
  });
}

Status writeCsv(std::ostream& out, const CloudStream& stream) {
  const ExportLayout& layout = stream.layout();
  std::string line = "x,y,z";
  if (layout.normals) line += ",nx,ny,nz";
  if (layout.intensity) line += ",intensity";
  if (layout.colour) line += ",red,green,blue";
  put(out, line + ",scan\n");
  return stream.forEach(out, [&](const ExportPoint& point) {
    appendText(line, point, layout, ',', layout.normals);
    line += ',' + std::to_string(point.scan) + '\n';
    put(out, line);
  });
}

// Attribute by attribute, as the format wants it: the scans are gone through once for each.
Status writeVtk(std::ostream& out, const CloudStream& stream) {
  const ExportLayout& layout = stream.layout();
  if (layout.points > 1'000'000'000)  // cell entries are 32-bit
    return fail("a VTK file holds at most a thousand million points", "",
                "write several files, or reduced scans");
  const std::string count = std::to_string(layout.points);
  put(out, "# vtk DataFile Version 3.0\ntiltmap, metres, world frame\nBINARY\nDATASET POLYDATA\nPOINTS " +
               count + (layout.doubles ? " double\n" : " float\n"));
  std::string bytes;
  const auto section = [&](const std::string& title, auto append) -> Status {
    put(out, title);
    return stream.forEach(out, [&](const ExportPoint& point) {
      bytes.clear();
      append(point);
      put(out, bytes);
    });
  };
  const auto appendFloats = [&bytes](const Eigen::Vector3d& v) {
    for (Eigen::Index k = 0; k < 3; ++k) appendBigEndian(bytes, static_cast<float>(v[k]));
  };
  Status done = section("", [&](const ExportPoint& p) {
    if (!layout.doubles) return appendFloats(p.position);
    for (Eigen::Index k = 0; k < 3; ++k) appendBigEndian(bytes, p.position[k]);
  });
  if (!done) return done;
  put(out, "\nVERTICES " + count + " " + std::to_string(2 * layout.points) + "\n");
  done = stream.forIndices(out, [&](std::size_t i) {
    bytes.clear();
    appendBigEndian(bytes, std::int32_t{1});
    appendBigEndian(bytes, static_cast<std::int32_t>(i));
    put(out, bytes);
  });
  if (!done) return done;
  done = section("\nPOINT_DATA " + count + "\nSCALARS scan int 1\nLOOKUP_TABLE default\n",
                 [&](const ExportPoint& p) { appendBigEndian(bytes, static_cast<std::int32_t>(p.scan)); });
  if (done && layout.intensity)
    done = section("\nSCALARS intensity float 1\nLOOKUP_TABLE default\n",
                   [&](const ExportPoint& p) { appendBigEndian(bytes, p.intensity); });
  if (done && layout.colour)
    done = section("\nCOLOR_SCALARS colour 3\n", [&](const ExportPoint& p) {
      for (const std::uint8_t c : p.colour) appendBytes(bytes, c);
    });
  if (done && layout.normals)
    done = section("\nNORMALS normals float\n", [&](const ExportPoint& p) { appendFloats(p.normal); });
  put(out, "\n");
  return done;
}

}  // namespace tiltmap
