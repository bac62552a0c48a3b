#include "core/registration/prepared_scan.h"

#include <chrono>
#include <stdexcept>

#include "core/registration/block_patches.h"
#include "core/registration/cube_patches.h"
#include "core/scan/filters.h"
#include "core/scan/normals.h"
#include "core/scan/reduction.h"

namespace tiltmap {

namespace {

constexpr double kBucket_rad = 3.0 * kDegree;
constexpr double kWideBucket_rad = 9.0 * kDegree;
constexpr std::size_t kRangeSample = 7;  // one cell in so many tells the median range; a prime

MedianFilterSettings filterSettings(const RegistrationSettings& settings) {
  MedianFilterSettings filter;
  filter.window = settings.filter;
  filter.threshold_m = settings.filter_threshold_m;
  filter.one_sided = settings.filter_one_sided;
  filter.include_centre = settings.filter_include_centre;
  filter.no_return_votes = settings.filter_no_return_votes;
  return filter;
}

// Normals one a cell, also where the image is an unordered cloud.
std::vector<Eigen::Vector3d> cellNormals(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                                         const RegistrationSettings& settings) {
  if (image.isMatrix()) return matrixNormals(image, points);
  std::vector<Eigen::Vector3d> valid;
  valid.reserve(image.validCells());
  for (std::size_t cell = 0; cell < image.cells(); ++cell)
    if (image.hasPoint(cell)) valid.push_back(points[cell]);
  const std::vector<Eigen::Vector3d> found =
      cloudNormals(valid, settings.normal_neighbours, Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3d> normals(image.cells(), Eigen::Vector3d::Zero());
  std::size_t next = 0;
  for (std::size_t cell = 0; cell < image.cells(); ++cell)
    if (image.hasPoint(cell)) normals[cell] = found[next++];
  return normals;
}

PointCloud fullCloud(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                     const std::vector<Eigen::Vector3d>& normals) {
  PointCloud cloud;
  for (std::size_t cell = 0; cell < image.cells(); ++cell) {
    if (!image.hasPoint(cell)) continue;
    cloud.points.push_back(points[cell]);
    cloud.normals.push_back(normals[cell]);
    cloud.cell.push_back(static_cast<std::uint32_t>(cell));
  }
  return cloud;
}

SurfaceElements pointElements(const RangeImage& image, const std::vector<Eigen::Vector3d>& points,
                              const RegistrationSettings& settings) {
  const std::vector<Eigen::Vector3d> normals = cellNormals(image, points, settings);
  PointCloud cloud;
  switch (settings.reduction) {
    case Reduction::Line:
      cloud = reducedAlongLines(image, points, normals, settings.reduction_distance_m);
      break;
    case Reduction::Voxel:
      cloud = voxelReduced(fullCloud(image, points, normals), settings.reduction_distance_m);
      break;
    default:
      cloud = fullCloud(image, points, normals);
      break;
  }
  SurfaceElements elements;
  elements.position = std::move(cloud.points);
  elements.normal = std::move(cloud.normals);
  elements.cell = std::move(cloud.cell);
  if (elements.normal.empty()) elements.normal.assign(elements.size(), Eigen::Vector3d::Zero());
  return elements;
}

// Whether to cut the scan into blocks of cells.
bool takesBlocks(const RangeImage& image, const RegistrationSettings& settings) {
  if (settings.reduction != Reduction::Patches || !image.isMatrix()) return false;
  if (settings.patch_grouping != PatchGrouping::Auto) return settings.patch_grouping == PatchGrouping::Blocks;
  std::size_t points = 0, near = 0;
  for (std::size_t cell = 0; cell < image.cells(); cell += kRangeSample) {
    if (!image.hasPoint(cell)) continue;
    ++points;
    if (static_cast<double>(image.range(cell)) < settings.patch_near_m) ++near;
  }
  return 2 * near < points;
}

std::vector<PatchDisc> discsOf(const SurfaceElements& patches) {
  constexpr double kEdge = 1.7;  // a uniform patch ends at 3^(1/2) deviations
  std::vector<PatchDisc> discs(patches.size());
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const Eigen::Vector3f p = patches.position[i].cast<float>(), n = patches.normal[i].cast<float>();
    const PatchShape& shape = patches.shape[i];
    const Eigen::Vector3f u = shape.u.cast<float>(), v = shape.v.cast<float>();
    discs[i] = {p.x(),
                p.y(),
                p.z(),
                n.x(),
                n.y(),
                n.z(),
                u.x(),
                u.y(),
                u.z(),
                v.x(),
                v.y(),
                v.z(),
                static_cast<float>(kEdge * shape.extent_u_m),
                static_cast<float>(kEdge * shape.extent_v_m),
                static_cast<float>(shape.offset_variance_m2)};
  }
  return discs;
}

// Elements and what they are found by.
void derive(const RangeImage& image, const ScannerGeometry& geometry, const RegistrationSettings& settings,
            PreparedScan& prepared) {
  const bool projective = settings.pair_choice == PairChoice::Projective;
  if (takesBlocks(image, settings)) {
    BlockPatches blocks = blockPatches(image, geometry, settings);
    prepared.elements = std::move(blocks.elements);
    if (projective) {
      prepared.raster = std::move(blocks.raster);
      prepared.discs = discsOf(prepared.elements);
      prepared.cells = std::move(blocks.cells);
      prepared.spot_rad = blocks.spot_rad;
    }
  } else {
    const std::vector<Eigen::Vector3d> points = cellPoints(image, geometry);
    prepared.elements = settings.reduction == Reduction::Patches ? cubePatches(image, points, settings)
                                                                 : pointElements(image, points, settings);
  }
  addSearch(settings, prepared);
}

}  // namespace

void addSearch(const RegistrationSettings& settings, PreparedScan& prepared) {
  if (prepared.elements.empty()) return;
  if (settings.pair_choice != PairChoice::Projective) {
    prepared.tree.emplace(prepared.elements.position);
  } else if (!prepared.raster) {
    const SurfaceElements& elements = prepared.elements;
    prepared.directions.emplace(elements.position, kBucket_rad, elements.normal);
    prepared.wide_directions.emplace(elements.position, kWideBucket_rad, elements.normal);
  }
}

PreparedScanPtr prepare(const Scan& scan, const RegistrationSettings& settings) {
  if (const Status status = checkSettings(settings); !status)
    throw std::invalid_argument(status.error().what);
  if (!scan.image) throw std::invalid_argument("prepare: the scan has no range image");
  const auto begin = std::chrono::steady_clock::now();
  auto prepared = std::make_shared<PreparedScan>();
  prepared->scan = scan;
  RangeImagePtr image = scan.image;
  prepared->raw_points = image->validCells();
  if (settings.filter != MedianWindow::None) {
    if (image->isMatrix()) {
      FilteredImage filtered = medianFiltered(image, filterSettings(settings));
      image = std::move(filtered.image);
      prepared->filter_changes = filtered.changes.size();
    } else {
      prepared->warnings.emplace_back("the scan is no matrix, so the median filter was not applied");
    }
  }
  if (image->validCells() > 0) derive(*image, scan.geometry, settings, *prepared);
  prepared->milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return prepared;
}

}  // namespace tiltmap
