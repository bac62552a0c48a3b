// The matrices of a project file: written once, line by line, and read on demand.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/project/project_file.h"
#include "core/scan/cell_mask.h"
#include "core/scan/range_image.h"

namespace tiltmap {

// What names a stored matrix at a moment: a matrix under capture gains lines, and lines not yet taken stand
// at their nominal tilt, which is the geometry's. So are the bounds of the range and the mask of
// the machine's body, where there are any.
struct MatrixKey {
  std::int64_t matrix = 0;
  int lines = 0;
  std::int64_t geometry = 0;  // 0 for a complete matrix without bounds and mask

  auto operator<=>(const MatrixKey&) const = default;
};

// Shared by a project and its snapshots, on a connection of its own, so that a worker may load while the
// writer writes. Any thread. A matrix stays in memory while somebody holds it, and the ones used last up to
// kKeptBytes. What is stored stays as it was measured: cells outside the geometry's bounds of the range are
// handed out as cell_code::kOutOfBounds, and those of the geometry's body mask as cell_code::kMasked.
class ImageStore {
 public:
  static constexpr std::size_t kKeptBytes = std::size_t{256} << 20;

  explicit ImageStore(const std::filesystem::path& path, std::size_t kept_bytes = kKeptBytes);

  Result<RangeImagePtr> image(std::int64_t matrix, int lines, std::int64_t geometry_id,
                              const ScannerGeometry& geometry);
  // Past the cache: what is in the file now.
  Result<RangeImagePtr> readImage(std::int64_t matrix, int lines, std::int64_t geometry_id,
                                  const ScannerGeometry& geometry);
  // Ids of geometries that have been compacted away may come again.
  void forget();
  Result<std::vector<unsigned char>> photograph(std::int64_t photograph);
  Result<std::vector<unsigned char>> attachment(std::int64_t attachment);
  const ReadingConnection& connection() const { return connection_; }
  std::mutex& mutex() { return mutex_; }

 private:
  struct Kept {
    MatrixKey key;
    RangeImagePtr image;
    std::size_t bytes = 0;
  };
  using CellMaskPtr = std::shared_ptr<const CellMask>;
  RangeImagePtr load(std::int64_t matrix, int lines, const ScannerGeometry& geometry,
                     const CellMaskPtr& mask) const;
  CellMaskPtr maskOf(std::int64_t geometry_id);
  void keep(const MatrixKey& key, const RangeImagePtr& image);

  std::mutex mutex_;
  ReadingConnection connection_;
  std::size_t kept_bytes_;
  std::size_t bytes_ = 0;
  std::list<Kept> kept_;  // the one used last in front
  std::map<MatrixKey, std::weak_ptr<const RangeImage>> known_;
  std::map<std::int64_t, CellMaskPtr> masks_;  // by geometry; null: none
};

// Stores the image (or, with none, the empty matrix of a capture) and gives its id.
std::int64_t writeMatrix(const Database& database, const RangeImage* image, const ScannerGeometry& geometry);

}  // namespace tiltmap
