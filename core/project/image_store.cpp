#include "core/project/image_store.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/project/snapshot_reader.h"
#include "core/scan/beam_tilts.h"

namespace tiltmap {

// Blobs hold numbers as this machine does.
static_assert(std::endian::native == std::endian::little, "project files hold little-endian numbers");
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));

namespace {

StoreFailure damaged(const Database& database, std::int64_t matrix, const std::string& how) {
  return StoreFailure("matrix " + std::to_string(matrix) + " in the project is damaged: " + how,
                      database.path().string(), "go back to a copy of the project");
}

template <class T>
void copyCells(Bytes from, std::vector<T>& to, std::size_t first, std::size_t count) {
  std::memcpy(static_cast<void*>(to.data() + first), from.data(), count * sizeof(T));
}

// NULL for lines that were measured standing still.
std::optional<double> turnTilt(double way_rad) {
  return way_rad == 0.0 ? std::nullopt : std::optional(way_rad);
}

bool hasBounds(const ScannerGeometry& geometry) {
  return geometry.minimum_range_m > 0.0 || geometry.maximum_range_m > 0.0;
}

void applyBounds(const ScannerGeometry& geometry, RangeImageData& data) {
  if (!hasBounds(geometry)) return;
  for (std::size_t cell = 0; cell < data.cells(); ++cell) {
    const double range = static_cast<double>(data.range_m[cell]);
    const bool inside = range >= geometry.minimum_range_m &&
                        (geometry.maximum_range_m <= 0.0 || range <= geometry.maximum_range_m);
    if (cell_code::hasPoint(data.code[cell]) && !inside) data.code[cell] = cell_code::kOutOfBounds;
  }
}

std::size_t memoryOf(const RangeImage& image) {
  const RangeImageData& d = image.data();
  return d.range_m.size() * sizeof(float) + d.code.size() * sizeof(CellCode) +
         d.intensity.size() * sizeof(float) +
         (d.line_tilt_rad.size() + d.line_time_s.size()) * sizeof(double) +
         d.direction.size() * sizeof(Eigen::Vector3f);
}

}  // namespace

ImageStore::ImageStore(const std::filesystem::path& path, std::size_t kept_bytes)
    : connection_(path), kept_bytes_(kept_bytes) {}

Result<RangeImagePtr> ImageStore::image(std::int64_t matrix, int lines, std::int64_t geometry_id,
                                        const ScannerGeometry& geometry) {
  const std::lock_guard lock(mutex_);
  const auto mask = attempt([&] { return maskOf(geometry_id); });
  if (!mask) return fail(mask.error());
  const MatrixKey key{matrix, lines, lines < geometry.rows || hasBounds(geometry) || *mask ? geometry_id : 0};
  if (const auto found = known_.find(key); found != known_.end()) {
    if (RangeImagePtr image = found->second.lock()) {
      keep(key, image);
      return image;
    }
  }
  auto loaded = attempt([&] { return load(matrix, lines, geometry, *mask); });
  if (loaded) keep(key, *loaded);
  return loaded;
}

Result<RangeImagePtr> ImageStore::readImage(std::int64_t matrix, int lines, std::int64_t geometry_id,
                                            const ScannerGeometry& geometry) {
  const std::lock_guard lock(mutex_);
  masks_.erase(geometry_id);
  return attempt([&] { return load(matrix, lines, geometry, maskOf(geometry_id)); });
}

void ImageStore::forget() {
  const std::lock_guard lock(mutex_);
  kept_.clear();
  bytes_ = 0;
  known_.clear();
  masks_.clear();
}

ImageStore::CellMaskPtr ImageStore::maskOf(std::int64_t geometry_id) {
  if (const auto known = masks_.find(geometry_id); known != masks_.end()) return known->second;
  connection_.requireUnchanged();
  const Database& database = connection_.database();
  CellMaskPtr mask;
  if (const auto text = storedBodyMask(database, geometry_id))
    mask = std::make_shared<const CellMask>(orThrow(parseCellMask(*text, database.path().string())));
  masks_.emplace(geometry_id, mask);
  return mask;
}

Result<std::vector<unsigned char>> ImageStore::photograph(std::int64_t photograph) {
  const std::lock_guard lock(mutex_);
  return attempt([&] {
    connection_.requireUnchanged();
    Statement query = connection_.database().prepare(
        "SELECT data FROM attachment JOIN photograph ON attachment.id = attachment_id WHERE photograph.id = "
        "?");
    if (!query.bind(photograph).step())
      throw StoreFailure("the photograph is no longer in the project", connection_.database().path().string(),
                         "open the project again");
    const Bytes data = query.blob(0);
    return std::vector<unsigned char>(data.begin(), data.end());
  });
}

Result<std::vector<unsigned char>> ImageStore::attachment(std::int64_t attachment) {
  const std::lock_guard lock(mutex_);
  return attempt([&] {
    connection_.requireUnchanged();
    Statement query = connection_.database().prepare("SELECT data FROM attachment WHERE id = ?");
    if (!query.bind(attachment).step())
      throw StoreFailure("the picture is no longer in the project", connection_.database().path().string(),
                         "open the project again");
    const Bytes data = query.blob(0);
    return std::vector<unsigned char>(data.begin(), data.end());
  });
}

void ImageStore::keep(const MatrixKey& key, const RangeImagePtr& image) {
  for (auto entry = kept_.begin(); entry != kept_.end(); ++entry) {
    if (entry->key == key) {
      kept_.splice(kept_.begin(), kept_, entry);
      return;
    }
  }
  std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
  known_[key] = image;
  kept_.push_front({key, image, memoryOf(*image)});
  bytes_ += kept_.front().bytes;
  while (bytes_ > kept_bytes_ && kept_.size() > 1) {
    bytes_ -= kept_.back().bytes;
    kept_.pop_back();
  }
}

RangeImagePtr ImageStore::load(std::int64_t matrix, int lines, const ScannerGeometry& geometry,
                               const CellMaskPtr& mask) const {
  const Database& database = connection_.database();
  connection_.requireUnchanged();
  const Transaction transaction(database, Transaction::Kind::Read);
  Statement head = database.prepare(
      "SELECT rows, columns, has_intensity, has_direction, has_time FROM matrix WHERE id = ?");
  if (!head.bind(matrix).step())
    throw StoreFailure("the matrix is no longer in the project", database.path().string(),
                       "the project has been compacted since; open it again");
  RangeImageData data;
  data.rows = head.number(0);
  data.columns = head.number(1);
  if (data.rows < 1 || data.columns < 1 || static_cast<long long>(data.rows) * data.columns > 100'000'000)
    throw damaged(database, matrix, "its size is impossible");
  const std::size_t cells = data.cells();
  const auto columns = static_cast<std::size_t>(data.columns);
  const bool has_intensity = !head.isNull(2) && head.integer(2) != 0;
  const bool has_direction = head.integer(3) != 0, has_time = head.integer(4) != 0;
  data.range_m.assign(cells, 0.0F);
  data.code.assign(cells, cell_code::kNotScanned);
  if (has_intensity) data.intensity.assign(cells, 0.0F);
  if (has_direction) data.direction.assign(cells, Eigen::Vector3f::Zero());
  if (has_time) data.line_time_s.assign(static_cast<std::size_t>(data.rows), 0.0);
  for (int row = 0; row < data.rows; ++row) data.line_tilt_rad.push_back(geometry.tiltOfRow(row));

  // By id: the first `lines` lines that were stored, so that a snapshot of a capture does not grow.
  Statement query = database.prepare(
      "SELECT row, tilt_rad, time_s, range_m, code, intensity, direction, turn_tilt_rad FROM scan_line WHERE "
      "matrix_id = ?1 AND id IN "
      "(SELECT id FROM scan_line WHERE matrix_id = ?1 ORDER BY id LIMIT ?2)");
  query.bind(matrix, lines);
  std::vector<double> turn_tilts(static_cast<std::size_t>(data.rows), 0.0);
  int found = 0;
  while (query.step()) {
    const int row = query.number(0);
    if (row < 0 || row >= data.rows) throw damaged(database, matrix, "it has a line " + std::to_string(row));
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    if (query.blob(3).size() != columns * sizeof(float) ||
        query.blob(4).size() != columns * sizeof(CellCode) ||
        (has_intensity && query.blob(5).size() != columns * sizeof(float)) ||
        (has_direction && query.blob(6).size() != columns * sizeof(Eigen::Vector3f)))
      throw damaged(database, matrix, "line " + std::to_string(row) + " has the wrong length");
    data.line_tilt_rad[static_cast<std::size_t>(row)] = query.real(1);
    if (!query.isNull(7)) turn_tilts[static_cast<std::size_t>(row)] = query.real(7);
    if (has_time) data.line_time_s[static_cast<std::size_t>(row)] = query.real(2);
    copyCells(query.blob(3), data.range_m, first, columns);
    copyCells(query.blob(4), data.code, first, columns);
    if (has_intensity) copyCells(query.blob(5), data.intensity, first, columns);
    if (has_direction) copyCells(query.blob(6), data.direction, first, columns);
    ++found;
  }
  if (found != lines)
    throw damaged(database, matrix, std::to_string(lines - found) + " of its lines are missing");
  setTurnTilts(data, turn_tilts);
  applyBounds(geometry, data);
  if (mask && !maskCells(*mask, data))
    throw damaged(database, matrix, "the mask of the machine's body has another size");
  auto image = RangeImage::make(std::move(data));
  if (!image) throw damaged(database, matrix, image.error().what);
  return *image;
}

std::int64_t writeMatrix(const Database& database, const RangeImage* image, const ScannerGeometry& geometry) {
  const auto insert = [&](int rows, int columns, std::optional<bool> intensity, bool direction, bool time,
                          int lines, std::size_t valid) {
    database.run(
        "INSERT INTO matrix(rows, columns, has_intensity, has_direction, has_time, lines, valid_cells) "
        "VALUES (?, ?, ?, ?, ?, ?, ?)",
        rows, columns, intensity, direction, time, lines, valid);
    return database.lastInsertId();
  };
  // Whether a capture has intensities its first line will tell.
  if (!image) return insert(geometry.rows, geometry.columns, std::nullopt, false, true, 0, 0);

  const RangeImageData& data = image->data();
  const std::int64_t matrix = insert(data.rows, data.columns, image->hasIntensity(), !image->isRegular(),
                                     image->hasTimes(), data.rows, image->validCells());
  Statement line = database.prepare(
      "INSERT INTO scan_line(matrix_id, row, tilt_rad, time_s, range_m, code, intensity, direction, "
      "turn_tilt_rad) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  const auto columns = static_cast<std::size_t>(data.columns);
  for (int row = 0; row < data.rows; ++row) {
    const std::size_t first = static_cast<std::size_t>(row) * columns;
    std::optional<Bytes> intensity, direction;
    if (image->hasIntensity()) intensity = bytesOf(data.intensity.data() + first, columns);
    if (!image->isRegular())
      direction = Bytes(reinterpret_cast<const unsigned char*>(data.direction.data() + first),
                        columns * sizeof(Eigen::Vector3f));
    line.run(matrix, row, image->lineTilt(row),
             image->hasTimes() ? image->lineTime(row) : std::numeric_limits<double>::quiet_NaN(),
             bytesOf(data.range_m.data() + first, columns), bytesOf(data.code.data() + first, columns),
             intensity, direction, turnTilt(lineTurnTilt(*image, row)));
  }
  return matrix;
}

}  // namespace tiltmap
