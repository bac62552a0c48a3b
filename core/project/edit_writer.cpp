#include "core/project/edit_writer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "core/project/image_store.h"
#include "core/project/judgement_json.h"
#include "core/project/snapshot_reader.h"

namespace tiltmap {

namespace {

constexpr const char* kLookAgain =
    "the project may have changed since; look at `tiltmap info` and repeat the command";

constexpr const char* kGeometryOf = "SELECT geometry_id FROM scan WHERE id = ?";

[[noreturn]] void refuse(std::string what, std::string where, std::string remedy) {
  throw StoreFailure(std::move(what), std::move(where), std::move(remedy));
}

void requireFinite(const Pose& pose, const std::string& of) {
  if (!pose.isFinite()) refuse("the pose of " + of + " is not finite", of, "check where the pose comes from");
}

std::optional<std::int64_t> storedColour(std::optional<std::uint32_t> colour) {
  if (!colour) return std::nullopt;
  if (*colour > 0xffffffU)
    refuse("a scan's colour is not 0 to 0xffffff", "colour", "give red, green and blue, 8 bits each");
  return static_cast<std::int64_t>(*colour);
}

std::string scanText(ScanId scan) {
  return "scan with id " + std::to_string(scan);
}

}  // namespace

void EditWriter::write(const ProjectEdit& edit) {
  for (const EditStep& step : edit.steps) std::visit([this](const auto& s) { apply(s); }, step);
  for (const JobRecord& job : edit.jobs) addJob(job);
}

ScanId EditWriter::resolved(ScanId scan) const {
  if (scan < 0 && static_cast<std::size_t>(-1 - scan) < added_.size())
    return added_[static_cast<std::size_t>(-1 - scan)];
  if (!database_.integer("SELECT id FROM scan WHERE id = ?", scan))
    refuse("there is no " + scanText(scan) + " in the project", scanText(scan), kLookAgain);
  return scan;
}

void EditWriter::requireLink(LinkId link) const {
  if (!database_.integer("SELECT id FROM link WHERE id = ?", link))
    refuse("there is no link with id " + std::to_string(link) + " in the project",
           "link " + std::to_string(link), kLookAgain);
}

void EditWriter::apply(const AddScan& step) {
  RangeImagePtr image = step.scan.image;
  if (!image && step.load_image) image = orThrow(step.load_image());
  const std::string& name = step.scan.name;
  if (Status status = step.scan.geometry.check(); !status)
    refuse(status.error().what, "geometry of scan " + name, status.error().remedy);
  const std::int64_t matrix = writeMatrix(database_, image.get(), step.scan.geometry);
  const std::int64_t geometry = geometryRow(database_, step.scan.geometry);
  const std::int64_t position = database_.integer("SELECT max(position) + 1 FROM scan").value_or(0);
  database_.run(
      "INSERT INTO scan(position, matrix_id, geometry_id, name, source, note, colour) "
      "VALUES (?, ?, ?, ?, ?, ?, ?)",
      position, matrix, geometry, name, step.scan.source, step.note, storedColour(step.colour));
  const ScanId scan = database_.lastInsertId();
  added_.push_back(scan);
  setPose(scan, Stage::Odometry, step.scan.odometry);
  for (const auto& [stage, pose] : step.poses)
    if (stage != Stage::Odometry) setPose(scan, stage, pose);
  for (const NewPhotograph& photograph : step.photographs) addPhotograph(scan, photograph);
}

void EditWriter::apply(const DeleteScans& step) {
  for (const ScanId given : step.scans) {
    const ScanId scan = resolved(given);
    database_.run("DELETE FROM link WHERE fixed_scan_id = ?1 OR moving_scan_id = ?1", scan);
    database_.run("DELETE FROM photograph WHERE scan_id = ?", scan);
    database_.run("DELETE FROM pose WHERE scan_id = ?", scan);
    database_.run("DELETE FROM scan WHERE id = ?", scan);
  }
}

void EditWriter::apply(const RenameScan& step) {
  database_.run("UPDATE scan SET name = ? WHERE id = ?", step.name, resolved(step.scan));
}

void EditWriter::apply(const SetNote& step) {
  database_.run("UPDATE scan SET note = ? WHERE id = ?", step.note, resolved(step.scan));
}

void EditWriter::apply(const SetColour& step) {
  database_.run("UPDATE scan SET colour = ? WHERE id = ?", storedColour(step.colour), resolved(step.scan));
}

void EditWriter::apply(const ReorderScans& step) {
  std::set<ScanId> seen;
  for (const ScanId scan : step.order) seen.insert(resolved(scan));
  if (seen.size() != step.order.size() ||
      database_.integer("SELECT count(*) FROM scan") != static_cast<std::int64_t>(step.order.size()))
    refuse("the new order does not name every scan once", "order of scans", "name all scans, each once");
  Statement update = database_.prepare("UPDATE scan SET position = ? WHERE id = ?");
  for (std::size_t i = 0; i < step.order.size(); ++i) update.run(i, resolved(step.order[i]));
}

void EditWriter::apply(const SetGeometry& step) {
  const ScanId scan = resolved(step.scan);
  if (Status status = step.geometry.check(); !status) throw StoreFailure(status.error());
  Statement old = database_.prepare(
      "SELECT rows, columns FROM scan JOIN scanner_geometry AS g ON g.id = geometry_id "
      "WHERE scan.id = ?");
  if (old.bind(scan).step() &&
      (old.number(0) != step.geometry.rows || old.number(1) != step.geometry.columns))
    refuse("the geometry has another size than the scan's matrix", scanText(scan),
           "give one with " + std::to_string(old.number(0)) + " rows and " + std::to_string(old.number(1)) +
               " columns");
  const auto mask = storedBodyMask(database_, database_.integer(kGeometryOf, scan).value_or(0));
  database_.run("UPDATE scan SET geometry_id = ? WHERE id = ?", geometryRow(database_, step.geometry, mask),
                scan);
}

void EditWriter::apply(const SetBodyMask& step) {
  const ScanId scan = resolved(step.scan);
  std::optional<std::string> text;
  if (step.mask) {
    if (Status status = checkCellMask(*step.mask); !status) throw StoreFailure(status.error());
    text = cellMaskText(*step.mask);
  }
  Statement now =
      database_.prepare(std::string("SELECT matrix.rows, matrix.columns, geometry_id FROM scan ") +
                        "JOIN matrix ON matrix.id = matrix_id WHERE scan.id = ?");
  now.bind(scan).step();
  if (step.mask && (now.number(0) != step.mask->rows || now.number(1) != step.mask->columns))
    refuse("the mask has another size than the scan's matrix", scanText(scan),
           "learn one from scans of " + std::to_string(now.number(0)) + " rows and " +
               std::to_string(now.number(1)) + " columns");
  Statement geometry =
      database_.prepare(std::string("SELECT ") + kGeometryColumns + " FROM scanner_geometry WHERE id = ?");
  geometry.bind(now.integer(2)).step();
  database_.run("UPDATE scan SET geometry_id = ? WHERE id = ?",
                geometryRow(database_, geometryFrom(geometry, 0), text), scan);
}

void EditWriter::addPhotograph(ScanId scan, const NewPhotograph& photograph) {
  std::vector<unsigned char> loaded;
  if (photograph.bytes.empty() && photograph.path.empty() && photograph.load_bytes)
    loaded = orThrow(photograph.load_bytes());
  const std::vector<unsigned char>& bytes = loaded.empty() ? photograph.bytes : loaded;
  if (bytes.empty() == photograph.path.empty())
    refuse("a photograph needs either bytes or a path", scanText(scan), "give one of the two");
  std::optional<std::int64_t> attachment;
  if (!bytes.empty()) {
    database_.run("INSERT INTO attachment(data) VALUES (?)", Bytes(bytes));
    attachment = database_.lastInsertId();
  }
  database_.run(
      "INSERT INTO photograph(scan_id, caption, media_type, path, attachment_id) VALUES (?, ?, ?, ?, ?)",
      scan, photograph.caption, photograph.media_type, photograph.path, attachment);
}

void EditWriter::apply(const AddPhotograph& step) {
  addPhotograph(resolved(step.scan), step.photograph);
}

void EditWriter::apply(const RemovePhotograph& step) {
  if (!database_.integer("SELECT id FROM photograph WHERE id = ?", step.photograph))
    refuse("there is no photograph with id " + std::to_string(step.photograph), "photograph", kLookAgain);
  database_.run("DELETE FROM photograph WHERE id = ?", step.photograph);
}

void EditWriter::apply(const AddLinks& step) {
  // All old ones first: a list with two links of one pair keeps both.
  if (step.replace)
    for (const Link& link : step.links)
      database_.run(
          "DELETE FROM link WHERE origin = ?3 AND ((fixed_scan_id = ?1 AND moving_scan_id = ?2) OR "
          "(fixed_scan_id = ?2 AND moving_scan_id = ?1))",
          resolved(link.fixed), resolved(link.moving), linkOriginName(link.origin));
  Statement insert = database_.prepare(
      "INSERT INTO link(fixed_scan_id, moving_scan_id, x_m, y_m, z_m, qx, qy, qz, qw, iterations, "
      "correspondences, "
      "rms_m, overlap, milliseconds, stop_reason, succeeded, origin, state, information, judgement) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const Link& link : step.links) {
    const ScanId fixed = resolved(link.fixed), moving = resolved(link.moving);
    const std::string where = "link " + std::to_string(fixed) + " - " + std::to_string(moving);
    if (fixed == moving) refuse("a link joins a scan with itself", where, "link two different scans");
    requireFinite(link.fixed_from_moving, where);
    if (!std::isfinite(link.rms_m) || !std::isfinite(link.overlap) || !std::isfinite(link.milliseconds) ||
        (link.information && !link.information->allFinite()))
      refuse("a figure of the link is not finite", where, "check where the link comes from");
    std::optional<Bytes> information;
    if (link.information) information = bytesOf(link.information->data(), 36);
    const Eigen::Vector3d& t = link.fixed_from_moving.translation();
    const Eigen::Quaterniond& q = link.fixed_from_moving.quaternion();
    insert.run(fixed, moving, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), link.iterations,
               link.correspondences, link.rms_m, link.overlap, link.milliseconds, link.stop_reason,
               link.succeeded, linkOriginName(link.origin), linkStateName(link.state), information,
               judgementText(link.judgement.get(), fixed, moving, link.fixed_from_moving));
  }
}

std::optional<std::string> EditWriter::judgementText(const PairJudgement* judgement, ScanId fixed,
                                                     ScanId moving, const Pose& fixed_from_moving) const {
  if (!judgement) return std::nullopt;
  Statement query = database_.prepare(
      "SELECT matrix_id, geometry_id, lines FROM scan JOIN matrix ON matrix.id = matrix_id WHERE scan.id = "
      "?");
  const auto scanOf = [&](ScanId scan) -> JudgedOf::Scan {
    if (!query.bind(scan).step()) refuse("there is no " + scanText(scan), scanText(scan), kLookAgain);
    return {query.integer(0), query.integer(1), query.number(2)};
  };
  try {
    return storedJudgement(*judgement, {scanOf(fixed), scanOf(moving), fixed_from_moving});
  } catch (const std::invalid_argument& wrong) {
    refuse(wrong.what(), "link " + std::to_string(fixed) + " - " + std::to_string(moving),
           "check where the link comes from");
  }
}

void EditWriter::apply(const SetLinkJudgements& step) {
  Statement query = database_.prepare(
      "SELECT fixed_scan_id, moving_scan_id, x_m, y_m, z_m, qx, qy, qz, qw FROM link WHERE id = ?");
  for (const auto& [link, judgement] : step.judgements) {
    requireLink(link);
    query.bind(link).step();
    const Pose pose = poseFrom(database_, query, 2);
    const auto text = judgementText(judgement.get(), query.integer(0), query.integer(1), pose);
    database_.run("UPDATE link SET judgement = ? WHERE id = ?", text, link);
  }
}

void EditWriter::apply(const DeleteLinks& step) {
  for (const LinkId link : step.links) {
    requireLink(link);
    database_.run("DELETE FROM link WHERE id = ?", link);
  }
}

void EditWriter::apply(const SetLinkState& step) {
  requireLink(step.link);
  database_.run("UPDATE link SET state = ? WHERE id = ?", linkStateName(step.state), step.link);
}

void EditWriter::setPose(ScanId scan, Stage stage, const Pose& pose) {
  requireFinite(pose, scanText(scan));
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.quaternion();
  // Not INSERT OR REPLACE: that is recorded as a deletion and an insertion even where nothing changes.
  database_.run(
      "INSERT INTO pose(scan_id, stage, x_m, y_m, z_m, qx, qy, qz, qw) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) "
      "ON CONFLICT(scan_id, stage) DO UPDATE SET x_m = excluded.x_m, y_m = excluded.y_m, z_m = excluded.z_m, "
      "qx = excluded.qx, qy = excluded.qy, qz = excluded.qz, qw = excluded.qw",
      scan, stageName(stage), t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

void EditWriter::apply(const SetPoses& step) {
  for (const auto& [scan, pose] : step.poses) setPose(resolved(scan), step.stage, pose);
}

void EditWriter::apply(const ClearPoses& step) {
  if (step.stage == Stage::Odometry)
    refuse("the odometry cannot be taken away", "stage odometry", "every scan needs one; set it instead");
  database_.run("DELETE FROM pose WHERE stage = ?", stageName(step.stage));
}

void EditWriter::apply(const SetSurvey& step) {
  const std::string site_frame =
      step.survey.site_from_world ? storedPoseText(*step.survey.site_from_world) : "";
  const std::pair<const char*, const std::string*> entries[] = {{"site", &step.survey.site},
                                                                {"operator", &step.survey.operator_name},
                                                                {"device", &step.survey.device},
                                                                {"date", &step.survey.date},
                                                                {"site_from_world", &site_frame}};
  for (const auto& [key, value] : entries) setSurveyEntry(key, *value);
}

void EditWriter::setSurveyEntry(const char* key, const std::string& value) {
  if (value.empty()) {
    database_.run("DELETE FROM survey WHERE key = ?", key);
  } else {
    database_.run(
        "INSERT INTO survey(key, value) VALUES (?, ?) ON CONFLICT(key) DO UPDATE SET value = "
        "excluded.value",
        key, value);
  }
}

void EditWriter::apply(const SetPins& step) {
  std::set<ScanId> scans;
  for (const ScanId scan : step.scans) scans.insert(resolved(scan));
  std::string text;
  for (const ScanId scan : scans) text += (text.empty() ? "" : " ") + std::to_string(scan);
  setSurveyEntry("pins", text);
}

void EditWriter::apply(const SetSitePicture& step) {
  if (!step.picture) {
    setSurveyEntry("site_picture", {});
    setSurveyEntry("site_picture_attachment", {});
    return;
  }
  const NewSitePicture& picture = *step.picture;
  if (auto placed = SitePicturePlacement::make(picture.points); !placed) throw StoreFailure(placed.error());
  std::int64_t attachment = picture.attachment;
  if (!picture.bytes.empty()) {
    database_.run("INSERT INTO attachment(data) VALUES (?)", Bytes(picture.bytes));
    attachment = database_.lastInsertId();
  } else if (!database_.integer("SELECT id FROM attachment WHERE id = ?", attachment)) {
    refuse("the picture of the site is no longer in the project", "picture of the site", kLookAgain);
  }
  setSurveyEntry("site_picture",
                 sitePictureText({attachment, picture.name, picture.media_type, picture.points}));
  setSurveyEntry("site_picture_attachment", std::to_string(attachment));
}

void EditWriter::addJob(const JobRecord& job) {
  const std::string warnings =
      nlohmann::json(job.warnings).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  database_.run(
      "INSERT INTO job(operation, preset, parameters, program_version, started, finished, state, warnings) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
      job.operation, job.preset, parametersToJson(job.values), job.program_version, job.started, job.finished,
      jobStateName(job.state), warnings);
}

}  // namespace tiltmap
