#include "core/project/snapshot_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/project/judgement_json.h"
#include "core/project/schema.h"

namespace tiltmap {

namespace {

StoreFailure damaged(const Database& database, const std::string& how) {
  return StoreFailure("the project is damaged: " + how, database.path().string(),
                      "go back to a copy of the project");
}

std::unordered_map<std::int64_t, ScannerGeometry> readGeometries(const Database& database) {
  std::unordered_map<std::int64_t, ScannerGeometry> geometries;
  Statement query =
      database.prepare(std::string("SELECT id, ") + kGeometryColumns + " FROM scanner_geometry");
  while (query.step()) geometries.emplace(query.integer(0), geometryFrom(query, 1));
  return geometries;
}

std::vector<ScanEntry> readScans(const Database& database) {
  const auto geometries = readGeometries(database);
  std::vector<ScanEntry> scans;
  Statement query = database.prepare(
      "SELECT scan.id, name, source, note, geometry_id, matrix_id, rows, columns, lines, valid_cells, colour "
      "FROM scan JOIN matrix ON matrix.id = matrix_id ORDER BY position, scan.id");
  while (query.step()) {
    ScanEntry entry;
    entry.id = query.integer(0);
    entry.name = query.text(1);
    entry.source = query.text(2);
    entry.note = query.text(3);
    entry.geometry_id = query.integer(4);
    entry.matrix = query.integer(5);
    entry.rows = query.number(6);
    entry.columns = query.number(7);
    entry.lines = query.number(8);
    entry.valid_cells = static_cast<std::size_t>(query.integer(9));
    // What is no colour (a file that another program wrote in) is as if none had been chosen.
    if (!query.isNull(10) && query.integer(10) >= 0 && query.integer(10) <= 0xffffff)
      entry.colour = static_cast<std::uint32_t>(query.integer(10));
    const auto geometry = geometries.find(entry.geometry_id);
    if (geometry == geometries.end()) throw damaged(database, "a scan's geometry is missing");
    entry.geometry = geometry->second;
    scans.push_back(std::move(entry));
  }
  return scans;
}

JudgedOf::Scan judgedOf(const ScanEntry* scan) {
  return scan ? JudgedOf::Scan{scan->matrix, scan->geometry_id, scan->lines} : JudgedOf::Scan{};
}

std::vector<Link> readLinks(const Database& database, const ProjectSnapshot& snapshot) {
  std::vector<Link> links;
  Statement query = database.prepare(
      "SELECT id, fixed_scan_id, moving_scan_id, x_m, y_m, z_m, qx, qy, qz, qw, iterations, correspondences, "
      "rms_m, "
      "overlap, milliseconds, stop_reason, succeeded, origin, state, information, judgement FROM link ORDER "
      "BY id");
  while (query.step()) {
    Link link;
    link.id = query.integer(0);
    link.fixed = query.integer(1);
    link.moving = query.integer(2);
    link.fixed_from_moving = poseFrom(database, query, 3);
    link.iterations = query.number(10);
    link.correspondences = query.number(11);
    link.rms_m = query.real(12);
    link.overlap = query.real(13);
    link.milliseconds = query.real(14);
    link.stop_reason = query.text(15);
    link.succeeded = query.integer(16) != 0;
    link.origin = orThrow(parseLinkOrigin(query.text(17)));
    link.state = orThrow(parseLinkState(query.text(18)));
    if (!query.isNull(19)) {
      if (query.blob(19).size() != 36 * sizeof(double))
        throw damaged(database, "a link's information is not 6 x 6");
      Matrix6d information;
      std::memcpy(information.data(), query.blob(19).data(), 36 * sizeof(double));
      link.information = information;
    }
    if (!query.isNull(20))
      link.judgement =
          restoredJudgement(query.text(20), {judgedOf(snapshot.find(link.fixed)),
                                             judgedOf(snapshot.find(link.moving)), link.fixed_from_moving});
    links.push_back(std::move(link));
  }
  return links;
}

std::optional<Pose> poseOfStoredText(const std::string& text) {
  std::vector<double> n;
  for (const std::string_view word : splitWords(text))
    if (const auto number = parseReal(word)) n.push_back(*number);
  if (n.size() != 7) return std::nullopt;
  return Pose::restored(Eigen::Quaterniond(n[6], n[3], n[4], n[5]), {n[0], n[1], n[2]});
}

SurveyInfo readSurvey(const Database& database) {
  SurveyInfo survey;
  Statement query = database.prepare("SELECT key, value FROM survey");
  while (query.step()) {
    const std::string key = query.text(0);
    if (key == "site") survey.site = query.text(1);
    if (key == "operator") survey.operator_name = query.text(1);
    if (key == "device") survey.device = query.text(1);
    if (key == "date") survey.date = query.text(1);
    if (key == "site_from_world") survey.site_from_world = poseOfStoredText(query.text(1));
  }
  return survey;
}

// Of scans that are there: one that was deleted is pinned again when it comes back.
std::vector<ScanId> readPins(const Database& database, const ProjectSnapshot& snapshot) {
  Statement query = database.prepare("SELECT value FROM survey WHERE key = 'pins'");
  if (!query.step()) return {};
  std::vector<std::pair<std::size_t, ScanId>> pins;
  const std::string text = query.text(0);
  for (const std::string_view word : splitWords(text))
    if (const auto scan = parseInteger(word))
      if (const auto index = snapshot.indexOf(*scan)) pins.emplace_back(*index, *scan);
  std::ranges::sort(pins);
  std::vector<ScanId> scans;
  for (const auto& pin : pins) scans.push_back(pin.second);
  return scans;
}

std::optional<SitePicture> readSitePicture(const Database& database) {
  const auto attachment =
      database.integer("SELECT CAST(value AS INTEGER) FROM survey WHERE key = 'site_picture_attachment'");
  Statement query = database.prepare("SELECT value FROM survey WHERE key = 'site_picture'");
  if (!attachment || !query.step()) return std::nullopt;
  auto picture = parseSitePicture(query.text(0));
  if (!picture) throw damaged(database, "the place of the site's picture is no such text");
  picture->attachment = *attachment;
  return picture;
}

std::vector<JobRecord> readJobs(const Database& database) {
  std::vector<JobRecord> jobs;
  Statement query = database.prepare(
      "SELECT id, operation, preset, parameters, program_version, started, finished, state, warnings FROM "
      "job ORDER BY id");
  while (query.step()) {
    JobRecord job;
    job.id = query.integer(0);
    job.operation = query.text(1);
    job.preset = query.text(2);
    job.values = orThrow(parametersFromJson(query.text(3)));
    job.program_version = query.text(4);
    job.started = query.text(5);
    job.finished = query.text(6);
    job.state = orThrow(parseJobState(query.text(7)));
    const auto warnings = nlohmann::json::parse(query.text(8), nullptr, false);
    if (!warnings.is_array()) throw damaged(database, "a job's warnings are not a list");
    for (const auto& warning : warnings)
      if (warning.is_string()) job.warnings.push_back(warning.get<std::string>());
    jobs.push_back(std::move(job));
  }
  return jobs;
}

std::vector<HistoryEntry> readHistory(const Database& database) {
  std::vector<HistoryEntry> history;
  Statement query = database.prepare("SELECT id, title, time, program_version, state FROM edit ORDER BY id");
  while (query.step())
    history.push_back({query.integer(0), query.text(1), query.text(2), query.text(3),
                       query.text(4) == "undone", query.text(4) == "fixed"});
  return history;
}

}  // namespace

Pose poseFrom(const Database& database, const Statement& row, int first) {
  double norm = 0.0;
  for (int i = 3; i < 7; ++i) norm += row.real(first + i) * row.real(first + i);
  if (!(std::abs(norm - 1.0) < 1e-6)) throw damaged(database, "a pose's quaternion is not a rotation");
  return Pose::restored(
      Eigen::Quaterniond(row.real(first + 6), row.real(first + 3), row.real(first + 4), row.real(first + 5)),
      Eigen::Vector3d(row.real(first), row.real(first + 1), row.real(first + 2)));
}

ScannerGeometry geometryFrom(const Statement& row, int first) {
  ScannerGeometry g;
  g.rows = row.number(first);
  g.columns = row.number(first + 1);
  g.azimuth_start_rad = row.real(first + 2);
  g.azimuth_step_rad = row.real(first + 3);
  g.tilt_start_rad = row.real(first + 4);
  g.tilt_step_rad = row.real(first + 5);
  g.tilt_zero_rad = row.real(first + 6);
  g.lever_arm_m = {row.real(first + 7), row.real(first + 8), row.real(first + 9)};
  g.mounting = Eigen::Quaterniond(row.real(first + 13), row.real(first + 10), row.real(first + 11),
                                  row.real(first + 12));
  g.range_offset_m = row.real(first + 14);
  g.minimum_range_m = row.real(first + 15);
  g.maximum_range_m = row.real(first + 16);
  return g;
}

std::optional<std::string> storedBodyMask(const Database& database, std::int64_t geometry_id) {
  Statement query = database.prepare("SELECT body_mask FROM scanner_geometry WHERE id = ?");
  if (!query.bind(geometry_id).step() || query.isNull(0)) return std::nullopt;
  return query.text(0);
}

std::int64_t geometryRow(const Database& database, const ScannerGeometry& g,
                         const std::optional<std::string>& body_mask) {
  const auto withValues = [&](auto&& use) {
    return use(g.rows, g.columns, g.azimuth_start_rad, g.azimuth_step_rad, g.tilt_start_rad, g.tilt_step_rad,
               g.tilt_zero_rad, g.lever_arm_m.x(), g.lever_arm_m.y(), g.lever_arm_m.z(), g.mounting.x(),
               g.mounting.y(), g.mounting.z(), g.mounting.w(), g.range_offset_m, g.minimum_range_m,
               g.maximum_range_m, body_mask);
  };
  const std::string columns = kGeometryColumns;
  // One row for each distinct geometry: a survey has one or two.
  const auto known = withValues([&](const auto&... values) {
    return database.integer("SELECT id FROM scanner_geometry WHERE (" + columns +
                                ") = (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) AND body_mask IS ? "
                                "ORDER BY id LIMIT 1",
                            values...);
  });
  if (known) return *known;
  withValues([&](const auto&... values) {
    database.run("INSERT INTO scanner_geometry(" + columns +
                     ", body_mask) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                 values...);
    return 0;
  });
  return database.lastInsertId();
}

std::int64_t SnapshotReader::storedRevision(const Database& database) {
  const auto revision = database.integer("SELECT revision FROM project");
  if (!revision) throw damaged(database, "its first table is empty");
  return *revision;
}

SnapshotPtr SnapshotReader::read(const Database& database, std::shared_ptr<ImageStore> store) {
  auto snapshot = std::make_shared<ProjectSnapshot>();
  snapshot->path_ = database.path();
  snapshot->schema_version_ = storedSchemaVersion(database);
  snapshot->revision_ = storedRevision(database);
  {
    Statement query = database.prepare("SELECT project_id FROM project");
    if (query.step()) snapshot->project_id_ = query.text(0);
  }
  snapshot->scans_ = readScans(database);
  for (std::size_t i = 0; i < snapshot->scans_.size(); ++i) {
    snapshot->scans_[i].store_ = store;
    snapshot->index_.emplace(snapshot->scans_[i].id, i);
  }
  const auto scanOf = [&](std::int64_t id) -> ScanEntry& {
    const auto found = snapshot->index_.find(id);
    if (found == snapshot->index_.end()) throw damaged(database, "a row belongs to a scan that is missing");
    return snapshot->scans_[found->second];
  };
  Statement poses = database.prepare("SELECT scan_id, stage, x_m, y_m, z_m, qx, qy, qz, qw FROM pose");
  while (poses.step())
    scanOf(poses.integer(0)).poses[orThrow(parseStage(poses.text(1)))] = poseFrom(database, poses, 2);
  for (const ScanEntry& scan : snapshot->scans_)
    if (!scan.poses.contains(Stage::Odometry))
      throw damaged(database, "scan " + scan.name + " has no odometry");
  Statement photographs = database.prepare(
      "SELECT photograph.id, scan_id, caption, media_type, path, coalesce(length(data), 0) FROM photograph "
      "LEFT JOIN attachment ON attachment.id = attachment_id ORDER BY photograph.id");
  while (photographs.step())
    scanOf(photographs.integer(1))
        .photographs.push_back({photographs.integer(0), photographs.text(2), photographs.text(3),
                                photographs.text(4), static_cast<std::size_t>(photographs.integer(5))});
  snapshot->links_ = readLinks(database, *snapshot);
  snapshot->survey_ = readSurvey(database);
  snapshot->pins_ = readPins(database, *snapshot);
  snapshot->site_picture_ = readSitePicture(database);
  snapshot->store_ = store;
  snapshot->jobs_ = readJobs(database);
  snapshot->history_ = readHistory(database);
  return snapshot;
}

SnapshotPtr SnapshotReader::withLine(const ProjectSnapshot& snapshot, ScanId scan, std::int64_t revision,
                                     int lines, std::size_t valid_cells) {
  auto next = std::make_shared<ProjectSnapshot>(snapshot);
  next->revision_ = revision;
  ScanEntry& entry = next->scans_[next->index_.at(scan)];
  entry.lines = lines;
  entry.valid_cells = valid_cells;
  for (Link& link : next->links_)
    if (link.fixed == scan || link.moving == scan) link.judgement = nullptr;  // of fewer lines
  return next;
}

std::string storedPoseText(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.quaternion();
  std::string text;
  for (const double number : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
    text += (text.empty() ? "" : " ") + shortestReal(number);
  return text;
}

}  // namespace tiltmap
