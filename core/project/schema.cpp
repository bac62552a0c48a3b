#include "core/project/schema.h"

#include <array>

namespace tiltmap {

namespace {

// Described in resources/manual/project-file.md: keep the two together.
// Foreign keys carry no actions: undo replays rows one by one and must not meet rows that an action has
// taken.
constexpr Migration kVersion1 = R"sql(
CREATE TABLE project(
  singleton INTEGER PRIMARY KEY CHECK (singleton = 1),
  project_id TEXT NOT NULL,
  created TEXT NOT NULL,
  program_version TEXT NOT NULL,
  revision INTEGER NOT NULL
);
CREATE TABLE scanner_geometry(
  id INTEGER PRIMARY KEY,
  rows INTEGER NOT NULL,
  columns INTEGER NOT NULL,
  azimuth_start_rad REAL NOT NULL,
  azimuth_step_rad REAL NOT NULL,
  tilt_start_rad REAL NOT NULL,
  tilt_step_rad REAL NOT NULL,
  tilt_zero_rad REAL NOT NULL,
  lever_arm_x_m REAL NOT NULL,
  lever_arm_y_m REAL NOT NULL,
  lever_arm_z_m REAL NOT NULL,
  mounting_qx REAL NOT NULL,
  mounting_qy REAL NOT NULL,
  mounting_qz REAL NOT NULL,
  mounting_qw REAL NOT NULL,
  range_offset_m REAL NOT NULL,
  minimum_range_m REAL NOT NULL,
  maximum_range_m REAL NOT NULL
);
CREATE TABLE matrix(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  rows INTEGER NOT NULL,
  columns INTEGER NOT NULL,
  has_intensity INTEGER,
  has_direction INTEGER NOT NULL,
  has_time INTEGER NOT NULL,
  lines INTEGER NOT NULL,
  valid_cells INTEGER NOT NULL
);
CREATE TABLE scan_line(
  id INTEGER PRIMARY KEY,
  matrix_id INTEGER NOT NULL REFERENCES matrix(id),
  row INTEGER NOT NULL,
  tilt_rad REAL NOT NULL,
  time_s REAL,
  range_m BLOB NOT NULL,
  code BLOB NOT NULL,
  intensity BLOB,
  direction BLOB,
  UNIQUE (matrix_id, row)
);
CREATE TABLE attachment(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  data BLOB NOT NULL
);
CREATE TABLE scan(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  position INTEGER NOT NULL,
  matrix_id INTEGER NOT NULL REFERENCES matrix(id),
  geometry_id INTEGER NOT NULL REFERENCES scanner_geometry(id),
  name TEXT NOT NULL,
  source TEXT NOT NULL,
  note TEXT NOT NULL
);
CREATE TABLE pose(
  scan_id INTEGER NOT NULL REFERENCES scan(id),
  stage TEXT NOT NULL CHECK (stage IN ('truth', 'odometry', 'pairwise', 'relaxed')),
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  qx REAL NOT NULL,
  qy REAL NOT NULL,
  qz REAL NOT NULL,
  qw REAL NOT NULL,
  PRIMARY KEY (scan_id, stage)
);
CREATE TABLE photograph(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  scan_id INTEGER NOT NULL REFERENCES scan(id),
  caption TEXT NOT NULL,
  media_type TEXT NOT NULL,
  path TEXT NOT NULL,
  attachment_id INTEGER REFERENCES attachment(id)
);
CREATE TABLE link(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  fixed_scan_id INTEGER NOT NULL REFERENCES scan(id),
  moving_scan_id INTEGER NOT NULL REFERENCES scan(id),
  x_m REAL NOT NULL,
  y_m REAL NOT NULL,
  z_m REAL NOT NULL,
  qx REAL NOT NULL,
  qy REAL NOT NULL,
  qz REAL NOT NULL,
  qw REAL NOT NULL,
  iterations INTEGER NOT NULL,
  correspondences INTEGER NOT NULL,
  rms_m REAL NOT NULL,
  overlap REAL NOT NULL,
  milliseconds REAL NOT NULL,
  stop_reason TEXT NOT NULL,
  succeeded INTEGER NOT NULL,
  origin TEXT NOT NULL CHECK (origin IN ('odometry', 'automatic', 'by-hand')),
  state TEXT NOT NULL CHECK (state IN ('active', 'disabled')),
  information BLOB
);
CREATE TABLE survey(
  key TEXT PRIMARY KEY NOT NULL,
  value TEXT NOT NULL
);
CREATE TABLE job(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  operation TEXT NOT NULL,
  preset TEXT NOT NULL,
  parameters TEXT NOT NULL,
  program_version TEXT NOT NULL,
  started TEXT NOT NULL,
  finished TEXT NOT NULL,
  state TEXT NOT NULL,
  warnings TEXT NOT NULL
);
CREATE TABLE edit(
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  title TEXT NOT NULL,
  time TEXT NOT NULL,
  program_version TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('done', 'undone', 'fixed')),
  changeset BLOB
);
CREATE INDEX scan_by_matrix ON scan(matrix_id);
CREATE INDEX link_by_fixed ON link(fixed_scan_id);
CREATE INDEX link_by_moving ON link(moving_scan_id);
CREATE INDEX photograph_by_scan ON photograph(scan_id);
CREATE INDEX photograph_by_attachment ON photograph(attachment_id);
)sql";

// 0xRRGGBB that a person chose for a scan; NULL: by its place in the survey.
constexpr Migration kScanColour = "ALTER TABLE scan ADD COLUMN colour INTEGER";

// What the tilt moved during a turn of the mirror while the line was measured; NULL: it stood.
constexpr Migration kTurnTilt = "ALTER TABLE scan_line ADD COLUMN turn_tilt_rad REAL";

// What judging a link by its scans gave, and of what; NULL: it was not judged.
constexpr Migration kLinkJudgement = "ALTER TABLE link ADD COLUMN judgement TEXT";

// Cells of the matrix that show the machine itself, as core/scan/cell_mask.h writes them; NULL: none. Part of
// what makes a geometry: scans that differ in it have different rows.
constexpr Migration kBodyMask = "ALTER TABLE scanner_geometry ADD COLUMN body_mask TEXT";

constexpr std::array kMigrations = {kVersion1, kScanColour, kTurnTilt, kLinkJudgement, kBodyMask};
constexpr std::array kRecorded = {"scan", "pose", "photograph", "link", "survey", "job"};

}  // namespace

std::span<const Migration> migrations() {
  return kMigrations;
}
std::span<const char* const> recordedTables() {
  return kRecorded;
}

int storedSchemaVersion(const Database& database) {
  return static_cast<int>(database.integer("PRAGMA user_version").value_or(0));
}

StoreFailure newerVersion(const std::filesystem::path& path, int version) {
  return StoreFailure("the project was written by a newer version of Tiltmap (file version " +
                          std::to_string(version) + ", this program knows up to " +
                          std::to_string(schemaVersion()) + ")",
                      path.string(), "open it with that version; this program has changed nothing in it");
}

void migrate(const Database& database, std::span<const Migration> steps) {
  const int last = static_cast<int>(steps.size());
  if (storedSchemaVersion(database) == last) return;
  Transaction transaction(database, Transaction::Kind::Write);
  const int stored = storedSchemaVersion(database);
  if (stored > last || stored < 0) throw newerVersion(database.path(), stored);
  for (int version = stored; version < last; ++version)
    database.execute(steps[static_cast<std::size_t>(version)]);
  database.execute("PRAGMA user_version = " + std::to_string(last));
  transaction.commit();
}

}  // namespace tiltmap
