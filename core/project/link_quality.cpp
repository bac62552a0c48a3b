#include "core/project/link_quality.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"
#include "core/registration/pose_strength.h"

namespace tiltmap {

namespace {

struct Figure {
  double badness = 0.0;
  std::string reason;
};

// Figures as people compare them; the one that is furthest beyond its limit decides.
Figure worstOf(const Link& link, const PoseDifference& off, const LinkQualityLimits& limits) {
  const auto mm = [](double metres) { return fixedReal(1000.0 * metres, 0) + " mm"; };
  const JudgementSettings& judged = limits.judgement;
  const PoseStrength strength = strengthOf(link.information.value_or(Matrix6d::Zero()),
                                           link.fixed_from_moving, judged.covariance_cells);
  const double weak = std::max(2.0 * strength.weakest_m / judged.weak_good_m,
                               2.0 * strength.weakest_rad / judged.weak_good_rad);
  std::array<Figure, 5> figures = {
      Figure{link.information ? weak : 0.0,
             "the pose " + strengthSentence(strength, judged.weak_good_m, judged.weak_good_rad)},
      Figure{limits.overlap / std::max(link.overlap, 1e-3),
             "overlap " + fixedReal(100.0 * link.overlap, 0) + " %: they see little in common"},
      Figure{link.rms_m / limits.rms_m, "residual " + mm(link.rms_m) + ": the surfaces do not fit well"},
      Figure{off.translation_m / limits.off_m,
             mm(off.translation_m) + " from where the poses put the two scans"},
      Figure{off.rotation_rad / limits.off_rad,
             fixedReal(off.rotation_rad / kDegree, 2) + "° from how the poses turn the two scans"}};
  return *std::ranges::max_element(figures, {}, &Figure::badness);
}

constexpr double kFailed = 1e6;

}  // namespace

const std::string& linkQualityName(LinkQuality quality) {
  static const std::array<std::string, 5> names = {"good", "fair", "doubtful", "failed", "disabled"};
  return names.at(static_cast<std::size_t>(quality));
}

std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage,
                                      const LinkQualityLimits& limits) {
  const std::vector<Pose> poses = snapshot.filledPoses(stage);
  std::vector<LinkJudgement> judgements;
  for (const Link& link : snapshot.links()) {
    LinkJudgement judgement;
    judgement.link = link.id;
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (fixed && moving)
      judgement.off = difference(poses[*fixed].inverse() * poses[*moving], link.fixed_from_moving);
    Figure worst = worstOf(link, judgement.off, limits);
    // What a person set, or odometry said, was not measured on surfaces.
    if (link.origin != LinkOrigin::Automatic && link.correspondences == 0)
      worst = {judgement.off.translation_m / limits.off_m, "set by hand; no surfaces were compared"};
    judgement.badness = worst.badness;
    judgement.quality = worst.badness <= 1.0   ? LinkQuality::Good
                        : worst.badness <= 2.0 ? LinkQuality::Fair
                                               : LinkQuality::Doubtful;
    judgement.reason =
        worst.badness <= 1.0 ? "overlap, residual and place are within their limits" : worst.reason;
    if (!link.succeeded) {
      judgement.quality = LinkQuality::Failed;
      judgement.badness = kFailed;
      judgement.reason = "registration ended with: " + link.stop_reason;
    } else if (link.state == LinkState::Disabled) {
      judgement.quality = LinkQuality::Disabled;
      judgement.badness = 0.0;
      judgement.reason = "disabled: nothing is computed from it";
    }
    judgements.push_back(std::move(judgement));
  }
  return judgements;
}

}  // namespace tiltmap
