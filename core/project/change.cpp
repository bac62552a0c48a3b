// What two snapshots differ in.
#include <algorithm>
#include <set>

#include "core/project/project_edit.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

namespace {

bool same(const Pose& a, const Pose& b) {
  return a.translation() == b.translation() && a.quaternion().coeffs() == b.quaternion().coeffs();
}

bool same(const Photograph& a, const Photograph& b) {
  return a.id == b.id && a.caption == b.caption && a.media_type == b.media_type && a.path == b.path;
}

bool sameBesidePoses(const ScanEntry& a, const ScanEntry& b) {
  return a.name == b.name && a.source == b.source && a.note == b.note && a.colour == b.colour &&
         a.matrix == b.matrix && a.lines == b.lines && a.geometry_id == b.geometry_id &&
         std::ranges::equal(a.photographs, b.photographs,
                            [](const auto& p, const auto& q) { return same(p, q); });
}

bool same(const std::optional<SitePicture>& a, const std::optional<SitePicture>& b) {
  if (!a || !b) return !a && !b;
  return a->attachment == b->attachment && sitePictureText(*a) == sitePictureText(*b);
}

// The stages at which the pose was added, removed or moved.
void addChangedStages(const std::map<Stage, Pose>& a, const std::map<Stage, Pose>& b,
                      std::set<Stage>& stages) {
  for (const Stage stage : kStages) {
    const auto in_a = a.find(stage);
    const auto in_b = b.find(stage);
    if ((in_a == a.end()) != (in_b == b.end()) || (in_a != a.end() && !same(in_a->second, in_b->second)))
      stages.insert(stage);
  }
}

// Of a link only its state and its judgement ever change.
void compareLinks(const ProjectSnapshot& before, const ProjectSnapshot& after, Change& change) {
  for (const Link& link : after.links()) {
    const Link* old = before.findLink(link.id);
    if (!old) {
      change.links_added.push_back(link.id);
    } else if (old->state != link.state || !sameJudgement(old->judgement.get(), link.judgement.get())) {
      change.links_changed.push_back(link.id);
    }
  }
  for (const Link& link : before.links())
    if (!after.findLink(link.id)) change.links_removed.push_back(link.id);
}

std::vector<ScanId> commonOrder(const ProjectSnapshot& of, const ProjectSnapshot& other) {
  std::vector<ScanId> order;
  for (const ScanEntry& scan : of.scans())
    if (other.find(scan.id)) order.push_back(scan.id);
  return order;
}

}  // namespace

Change changeBetween(const ProjectSnapshot& before, const ProjectSnapshot& after) {
  Change change;
  change.revision = after.revision();
  std::set<Stage> stages;
  for (const ScanEntry& scan : after.scans()) {
    const ScanEntry* old = before.find(scan.id);
    if (!old) {
      change.scans_added.push_back(scan.id);
      addChangedStages({}, scan.poses, stages);
      continue;
    }
    std::set<Stage> moved;
    addChangedStages(old->poses, scan.poses, moved);
    if (!moved.empty() || !sameBesidePoses(*old, scan)) change.scans_changed.push_back(scan.id);
    stages.merge(moved);
  }
  for (const ScanEntry& scan : before.scans()) {
    if (after.find(scan.id)) continue;
    change.scans_removed.push_back(scan.id);
    addChangedStages(scan.poses, {}, stages);
  }
  change.stages_changed.assign(stages.begin(), stages.end());
  compareLinks(before, after, change);
  change.order_changed = commonOrder(before, after) != commonOrder(after, before);
  change.survey_changed = !(before.survey() == after.survey()) || before.pins() != after.pins() ||
                          !same(before.sitePicture(), after.sitePicture());
  change.jobs_changed = !std::ranges::equal(before.jobs(), after.jobs(), {}, &JobRecord::id, &JobRecord::id);
  return change;
}

}  // namespace tiltmap
