#include "core/scan/point_cloud.h"

namespace tiltmap {

PointCloud cloudOf(const RangeImage& image, const ScannerGeometry& geometry) {
  const std::vector<Eigen::Vector3d> all = cellPoints(image, geometry);
  PointCloud cloud;
  cloud.points.reserve(image.validCells());
  cloud.cell.reserve(image.validCells());
  if (image.hasIntensity()) cloud.intensity.reserve(image.validCells());
  for (std::size_t cell = 0; cell < image.cells(); ++cell) {
    if (!image.hasPoint(cell)) continue;
    cloud.points.push_back(all[cell]);
    cloud.cell.push_back(static_cast<std::uint32_t>(cell));
    if (image.hasIntensity()) cloud.intensity.push_back(image.intensity(cell));
  }
  return cloud;
}

}  // namespace tiltmap
