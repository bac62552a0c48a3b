#include "core/registration/judgement_words.h"

#include "core/base/text.h"

namespace tiltmap {

std::string percentWords(double share) {
  return fixedReal(100.0 * share, 0) + " %";
}

std::string differenceWords(const PoseDifference& difference) {
  return lengthWords(difference.translation_m) + " and " + angleWords(difference.rotation_rad);
}

std::vector<JudgementLine> judgementLines(const PairJudgement& j) {
  const PoseStrength& s = j.strength;
  const auto two = [](double metres) { return lengthWords(2.0 * metres); };
  const auto turned = [](double radians) { return angleWords(2.0 * radians); };
  return {{"Overlap",
           percentWords(j.overlap_moving) + " of the moving scan, " + percentWords(j.overlap_fixed) +
               " of the fixed one",
           "Share of one scan's surfaces that lie on the other's, measured at this pose"},
          {"Fit",
           percentWords(j.fit) + " of what both could see; " + fixedReal(100.0 * j.through, 1) +
               " % stands in free space",
           "Of the surfaces both scans could see: the share that lies on the other, and the share that "
           "stands where the "
           "other looked through"},
          {"Residual",
           lengthWords(j.residual_m) + ", noise explains " + lengthWords(j.expected_m) + "; " +
               lengthWords(j.excess_m) + " beyond it",
           "Median distance of the surfaces that fit, what their own noise makes of it, and their deviation "
           "beyond that"},
          {"Held", j.strength_sentence,
           "How firmly the surfaces hold the pose in its weakest direction, two deviations"},
          {"Within",
           "right " + two(s.right_m) + ", forward " + two(s.forward_m) + ", up " + two(s.up_m) + "; pitch " +
               turned(s.pitch_rad) + ", roll " + turned(s.roll_rad) + ", heading " + turned(s.heading_rad),
           "Two deviations in each of the six directions of the machine that took the moving scan"},
          {"Still pulled", lengthWords(j.pull_m) + " and " + angleWords(j.pull_rad),
           "How far the surfaces still pull the pose elsewhere"},
          {"Moved", differenceWords(j.moved) + " from its start",
           "How far the pose lies from where the registration began"}};
}

}  // namespace tiltmap
