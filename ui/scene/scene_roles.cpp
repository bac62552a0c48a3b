// What a relaxation makes of the stops, and where they would be without some links: marks over the points.
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/scene/scene_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

// As the site map has them, so that one legend serves both.
OverlayMark markOf(RelaxationRole role, Rgb fill, const SceneColours& colours) {
  OverlayMark mark;
  mark.fill = fill;
  mark.ring = colours.no_data;
  switch (role) {
    case RelaxationRole::None:
      break;
    case RelaxationRole::Held:
      mark.square = true;
      mark.ring = colours.text;
      break;
    case RelaxationRole::Active:
      mark.ring = colours.active;
      break;
    case RelaxationRole::Waiting:
      mark.full = false;
      mark.ring = colours.text;
      break;
    case RelaxationRole::Queued:
      mark.ring = colours.queued;
      mark.rings = 1;
      break;
    case RelaxationRole::Aligning:
      mark.ring = colours.aligning;
      mark.rings = 2;
      break;
  }
  return mark;
}

}  // namespace

void Scene::setRoles(SceneRoles roles) {
  Parts& p = *parts_;
  if (roles == p.roles) return;
  const auto before = std::exchange(p.roles, std::move(roles));
  // The points are drawn anew only where a scan becomes pale or full.
  bool inks = false;
  for (const auto& cloud : p.clouds) {
    const auto was = before.of.find(cloud->points.scan);
    const bool was_pale = was != before.of.end() && was->second == RelaxationRole::Waiting;
    if (was_pale == p.isPale(cloud->points.scan)) continue;
    cloud->batch.ink = p.inkOf(*cloud);
    inks = true;
  }
  if (inks) ++p.content;
}

void Scene::setGhosts(std::map<ScanId, Pose> world_from_scan) {
  parts_->ghosts = std::move(world_from_scan);
}

void Scene::setStageWords(std::map<Stage, std::string> words) {
  parts_->stage_words = std::move(words);
}

std::string Scene::Parts::wordsOf(Stage of) const {
  const auto words = stage_words.find(of);
  return words == stage_words.end() ? utf8(stageTitle(of)) : words->second;
}

void Scene::Parts::writeRoles(OverlayContents& contents, const Scene& scene) const {
  if (!snapshot || (roles.of.empty() && ghosts.empty())) return;
  const int side = compare == SceneCompare::Blink && shows_before ? 1 : 0;
  std::map<ScanId, Vector2d> places;
  const auto seen = [&](const Vector3d& at) -> std::optional<Vector2d> {
    // Behind the eye a place would be mirrored into the picture.
    if (!camera.orthographic && camera.forward().dot(at - camera.position) <= 0.0) return {};
    return scene.pixelOf(at);
  };
  const auto& poses = stops[static_cast<std::size_t>(side)];
  for (std::size_t i = 0; i < poses.size() && i < snapshot->scans().size(); ++i)
    if (const auto place = seen(poses[i].translation())) places[snapshot->scans()[i].id] = *place;
  ScanId aligning = 0;
  for (const auto& [scan, role] : roles.of)
    if (role == RelaxationRole::Aligning) aligning = scan;
  if (places.contains(aligning))
    for (const ScanId other : roles.onto)
      if (places.contains(other))
        contents.lines.push_back({places[aligning], places[other], colours.aligning});
  for (const auto& [scan, pose] : ghosts) {
    const auto at = seen(pose.translation());
    if (!at || !places.contains(scan)) continue;
    contents.lines.push_back({places[scan], *at, colours.queued});
    OverlayMark ring;
    ring.pixel = *at;
    ring.full = false;
    ring.ring = colours.queued;
    contents.marks.push_back(ring);
  }
  // Those that something happens to on top.
  for (const RelaxationRole drawn : {RelaxationRole::Waiting, RelaxationRole::Active, RelaxationRole::Held,
                                     RelaxationRole::Queued, RelaxationRole::Aligning})
    for (const auto& [scan, role] : roles.of) {
      if (role != drawn || !places.contains(scan)) continue;
      const SceneCloud* cloud = cloudOf(scan);
      contents.marks.push_back(markOf(role, cloud ? inkOf(*cloud) : colours.no_data, colours));
      contents.marks.back().pixel = places[scan];
    }
  for (const auto& [role, text] : roles.legend)
    contents.legend.emplace_back(markOf(role, colours.no_data, colours), text);
}

}  // namespace tiltmap::ui
