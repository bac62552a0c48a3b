// How far a link can be trusted by what is stored of it, without reading its scans (link_judgement.h does
// that).
#pragma once

#include <string>
#include <vector>

#include "core/project/project_snapshot.h"
#include "core/registration/judgement_settings.h"

namespace tiltmap {

// From best to worst; a disabled link is not judged.
enum class LinkQuality { Good, Fair, Doubtful, Failed, Disabled };
const std::string& linkQualityName(LinkQuality quality);  // "good", "fair", ...

// Fair begins where one figure is beyond its limit, doubtful at twice it (half the overlap). Ours.
struct LinkQualityLimits {
  double overlap = 0.30;           // share, at least
  double rms_m = 0.05;             // at most
  double off_m = 0.05;             // from where the stage puts the two scans, at most
  double off_rad = 0.3 * kDegree;  // likewise
  JudgementSettings judgement;     // of weak directions, as pairs are judged by their scans
};

struct LinkJudgement {
  LinkId link = 0;
  LinkQuality quality = LinkQuality::Good;
  // How bad the worst figure is: 1 at its limit, 2 at twice it. Links in descending order are the worst
  // first; failed ones stand above all, disabled ones below.
  double badness = 0.0;
  PoseDifference off;  // the link's own pose against that of the stage
  std::string reason;  // "overlap 12 %: they see little in common"
};

// By id, as the snapshot has them.
std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage,
                                      const LinkQualityLimits& limits = {});

}  // namespace tiltmap
