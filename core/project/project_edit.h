// Changes to a project, as values: made anywhere, applied by the one writer, all steps or none.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/project/project_snapshot.h"
#include "core/scan/cell_mask.h"

namespace tiltmap {

// Stands for the k-th scan (from 0) that the same edit adds, wherever a ScanId is asked for.
constexpr ScanId addedScan(std::size_t k) {
  return -1 - static_cast<ScanId>(k);
}

struct NewPhotograph {
  std::string caption;
  std::string media_type;
  std::string path;                  // of a file outside the project; else empty
  std::vector<unsigned char> bytes;  // to be kept in the project; else empty
  std::function<Result<std::vector<unsigned char>>()> load_bytes;  // used where both are empty
};

// Appends a scan. Without an image and without a loader it is the start of a capture: a matrix of
// geometry.rows x geometry.columns with no line scanned yet (Project::appendLine fills it).
struct AddScan {
  Scan scan;
  std::function<Result<RangeImagePtr>()>
      load_image;               // used where scan.image is null: one matrix in memory at a time
  std::map<Stage, Pose> poses;  // world_from_scan of other stages than odometry
  std::string note;
  std::vector<NewPhotograph> photographs;
  std::optional<std::uint32_t> colour = std::nullopt;  // 0xRRGGBB
};
// Takes the scans, their poses, links and photographs out. The matrices stay in the file until it is
// compacted.
struct DeleteScans {
  std::vector<ScanId> scans;
};
struct RenameScan {
  ScanId scan = 0;
  std::string name;
};
struct SetNote {
  ScanId scan = 0;
  std::string note;
};
struct SetColour {
  ScanId scan = 0;
  std::optional<std::uint32_t> colour;  // 0xRRGGBB; nothing: by the scan's place again
};
struct ReorderScans {
  std::vector<ScanId> order;  // every scan once
};
struct SetGeometry {  // a new calibration; rows and columns must stay
  ScanId scan = 0;
  ScannerGeometry geometry;
};
// Its cells are handed out as cell_code::kMasked from then on; the stored ranges stay. Later geometries of
// the scan keep it.
struct SetBodyMask {
  ScanId scan = 0;
  std::optional<CellMask> mask;  // of the matrix's size; nothing: none any more
};
struct AddPhotograph {
  ScanId scan = 0;
  NewPhotograph photograph;
};
struct RemovePhotograph {
  std::int64_t photograph = 0;
};
struct AddLinks {
  std::vector<Link> links;  // ids are given by the project
  // Takes out links between the same two scans (either way round) of the same origin first: registering again
  // replaces what registering found before, and leaves alone what a person set by hand.
  bool replace = true;
};
struct DeleteLinks {
  std::vector<LinkId> links;
};
struct SetLinkState {
  LinkId link = 0;
  LinkState state = LinkState::Active;
};
struct SetLinkJudgements {
  std::vector<std::pair<LinkId, std::shared_ptr<const PairJudgement>>> judgements;  // null: not judged
};
struct SetPoses {
  Stage stage = Stage::Pairwise;
  std::vector<std::pair<ScanId, Pose>> poses;  // world_from_scan; scans not named keep theirs
};
struct ClearPoses {  // not odometry: every scan has one
  Stage stage = Stage::Pairwise;
};
struct SetSurvey {
  SurveyInfo survey;
};
struct SetPins {  // these and no others; scan 0 need not be named
  std::vector<ScanId> scans;
};
struct SetSitePicture {
  std::optional<NewSitePicture> picture;  // nothing: there is none any more
};

using EditStep = std::variant<AddScan, DeleteScans, RenameScan, SetNote, SetColour, ReorderScans, SetGeometry,
                              SetBodyMask, AddPhotograph, RemovePhotograph, AddLinks, DeleteLinks,
                              SetLinkState, SetLinkJudgements, SetPoses, ClearPoses, SetSurvey, SetPins,
                              SetSitePicture>;

// One entry of the history: undone and redone as a whole.
struct ProjectEdit {
  std::string title;  // for people: "register 13 pairs"
  std::vector<EditStep> steps;
  // The snapshot the edit was computed from. The project refuses the edit when the scans concerned (all of
  // the snapshot's where `concerned` is empty) have since been deleted or have other matrices, geometry,
  // poses or links among themselves. Names, notes, colours and photographs may have changed. Without it
  // nothing is compared.
  SnapshotPtr base;
  std::vector<ScanId> concerned;
  std::vector<JobRecord> jobs;  // what computed it

  bool empty() const { return steps.empty() && jobs.empty(); }
};

// The usual edits, with their titles.
ProjectEdit importEdit(std::vector<Scan> scans);
ProjectEdit deleteEdit(const ProjectSnapshot& snapshot, std::vector<ScanId> scans);
ProjectEdit renameEdit(ScanId scan, std::string name);
ProjectEdit noteEdit(ScanId scan, std::string note);
ProjectEdit colourEdit(const ProjectSnapshot& snapshot, const std::vector<ScanId>& scans,
                       std::optional<std::uint32_t> colour);
ProjectEdit surveyEdit(SurveyInfo survey);
// These scans, and no others, are pinned: a relaxation leaves them where they are.
ProjectEdit pinsEdit(const ProjectSnapshot& snapshot, std::vector<ScanId> scans);
ProjectEdit linkStateEdit(LinkId link, LinkState state);
// A person vouches for what was found: the link becomes one set by hand, which registering again leaves
// alone. It is active afterwards. Throws std::invalid_argument for a link that did not succeed.
ProjectEdit acceptLinkEdit(const Link& link);
// Links found and the poses chained from them; the stage `relaxed` computed from older links is cleared where
// one of them joins two scans that are in it.
ProjectEdit registerEdit(SnapshotPtr base, std::vector<Link> links,
                         std::vector<std::pair<ScanId, Pose>> pairwise);
ProjectEdit relaxEdit(SnapshotPtr base, std::vector<std::pair<ScanId, Pose>> relaxed);
ProjectEdit posesEdit(Stage stage, std::vector<std::pair<ScanId, Pose>> poses);
// Every stage on its own is moved as a rigid whole so that `scan` comes to stand at world_from_scan. A stage
// in which the scan has no pose keeps its own. Fails for a scan that is not there.
Result<ProjectEdit> rebaseEdit(SnapshotPtr base, ScanId scan, const Pose& world_from_scan);
// Everything of the other project, appended: scans, poses, links, photographs, jobs; survey entries where
// this one has none. `world_from_other_world` places it. Matrices are read one at a time when the edit is
// applied.
ProjectEdit mergeEdit(const ProjectSnapshot& into, const ProjectSnapshot& other,
                      const Pose& world_from_other_world = Pose());

// Where the other project's world stands in this one's, for mergeEdit: known where both tell their place in
// the frame that imported poses came in, and the identity where this one has no scans yet.
std::optional<Pose> mergePlacement(const ProjectSnapshot& into, const ProjectSnapshot& other);

// What an edit, an undo or a redo changed.
struct Change {
  std::int64_t revision = 0;
  std::string title;
  std::vector<ScanId> scans_added;
  std::vector<ScanId> scans_removed;
  std::vector<ScanId> scans_changed;  // name, note, colour, photographs, geometry, lines or a pose
  std::vector<LinkId> links_added;
  std::vector<LinkId> links_removed;
  std::vector<LinkId> links_changed;
  std::vector<Stage> stages_changed;  // with a pose added, removed or moved
  bool order_changed = false;
  bool survey_changed = false;  // its entries, the pins or the picture of the site
  bool jobs_changed = false;
};
Change changeBetween(const ProjectSnapshot& before, const ProjectSnapshot& after);

}  // namespace tiltmap
