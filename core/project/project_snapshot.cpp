#include "core/project/project_snapshot.h"

#include <algorithm>
#include <limits>
#include <ranges>

#include "core/project/image_store.h"

namespace tiltmap {

std::optional<Pose> ScanEntry::pose(Stage stage) const {
  const auto found = poses.find(stage);
  return found == poses.end() ? std::nullopt : std::optional(found->second);
}

Result<RangeImagePtr> ScanEntry::image() const {
  if (!store_) return fail("this stop is not part of a project", name, "add it to one first");
  return store_->image(matrix, lines, geometry_id, geometry);
}

Result<Scan> ScanEntry::scan() const {
  return image().map([this](RangeImagePtr loaded) {
    return Scan{std::move(loaded), geometry, odometry(), name, source};
  });
}

Result<std::vector<unsigned char>> ScanEntry::photographBytes(std::int64_t photograph) const {
  const bool ours = std::ranges::any_of(
      photographs, [&](const Photograph& p) { return p.id == photograph && p.path.empty(); });
  if (!store_ || !ours)
    return fail("no photograph " + std::to_string(photograph) + " is stored for this stop", name,
                "see the stop's list of photographs");
  return store_->photograph(photograph);
}

const ScanEntry* ProjectSnapshot::find(ScanId id) const {
  const auto found = index_.find(id);
  return found == index_.end() ? nullptr : &scans_[found->second];
}

std::optional<std::size_t> ProjectSnapshot::indexOf(ScanId id) const {
  const auto found = index_.find(id);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

Result<const ScanEntry*> ProjectSnapshot::scanAt(long long index) const {
  if (index >= 0 && index < static_cast<long long>(scans_.size()))
    return &scans_[static_cast<std::size_t>(index)];
  if (scans_.empty())
    return fail("the project has no scans", path_.string(), "import or simulate some first");
  return fail("there is no scan " + std::to_string(index), path_.string(),
              "give an index from 0 to " + std::to_string(scans_.size() - 1));
}

const Link* ProjectSnapshot::findLink(LinkId id) const {
  const auto found = std::ranges::lower_bound(links_, id, {}, &Link::id);
  return found != links_.end() && found->id == id ? &*found : nullptr;
}

std::vector<Link> ProjectSnapshot::linksOf(ScanId id) const {
  std::vector<Link> result;
  std::ranges::copy_if(links_, std::back_inserter(result),
                       [id](const Link& link) { return link.fixed == id || link.moving == id; });
  return result;
}

bool ProjectSnapshot::hasStage(Stage stage) const {
  return std::ranges::any_of(scans_, [stage](const ScanEntry& scan) { return scan.poses.contains(stage); });
}

std::vector<Stage> ProjectSnapshot::stages() const {
  std::vector<Stage> result;
  std::ranges::copy_if(kStages, std::back_inserter(result), [this](Stage stage) { return hasStage(stage); });
  return result;
}

Stage ProjectSnapshot::latestStage() const {
  if (hasStage(Stage::Relaxed)) return Stage::Relaxed;
  return hasStage(Stage::Pairwise) ? Stage::Pairwise : Stage::Odometry;
}

std::vector<std::optional<Pose>> ProjectSnapshot::poses(Stage stage) const {
  std::vector<std::optional<Pose>> result;
  for (const ScanEntry& scan : scans_) result.push_back(scan.pose(stage));
  return result;
}

std::vector<Pose> ProjectSnapshot::filledPoses(Stage stage) const {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  const auto known = poses(stage);
  std::size_t anchor = kNone;  // the first scan that has a pose, then always the last one passed
  for (std::size_t i = known.size(); i-- > 0;)
    if (known[i]) anchor = i;
  std::vector<Pose> result;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i]) anchor = i;
    if (anchor == kNone) {
      result.push_back(scans_[i].odometry());
    } else if (anchor == i) {
      result.push_back(*known[i]);
    } else {
      result.push_back(*known[anchor] * (scans_[anchor].odometry().inverse() * scans_[i].odometry()));
    }
  }
  return result;
}

bool ProjectSnapshot::isPinned(ScanId id) const {
  return std::ranges::find(pins_, id) != pins_.end();
}

Result<std::vector<unsigned char>> ProjectSnapshot::sitePictureBytes() const {
  if (!site_picture_ || !store_)
    return fail("the project has no picture of the site", path_.string(), "add one first");
  return store_->attachment(site_picture_->attachment);
}

SnapshotPtr ProjectSnapshot::withPoses(Stage stage, const std::vector<std::pair<ScanId, Pose>>& poses) const {
  auto changed = std::make_shared<ProjectSnapshot>(*this);
  for (const auto& [scan, pose] : poses)
    if (const auto index = indexOf(scan)) changed->scans_[*index].poses[stage] = pose;
  return changed;
}

bool ProjectSnapshot::canUndo() const {
  return std::ranges::any_of(history_, [](const HistoryEntry& e) { return !e.undone && !e.fixed; });
}

bool ProjectSnapshot::canRedo() const {
  return std::ranges::any_of(history_, &HistoryEntry::undone);
}

}  // namespace tiltmap
