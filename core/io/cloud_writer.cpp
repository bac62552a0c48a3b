#include "core/io/cloud_writer.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <stdexcept>

#include "core/base/atomic_file.h"
#include "core/io/cloud_stream.h"
#include "core/io/pose_file.h"

namespace tiltmap {

namespace {

// The one scan of the export, for the formats that hold no more.
Result<ExportScan> onlyScan(const CloudForExport& cloud, const std::string& file) {
  if (cloud.scans != 1)
    return fail("a .3d file holds one scan, not " + std::to_string(cloud.scans), file,
                "write one file a scan (--per-scan), or choose ply, pcd, ptx, vtk, xyz or csv");
  auto scan = cloud.scan(0);
  if (scan && !scan->image && scan->cloud.empty())
    return fail("there are no points to write", file, "choose scans that hold points");
  return scan;
}

Status writeMerged(std::ostream& out, CloudFormat format, const CloudStream& stream) {
  switch (format) {
    case CloudFormat::Ply:
      return writePly(out, stream);
    case CloudFormat::Pcd:
      return writePcd(out, stream);
    case CloudFormat::Xyz:
      return writeXyz(out, stream);
    case CloudFormat::Csv:
      return writeCsv(out, stream);
    case CloudFormat::Vtk:
      return writeVtk(out, stream);
    case CloudFormat::Ptx:
    case CloudFormat::Uos:
      break;
  }
  throw std::logic_error("not a format of merged clouds");
}

}  // namespace

Result<CloudFormat> cloudFormatOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".ply") return CloudFormat::Ply;
  if (extension == ".pcd") return CloudFormat::Pcd;
  if (extension == ".xyz" || extension == ".txt" || extension == ".asc") return CloudFormat::Xyz;
  if (extension == ".csv") return CloudFormat::Csv;
  if (extension == ".ptx") return CloudFormat::Ptx;
  if (extension == ".vtk") return CloudFormat::Vtk;
  if (extension == ".3d") return CloudFormat::Uos;
  return fail("the name does not tell the format", path.string(),
              "end it in .ply, .pcd, .xyz, .txt, .asc, .csv, .ptx, .vtk or .3d");
}

CloudForExport cloudForExport(std::vector<ExportScan> scans) {
  CloudForExport cloud;
  cloud.scans = scans.size();
  for (const ExportScan& scan : scans) {
    cloud.intensity |=
        !scan.cloud.intensity.empty() || (scan.cloud.empty() && scan.image && scan.image->hasIntensity());
    cloud.normals |= !scan.cloud.normals.empty();
  }
  cloud.scan = [kept = std::make_shared<const std::vector<ExportScan>>(std::move(scans))](
                   std::size_t i) -> Result<ExportScan> { return kept->at(i); };
  return cloud;
}

Status writeCloud(const std::filesystem::path& path, const CloudForExport& cloud, const WriteOptions& options,
                  const JobControl& control) {
  CloudFormat format{};
  if (options.format) {
    format = *options.format;
  } else if (const auto named = cloudFormatOf(path)) {
    format = *named;
  } else {
    return fail(named.error());
  }
  const std::string file = path.string();
  if (cloud.scans == 0) return fail("there are no scans to write", file, "choose at least one scan");

  auto scale = options.scale;
  if (!scale) {
    const auto found =
        colourScale(cloud, format == CloudFormat::Uos ? CloudColour::None : options.colour, control);
    if (!found) return fail(found.error());
    scale = *found;
  }
  const MatrixOptions matrix{options.double_precision, PointColours(options.colour, *scale), file};

  if (format == CloudFormat::Uos) {
    const auto scan = onlyScan(cloud, file);
    if (!scan) return fail(scan.error());
    return writeFileAtomically(path, [&](std::ostream& out) -> Status {
      if (auto written = writeUos(out, *scan, matrix, control); !written || !out.flush()) return written;
      // The pose only when the points are complete, and before their file takes its name.
      auto pose_path = path;
      return writePose3dtk(pose_path.replace_extension(".pose"), scan->world_from_scan);
    });
  }
  if (format == CloudFormat::Ptx)
    return writeFileAtomically(path,
                               [&](std::ostream& out) { return writePtx(out, cloud, matrix, control); });
  if (cloud.scans == 1 && (format == CloudFormat::Pcd || format == CloudFormat::Ply)) {
    const auto scan = cloud.scan(0);
    if (!scan) return fail(scan.error());
    if (scan->image && scan->image->isMatrix() && !cloud.normals)
      return writeFileAtomically(path, [&](std::ostream& out) {
        return format == CloudFormat::Pcd ? writeOrganisedPcd(out, *scan, matrix, control)
                                          : writeOrganisedPly(out, *scan, matrix, control);
      });
  }
  const auto stream = CloudStream::prepare(cloud, options, matrix.colours, file, control);
  if (!stream) return fail(stream.error());
  return writeFileAtomically(path, [&](std::ostream& out) { return writeMerged(out, format, *stream); });
}

}  // namespace tiltmap
