// A project as it was at one moment: what every computation, table and picture reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/project/job_record.h"
#include "core/project/link.h"
#include "core/project/site_picture.h"
#include "core/project/stage.h"
#include "core/scan/range_image.h"

namespace tiltmap {

class ImageStore;

// A picture taken at a stop: its bytes in the project, or the path of a file outside it.
struct Photograph {
  std::int64_t id = 0;
  std::string caption;
  std::string media_type;  // "image/jpeg"
  std::string path;        // empty where the bytes are in the project
  std::size_t bytes = 0;   // size of the stored picture, 0 for a path
};

struct SurveyInfo {
  std::string site;
  std::string operator_name;
  std::string device;
  std::string date;  // as entered; ISO 8601 suggested
  // Where the world (the frame of the first scan) is in the frame that imported poses came in; nothing where they
  // came with none.
  std::optional<Pose> site_from_world = std::nullopt;

  bool operator==(const SurveyInfo&) const = default;
};

// One edit in the order it was made.
struct HistoryEntry {
  std::int64_t id = 0;
  std::string title;  // "register 13 pairs"
  std::string time;   // UTC, ISO 8601
  std::string program_version;
  bool undone = false;  // redo() brings it back
  bool fixed = false;   // compacted: can no longer be undone
};

// One stop. Copying it copies no matrix.
class ScanEntry {
 public:
  ScanId id = 0;
  std::string name;
  std::string source;
  std::string note;
  // 0xRRGGBB that a person chose, kept with the survey so that tree, pictures and reports agree on every machine;
  // nothing: by the scan's place.
  std::optional<std::uint32_t> colour;
  ScannerGeometry geometry;
  std::vector<Photograph> photographs;
  std::map<Stage, Pose> poses;  // world_from_scan; odometry always there

  // Known without loading the matrix.
  std::int64_t matrix = 0;  // identity of the stored matrix: same number, same bytes
  std::int64_t geometry_id = 0;
  int rows = 0;
  int columns = 0;
  int lines = 0;  // lines stored so far; the rest of the matrix is kNotScanned
  std::size_t valid_cells = 0;

  const Pose& odometry() const { return poses.at(Stage::Odometry); }
  std::optional<Pose> pose(Stage stage) const;

  // The matrix, read on first use and kept while anyone holds it (and some longer). Any thread. Fails where
  // the file can no longer be read or the matrix has been compacted away since the snapshot.
  Result<RangeImagePtr> image() const;
  // Matrix, geometry, odometry, name and source together.
  Result<Scan> scan() const;
  // The bytes of a photograph of this stop that is stored in the project. Any thread.
  Result<std::vector<unsigned char>> photographBytes(std::int64_t photograph) const;

 private:
  friend class SnapshotReader;
  std::shared_ptr<ImageStore> store_;
};

// Immutable; any thread. Holds no matrices, so that a project of thousands of stops stays small in memory.
class ProjectSnapshot {
 public:
  const std::filesystem::path& path() const { return path_; }
  // Made once when the project is created; copies of the file share it.
  const std::string& projectId() const { return project_id_; }
  // Grows with every edit, undo and redo.
  std::int64_t revision() const { return revision_; }
  int schemaVersion() const { return schema_version_; }

  // In the survey's order: the position is the index that commands use.
  const std::vector<ScanEntry>& scans() const { return scans_; }
  const ScanEntry* find(ScanId id) const;  // nothing for a scan that is not in the project
  std::optional<std::size_t> indexOf(ScanId id) const;
  // By index, with an error that names the range for one that is not there.
  Result<const ScanEntry*> scanAt(long long index) const;

  const std::vector<Link>& links() const { return links_; }  // by id
  const Link* findLink(LinkId id) const;
  std::vector<Link> linksOf(ScanId id) const;

  // Stages that have a pose for at least one scan, in the order of Stage.
  std::vector<Stage> stages() const;
  bool hasStage(Stage stage) const;
  // Relaxed if there are any, else pairwise, else odometry; never truth.
  Stage latestStage() const;
  // world_from_scan by index; nothing where a scan has no pose at the stage.
  std::vector<std::optional<Pose>> poses(Stage stage) const;
  // The same with the gaps filled by odometry carried on from the nearest earlier scan that has a pose (from
  // the nearest later one at the start; plain odometry where no scan has one).
  std::vector<Pose> filledPoses(Stage stage) const;

  const SurveyInfo& survey() const { return survey_; }
  // Scans that a relaxation leaves where they are, beside scan 0; in the survey's order.
  const std::vector<ScanId>& pins() const { return pins_; }
  bool isPinned(ScanId id) const;
  const std::optional<SitePicture>& sitePicture() const { return site_picture_; }
  // Any thread. Error: there is none, or it can no longer be read.
  Result<std::vector<unsigned char>> sitePictureBytes() const;
  const std::vector<JobRecord>& jobs() const { return jobs_; }
  const std::vector<HistoryEntry>& history() const { return history_; }
  bool canUndo() const;
  bool canRedo() const;

  // The project as it would be with these poses at the stage, for showing what is only proposed; in no file.
  // Scans that are not there are left out.
  std::shared_ptr<const ProjectSnapshot> withPoses(Stage stage,
                                                   const std::vector<std::pair<ScanId, Pose>>& poses) const;

 private:
  friend class SnapshotReader;
  std::filesystem::path path_;
  std::string project_id_;
  std::int64_t revision_ = 0;
  int schema_version_ = 0;
  std::vector<ScanEntry> scans_;
  std::unordered_map<ScanId, std::size_t> index_;
  std::vector<Link> links_;
  SurveyInfo survey_;
  std::vector<ScanId> pins_;
  std::optional<SitePicture> site_picture_;
  std::shared_ptr<ImageStore> store_;
  std::vector<JobRecord> jobs_;
  std::vector<HistoryEntry> history_;
};

using SnapshotPtr = std::shared_ptr<const ProjectSnapshot>;

}  // namespace tiltmap
