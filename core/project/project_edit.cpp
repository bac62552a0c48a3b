#include "core/project/project_edit.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

namespace tiltmap {

namespace {

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::vector<ScanId> scansOf(const std::vector<std::pair<ScanId, Pose>>& poses) {
  std::vector<ScanId> scans;
  for (const auto& entry : poses) scans.push_back(entry.first);
  return scans;
}

ProjectEdit oneStep(std::string title, EditStep step) {
  ProjectEdit edit;
  edit.title = std::move(title);
  edit.steps.push_back(std::move(step));
  return edit;
}

}  // namespace

ProjectEdit importEdit(std::vector<Scan> scans) {
  ProjectEdit edit;
  edit.title = "import " + counted(scans.size(), "scan");
  for (Scan& scan : scans) edit.steps.push_back(AddScan{std::move(scan), {}, {}, {}, {}});
  return edit;
}

ProjectEdit deleteEdit(const ProjectSnapshot& snapshot, std::vector<ScanId> scans) {
  const ScanEntry* only = scans.size() == 1 ? snapshot.find(scans.front()) : nullptr;
  return oneStep(only ? "delete " + only->name : "delete " + counted(scans.size(), "scan"),
                 DeleteScans{std::move(scans)});
}

ProjectEdit renameEdit(ScanId scan, std::string name) {
  std::string title = "rename to " + name;
  return oneStep(std::move(title), RenameScan{scan, std::move(name)});
}

ProjectEdit noteEdit(ScanId scan, std::string note) {
  return oneStep("note", SetNote{scan, std::move(note)});
}
ProjectEdit colourEdit(const ProjectSnapshot& snapshot, const std::vector<ScanId>& scans,
                       std::optional<std::uint32_t> colour) {
  ProjectEdit edit;
  const ScanEntry* only = scans.size() == 1 ? snapshot.find(scans.front()) : nullptr;
  edit.title = only ? "colour of " + only->name : "colour of " + counted(scans.size(), "scan");
  for (const ScanId scan : scans) {
    const ScanEntry* entry = snapshot.find(scan);
    if (!entry || entry->colour != colour) edit.steps.push_back(SetColour{scan, colour});
  }
  return edit;
}
ProjectEdit surveyEdit(SurveyInfo survey) {
  return oneStep("survey data", SetSurvey{std::move(survey)});
}

ProjectEdit pinsEdit(const ProjectSnapshot& snapshot, std::vector<ScanId> scans) {
  std::string title = "pin no scan";
  if (scans.size() == 1) {
    const ScanEntry* only = snapshot.find(scans.front());
    title = "pin " + (only ? only->name : std::string("a scan"));
  } else if (!scans.empty()) {
    title = "pin " + counted(scans.size(), "scan");
  }
  return oneStep(std::move(title), SetPins{std::move(scans)});
}

ProjectEdit linkStateEdit(LinkId link, LinkState state) {
  return oneStep(state == LinkState::Active ? "enable a link" : "disable a link", SetLinkState{link, state});
}

ProjectEdit acceptLinkEdit(const Link& link) {
  if (!link.succeeded) throw std::invalid_argument("a link that did not succeed has nothing to accept");
  Link accepted = link;
  accepted.origin = LinkOrigin::ByHand;
  accepted.state = LinkState::Active;
  ProjectEdit edit;
  edit.title = "accept a link";
  edit.steps.emplace_back(DeleteLinks{{link.id}});
  edit.steps.emplace_back(AddLinks{{std::move(accepted)}, true});
  return edit;
}

// Whether one of the links joins two scans that are relaxed. What only ties new scans to them leaves the
// relaxed poses as right as they were.
static bool concernsRelaxed(const ProjectSnapshot& base, const std::vector<Link>& links) {
  const auto relaxed = [&base](ScanId id) {
    const ScanEntry* scan = base.find(id);
    return scan && scan->pose(Stage::Relaxed);
  };
  return std::ranges::any_of(links, [&](const Link& l) { return relaxed(l.fixed) && relaxed(l.moving); });
}

ProjectEdit registerEdit(SnapshotPtr base, std::vector<Link> links,
                         std::vector<std::pair<ScanId, Pose>> pairwise) {
  ProjectEdit edit;
  edit.title = "register " + counted(links.size(), "pair");
  edit.base = std::move(base);
  edit.concerned = scansOf(pairwise);
  for (const Link& link : links) {
    edit.concerned.push_back(link.fixed);
    edit.concerned.push_back(link.moving);
  }
  const bool clear = !edit.base || concernsRelaxed(*edit.base, links);
  edit.steps.push_back(AddLinks{std::move(links), true});
  edit.steps.push_back(SetPoses{Stage::Pairwise, std::move(pairwise)});
  if (clear) edit.steps.push_back(ClearPoses{Stage::Relaxed});
  return edit;
}

ProjectEdit relaxEdit(SnapshotPtr base, std::vector<std::pair<ScanId, Pose>> relaxed) {
  ProjectEdit edit = posesEdit(Stage::Relaxed, std::move(relaxed));
  edit.title = "relax " + counted(std::get<SetPoses>(edit.steps.front()).poses.size(), "scan");
  edit.concerned = scansOf(std::get<SetPoses>(edit.steps.front()).poses);
  edit.base = std::move(base);
  return edit;
}

ProjectEdit posesEdit(Stage stage, std::vector<std::pair<ScanId, Pose>> poses) {
  return oneStep("set " + counted(poses.size(), stageName(stage) + " pose"),
                 SetPoses{stage, std::move(poses)});
}

Result<ProjectEdit> rebaseEdit(SnapshotPtr base, ScanId scan, const Pose& world_from_scan) {
  const ScanEntry* anchor = base->find(scan);
  if (!anchor)
    return fail("there is no scan with id " + std::to_string(scan) + " in the project", base->path().string(),
                "choose one of its scans");
  ProjectEdit edit;
  edit.title = "re-base on " + anchor->name;
  for (const auto& [stage, world_from_anchor] : anchor->poses) {
    const Pose new_from_old = world_from_scan * world_from_anchor.inverse();
    SetPoses step{stage, {}};
    for (const ScanEntry& other : base->scans())
      if (const auto pose = other.pose(stage))
        step.poses.emplace_back(other.id, other.id == scan ? world_from_scan : new_from_old * *pose);
    edit.steps.push_back(std::move(step));
  }
  edit.base = std::move(base);
  return edit;
}

namespace {

AddScan copyOf(const ScanEntry& entry, const Pose& world_from_other) {
  AddScan add;
  add.scan = Scan{nullptr, entry.geometry, world_from_other * entry.odometry(), entry.name, entry.source};
  add.load_image = [entry] { return entry.image(); };
  for (const auto& [stage, pose] : entry.poses)
    if (stage != Stage::Odometry) add.poses.emplace(stage, world_from_other * pose);
  add.note = entry.note;
  add.colour = entry.colour;
  for (const Photograph& photograph : entry.photographs) {
    NewPhotograph copy{photograph.caption, photograph.media_type, photograph.path, {}, {}};
    if (copy.path.empty())
      copy.load_bytes = [entry, id = photograph.id] { return entry.photographBytes(id); };
    add.photographs.push_back(std::move(copy));
  }
  return add;
}

}  // namespace

ProjectEdit mergeEdit(const ProjectSnapshot& into, const ProjectSnapshot& other,
                      const Pose& world_from_other_world) {
  ProjectEdit edit;
  edit.title = "merge " + counted(other.scans().size(), "scan") + " from " + other.path().filename().string();
  for (const ScanEntry& entry : other.scans()) edit.steps.push_back(copyOf(entry, world_from_other_world));
  AddLinks links{other.links(), false};
  for (Link& link : links.links) {
    link.fixed = addedScan(other.indexOf(link.fixed).value());
    link.moving = addedScan(other.indexOf(link.moving).value());
  }
  if (!links.links.empty()) edit.steps.push_back(std::move(links));
  SurveyInfo survey = into.survey();
  const auto fill = [](std::string& ours, const std::string& theirs) {
    if (ours.empty()) ours = theirs;
  };
  fill(survey.site, other.survey().site);
  fill(survey.operator_name, other.survey().operator_name);
  fill(survey.device, other.survey().device);
  fill(survey.date, other.survey().date);
  if (const auto& site_from_other = other.survey().site_from_world;
      !survey.site_from_world && site_from_other)
    survey.site_from_world = *site_from_other * world_from_other_world.inverse();
  if (!(survey == into.survey())) edit.steps.push_back(SetSurvey{survey});
  edit.jobs = other.jobs();
  return edit;
}

std::optional<Pose> mergePlacement(const ProjectSnapshot& into, const ProjectSnapshot& other) {
  if (into.scans().empty() && !into.survey().site_from_world) return Pose();
  const auto& ours = into.survey().site_from_world;
  const auto& theirs = other.survey().site_from_world;
  if (!ours || !theirs) return std::nullopt;
  return ours->inverse() * *theirs;
}

}  // namespace tiltmap
