// Lines of a capture, copies, compaction, verification.
#include <cmath>

#include <sqlite3.h>

#include "core/project/moving_line.h"
#include "core/project/project_file.h"
#include "core/project/project_state.h"
#include "core/project/schema.h"

namespace tiltmap {

namespace fs = std::filesystem;

namespace {

// Ranges as they are stored: 0 where there is no point.
std::vector<float> checkedRanges(const ScanLine& line, std::size_t columns, const std::string& where) {
  const auto refuse = [&](const std::string& what) {
    throw StoreFailure(what, where, "check the scanner's driver");
  };
  if (line.range_m.size() != columns + (turnTiltOf(line) != 0.0 ? 1 : 0) || line.code.size() != columns ||
      (!line.intensity.empty() && line.intensity.size() != columns))
    refuse("the line is not " + std::to_string(columns) + " cells wide");
  if (!std::isfinite(line.tilt_rad) || !std::isfinite(line.time_s) || !std::isfinite(turnTiltOf(line)))
    refuse("the line's tilt or time is not finite");
  std::vector<float> ranges(line.range_m.begin(),
                            line.range_m.begin() + static_cast<std::ptrdiff_t>(columns));
  for (std::size_t i = 0; i < columns; ++i) {
    if (!cell_code::hasPoint(line.code[i])) {
      ranges[i] = 0.0F;
    } else if (!(ranges[i] > 0.0F) || !std::isfinite(ranges[i])) {
      refuse("cell " + std::to_string(i) + " of the line claims a point but has no positive range");
    }
  }
  return ranges;
}

struct MatrixHead {
  int rows = 0;
  std::size_t columns = 0;
  std::optional<bool> has_intensity;  // not known before the first line
  bool has_direction = false;
};

MatrixHead matrixHead(const Database& database, std::int64_t matrix) {
  Statement query =
      database.prepare("SELECT rows, columns, has_intensity, has_direction FROM matrix WHERE id = ?");
  if (!query.bind(matrix).step())
    throw StoreFailure("the matrix is no longer in the project", database.path().string(),
                       "open the project again");
  MatrixHead head{query.number(0), static_cast<std::size_t>(query.number(1)), std::nullopt,
                  query.integer(3) != 0};
  if (!query.isNull(2)) head.has_intensity = query.integer(2) != 0;
  return head;
}

void storeLine(const Database& database, std::int64_t matrix, int row, const ScanLine& line,
               const std::string& where) {
  const MatrixHead head = matrixHead(database, matrix);
  const bool intensity = !line.intensity.empty();
  if (row < 0 || row >= head.rows)
    throw StoreFailure("the matrix has no line " + std::to_string(row), where,
                       "its lines are 0 to " + std::to_string(head.rows - 1));
  if (head.has_direction)
    throw StoreFailure("the matrix has a direction for each cell and takes no lines", where,
                       "add a new scan");
  if (head.has_intensity && *head.has_intensity != intensity)
    throw StoreFailure("the line and the ones before differ in having intensities", where,
                       "give intensities for every line of a scan or for none");
  if (database.integer("SELECT id FROM scan_line WHERE matrix_id = ? AND row = ?", matrix, row))
    throw StoreFailure("line " + std::to_string(row) + " has been stored already", where,
                       "a measured line is never overwritten; start a new scan");
  const std::vector<float> ranges = checkedRanges(line, head.columns, where);
  std::optional<Bytes> intensities;
  if (intensity) intensities = bytesOf(line.intensity.data(), head.columns);
  std::size_t valid = 0;
  for (const CellCode code : line.code) valid += cell_code::hasPoint(code) ? 1 : 0;
  const double turn_tilt = turnTiltOf(line);
  database.run(
      "INSERT INTO scan_line(matrix_id, row, tilt_rad, time_s, range_m, code, intensity, turn_tilt_rad) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
      matrix, row, line.tilt_rad, line.time_s, bytesOf(ranges.data(), head.columns),
      bytesOf(line.code.data(), head.columns), intensities,
      turn_tilt == 0.0 ? std::nullopt : std::optional(turn_tilt));
  database.run(
      "UPDATE matrix SET lines = lines + 1, valid_cells = valid_cells + ?, has_intensity = ? WHERE id = ?",
      valid, intensity, matrix);
}

// All pages of `from` into the new file.
void copyPages(const Database& from, const fs::path& to) {
  const Database target(to, Database::Mode::Create);
  target.execute("PRAGMA synchronous = OFF");  // brought to the disk as a whole before anybody sees it
  sqlite3_backup* backup = sqlite3_backup_init(target.handle(), "main", from.handle(), "main");
  if (!backup) throw StoreFailure(sqliteError(target, sqlite3_errcode(target.handle())));
  sqlite3_backup_step(backup, -1);
  const int code = sqlite3_backup_finish(backup);
  if (code != SQLITE_OK) throw StoreFailure(sqliteError(target, code));
  target.execute("PRAGMA journal_mode = WAL");
}

std::uintmax_t bytesOnDisk(const fs::path& path) {
  std::uintmax_t sum = 0;
  for (const char* suffix : {"", "-wal"}) {
    fs::path file = path;
    file += suffix;
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (!error) sum += size;
  }
  return sum;
}

// Rows that nothing refers to once the journal is gone. Returns how many matrices went.
int dropUnreferenced(const Database& database) {
  database.execute(
      "DELETE FROM edit WHERE state = 'undone';"
      "UPDATE edit SET state = 'fixed', changeset = NULL WHERE state = 'done';"
      "DELETE FROM scan_line WHERE matrix_id NOT IN (SELECT matrix_id FROM scan);"
      "DELETE FROM attachment WHERE id NOT IN (SELECT attachment_id FROM photograph WHERE attachment_id IS "
      "NOT NULL) AND id NOT IN (SELECT CAST(value AS INTEGER) FROM survey WHERE key = "
      "'site_picture_attachment');"
      "DELETE FROM scanner_geometry WHERE id NOT IN (SELECT geometry_id FROM scan);");
  database.execute("DELETE FROM matrix WHERE id NOT IN (SELECT matrix_id FROM scan)");
  return static_cast<int>(database.integer("SELECT changes()").value_or(0));
}

}  // namespace

Status Project::appendLine(ScanId scan, int row, const ScanLine& line) {
  return attempt([&] {
    const Database& database = state_->requireWriter();
    const SnapshotPtr before = state_->current();
    const ScanEntry* entry = before->find(scan);
    if (!entry)
      throw StoreFailure("there is no scan with id " + std::to_string(scan) + " in the project",
                         state_->path.string(), "add the scan first");
    Transaction transaction(database, Transaction::Kind::Write);
    state_->requireOwnRevision(database);
    storeLine(database, entry->matrix, row, line, "scan " + entry->name);
    database.execute("UPDATE project SET revision = revision + 1");
    Statement counts = database.prepare("SELECT lines, valid_cells FROM matrix WHERE id = ?");
    counts.bind(entry->matrix).step();
    SnapshotPtr after = SnapshotReader::withLine(*before, scan, before->revision() + 1, counts.number(0),
                                                 static_cast<std::size_t>(counts.integer(1)));
    while (counts.step()) {
    }
    transaction.commit();
    state_->publish(std::move(after));
  });
}

Status Project::saveCopy(const fs::path& path) const {
  return attempt([&] {
    NewProjectFile file(resolvedPath(path));
    const ReadingConnection source(state_->path);
    copyPages(source.database(), file.workingPath());
    source.requireUnchanged();
    file.publish();
  });
}

Result<std::unique_ptr<Project>> Project::saveAs(const fs::path& path) const {
  return saveCopy(path).and_then([&] { return open(path, Access::ReadWrite); });
}

Result<CompactReport> Project::compact() {
  return attempt([this] {
    const Database& database = state_->requireWriter();
    CompactReport report;
    report.bytes_before = bytesOnDisk(state_->path);
    {
      Transaction transaction(database, Transaction::Kind::Write);
      state_->requireOwnRevision(database);
      report.matrices_dropped = dropUnreferenced(database);
      database.execute("UPDATE project SET revision = revision + 1");
      SnapshotPtr after = SnapshotReader::read(database, state_->images);
      transaction.commit();
      state_->images->forget();
      state_->publish(std::move(after));
    }
    // Safe to be killed in: it goes through the log like any other change.
    database.execute("VACUUM");
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
    report.bytes_after = bytesOnDisk(state_->path);
    return report;
  });
}

Status Project::verify() const {
  return attempt([this] {
    const ReadingConnection connection(state_->path);
    const auto damaged = [this](const std::string& how) {
      return StoreFailure("the project is damaged: " + how, state_->path.string(),
                          "go back to a copy of the project");
    };
    Statement integrity = connection.database().prepare("PRAGMA integrity_check(1)");
    while (integrity.step())
      if (integrity.text(0) != "ok") throw damaged(integrity.text(0));
    Statement keys = connection.database().prepare("PRAGMA foreign_key_check");
    if (keys.step())
      throw damaged("a row of table " + keys.text(0) + " refers to one that is missing in " + keys.text(2));
    for (const ScanEntry& scan : state_->current()->scans())
      orThrow(state_->images->readImage(scan.matrix, scan.lines, scan.geometry_id, scan.geometry));
  });
}

}  // namespace tiltmap
