// Any bytes, read as one format: read or refused, and what is read keeps what readScans promises.
#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include "core/io/point_table.h"

namespace {

void require(bool held) {
  if (!held) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tiltmap;
  if (size == 0) return 0;  // fileBytes refuses it
  const JobControl control;
  std::vector<std::string> warnings;
  const ParseContext context{"the file", control, warnings};
  auto tables =
      parseAs(ScanFormat::TILTMAP_FUZZED_FORMAT, {reinterpret_cast<const char*>(data), size}, context);
  if (!tables) {
    require(tables.error().where.starts_with("the file") && !tables.error().what.empty());
    return 0;
  }
  require(!tables->empty());
  for (PointTable& table : *tables) {
    // No more points than bytes: nothing is made up.
    require(table.points.size() <= size);
    const auto scan = assembleScan(std::move(table), {ScanFormat::Auto, 0.1, 1000.0}, "the file", context);
    if (!scan) continue;
    require(scan->scan.geometry.check().has_value() && scan->scan.odometry.isFinite());
    for (const Eigen::Vector3d& p : cellPoints(*scan->scan.image, scan->scan.geometry))
      require(p.allFinite());
  }
  return 0;
}
