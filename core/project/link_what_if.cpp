#include "core/project/link_what_if.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/project/link_system.h"

namespace tiltmap {

namespace {

constexpr double kByHand_m = 0.02;
constexpr double kByHand_rad = 0.5 * kDegree;
// Of two figures, the one that is worth calling smaller, and what is not worth calling off.
constexpr double kClearly = 0.7;
constexpr double kNoticeable_m = 0.01;

// Whether the two scans hang together through the ties.
bool joined(const LinkTie& tie, const std::vector<LinkTie>& ties, std::size_t count) {
  std::vector<char> from(count, 0);
  from[static_cast<std::size_t>(tie.fixed)] = 1;
  std::vector<PairTerm> terms;
  for (const LinkTie& other : ties) terms.push_back({other.fixed, other.moving, Pose(), {}, {}});
  return tiedToHeld(count, from, terms)[static_cast<std::size_t>(tie.moving)] != 0;
}

double rmsOf(const std::vector<LinkTie>& ties, const std::vector<Pose>& poses) {
  double sum = 0.0;
  for (const LinkTie& tie : ties) sum += std::pow(offOf(tie, poses).translation_m, 2);
  return ties.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(ties.size()));
}

std::string millimetres(double metres) {
  return metres < 1.0 ? fixedReal(1000.0 * metres, metres < 0.01 ? 1 : 0) + " mm"
                      : fixedReal(metres, 2) + " m";
}

}  // namespace

Matrix6d informationByHand() {
  Vector6d information;
  information << Eigen::Vector3d::Constant(1.0 / (kByHand_rad * kByHand_rad)),
      Eigen::Vector3d::Constant(1.0 / (kByHand_m * kByHand_m));
  return information.asDiagonal();
}

Result<LinkWhatIf> whatIfWithout(const ProjectSnapshot& snapshot, const std::vector<LinkId>& left_out) {
  for (const LinkId id : left_out) {
    const Link* link = snapshot.findLink(id);
    if (!link)
      return fail("there is no link " + std::to_string(id), snapshot.path().string(),
                  "choose one of the project's links");
    if (!link->succeeded)
      return fail("link " + linkPairName(snapshot, *link) + " failed, so nothing is computed from it anyway",
                  snapshot.path().string(), "choose one that was found");
  }
  std::vector<LinkTie> all, others, out;
  for (const Link& link : snapshot.links()) {
    const bool left = std::ranges::find(left_out, link.id) != left_out.end();
    if (!link.succeeded || (!left && link.state == LinkState::Disabled)) continue;
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving) continue;
    const LinkTie tie{&link, static_cast<int>(*fixed), static_cast<int>(*moving),
                      link.information.value_or(informationByHand())};
    all.push_back(tie);
    (left ? out : others).push_back(tie);
  }
  const std::size_t count = snapshot.scans().size();
  std::vector<char> pinned(count, 0);
  if (count > 0) pinned.front() = 1;
  for (const ScanId pin : snapshot.pins()) pinned[*snapshot.indexOf(pin)] = 1;

  auto before = solveTies(all, snapshot.filledPoses(snapshot.latestStage()), pinned);
  if (!before) return fail(before.error());
  auto after = solveTies(others, before->world_from_scan, pinned);
  if (!after) return fail(after.error());
  LinkWhatIf result;
  for (const LinkTie& tie : all) {
    const bool left = std::ranges::find(left_out, tie.link->id) != left_out.end();
    result.links.push_back({tie.link->id, left, offOf(tie, before->world_from_scan),
                            offOf(tie, after->world_from_scan), !left || joined(tie, others, count)});
  }
  for (std::size_t i = 0; i < count; ++i) {
    result.moved.push_back(difference(before->world_from_scan[i], after->world_from_scan[i]));
    if (before->tied[i] && !after->tied[i]) result.separated.push_back(static_cast<int>(i));
  }
  result.rms_before_m = rmsOf(others, before->world_from_scan);
  result.rms_after_m = rmsOf(others, after->world_from_scan);
  result.before = std::move(before->world_from_scan);
  result.after = std::move(after->world_from_scan);
  return result;
}

std::string whatIfText(const ProjectSnapshot& snapshot, const LinkWhatIf& what_if) {
  std::string text;
  for (const LinkVerdict& verdict : what_if.links) {
    if (!verdict.left_out) continue;
    const Link* link = snapshot.findLink(verdict.link);
    if (!link) continue;
    text += "Link " + linkPairName(snapshot, *link) + ": ";
    if (!verdict.supported)
      text += "no other links tie these two scans, so nothing speaks for or against it. ";
    else
      text += "the others put scan " + std::to_string(snapshot.indexOf(link->moving).value_or(0)) + " " +
              millimetres(verdict.after.translation_m) + " and " +
              fixedReal(verdict.after.rotation_rad / kDegree, 2) + "° from where it says. ";
  }
  const bool any_left = std::ranges::any_of(what_if.links, [](const auto& v) { return !v.left_out; });
  if (any_left) {
    text += "The links that stay are off by " + millimetres(what_if.rms_before_m) + " with it and " +
            millimetres(what_if.rms_after_m) + " without";
    if (what_if.rms_before_m > kNoticeable_m && what_if.rms_after_m < kClearly * what_if.rms_before_m)
      text += ": it contradicts them. ";
    else
      text += ": it agrees with them. ";
  }
  if (!what_if.separated.empty()) {
    text += what_if.separated.size() == 1 ? "Scan " : "Scans ";
    for (std::size_t i = 0; i < what_if.separated.size(); ++i)
      text += (i > 0 ? ", " : "") + std::to_string(what_if.separated[i]);
    text += " would hang on nothing and keep " +
            std::string(what_if.separated.size() == 1 ? "its pose." : "their poses.");
  } else {
    double furthest = 0.0;
    for (const PoseDifference& moved : what_if.moved) furthest = std::max(furthest, moved.translation_m);
    text += "Scans would move by up to " + millimetres(furthest) + ".";
  }
  return text;
}

}  // namespace tiltmap
