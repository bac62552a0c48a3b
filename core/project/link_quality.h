// How far each link can be trusted: by its two scans, as stored with it, and by what the other links say.
// Reads no scans (link_judgement.h does that).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/project/link_agreement.h"
#include "core/registration/judgement_words.h"

namespace tiltmap {

// NotJudged: nobody held the two scans against each other, or they have changed since. A disabled link is not
// counted.
enum class LinkQuality { Good, Doubtful, Bad, NotJudged, Failed, Disabled };
const std::string& linkQualityName(LinkQuality quality);  // "good", ..., "not judged"

struct LinkJudgement {
  LinkId link = 0;
  LinkQuality quality = LinkQuality::NotJudged;
  // The worse of the two below, up to 1 good, up to 2 doubtful, beyond bad. In descending order the worst
  // come first: failed ones above all, those not judged between doubtful and good, disabled ones last.
  double badness = 0.0;
  std::string
      reason;  // of the figure that decided: "the other links put it 12 cm and 0.50 deg elsewhere ..."
  std::shared_ptr<const PairJudgement> by_scans;  // null: not judged
  LinkAgreement others;
  PoseDifference off;  // the link's own pose against that of the stage; decides nothing
};

// By id, as the snapshot has them. `agreements`: those of linkAgreements for this snapshot's links, computed
// once for many calls; links that are not among them are judged by their scans alone.
std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage,
                                      const std::vector<LinkAgreement>& agreements,
                                      const JudgementSettings& settings);
// The same with the agreements computed here, by judgementSettingsOf.
std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage);
// The same of links that are not in the snapshot as they are here (ascending ids, scans of the snapshot).
std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                                      Stage stage, const std::vector<LinkAgreement>& agreements,
                                      const JudgementSettings& settings);
// Limits as the project's links were judged last (operation `judge`), else the program's own.
JudgementSettings judgementSettingsOf(const ProjectSnapshot& snapshot);

// Every figure in words: those of judgementLines, what the others say, and the loop.
std::vector<JudgementLine> linkLines(const LinkJudgement& judgement);
// Verdict, reason and figures below each other, for a tip.
std::string linkText(const LinkJudgement& judgement);

}  // namespace tiltmap
