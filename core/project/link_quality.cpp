#include "core/project/link_quality.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr double kFailed = 1e6;
constexpr double kNotJudged = 1.0;  // as good as can be doubted
constexpr double kDoubtOnly = 1.99;

// 1 at the good limit, 2 at the bad one.
double contradiction(const LinkAgreement& others, const JudgementSettings& s) {
  if (!others.supported) return 0.0;
  if (others.off.translation_m <= s.others_least_m && others.off.rotation_rad <= s.others_least_rad)
    return 0.0;
  const double badness =
      others.deviations <= s.others_good
          ? others.deviations / std::max(s.others_good, 1e-12)
          : 1.0 + (others.deviations - s.others_good) / std::max(s.others_bad - s.others_good, 1e-12);
  return others.own ? badness : std::min(badness, kDoubtOnly);
}

std::string timesWords(double deviations) {
  return fixedReal(deviations, deviations < 10.0 ? 1 : 0) + " times what they are uncertain by";
}

std::string contradictionWords(const LinkAgreement& others) {
  std::string words = "the other links put it " + differenceWords(others.off) + " elsewhere, " +
                      timesWords(others.deviations);
  if (!others.own) words += "; others of its loop contradict as much, one of them is wrong";
  return words;
}

LinkQuality qualityOf(double badness) {
  return badness <= 1.0 ? LinkQuality::Good : badness <= 2.0 ? LinkQuality::Doubtful : LinkQuality::Bad;
}

// Of a link that is found: by its scans and by the others, the worse one.
void decide(LinkJudgement& judgement, const JudgementSettings& settings) {
  const double by_others = contradiction(judgement.others, settings);
  if (judgement.by_scans) {
    judgement.badness = judgement.by_scans->badness;
    judgement.reason = judgement.by_scans->reason;
    judgement.quality = judgement.by_scans->verdict == Verdict::Good       ? LinkQuality::Good
                        : judgement.by_scans->verdict == Verdict::Doubtful ? LinkQuality::Doubtful
                                                                           : LinkQuality::Bad;
  } else {
    judgement.badness = kNotJudged;
    judgement.reason = "its scans were not held against each other: judge it";
    judgement.quality = LinkQuality::NotJudged;
  }
  if (by_others <= std::max(1.0, judgement.badness)) return;
  judgement.badness = by_others;
  judgement.quality = qualityOf(by_others);
  judgement.reason = contradictionWords(judgement.others);
}

}  // namespace

const std::string& linkQualityName(LinkQuality quality) {
  static const std::array<std::string, 6> names = {"good",       "doubtful", "bad",
                                                   "not judged", "failed",   "disabled"};
  return names.at(static_cast<std::size_t>(quality));
}

std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                                      Stage stage, const std::vector<LinkAgreement>& agreements,
                                      const JudgementSettings& settings) {
  const std::vector<Pose> poses = snapshot.filledPoses(stage);
  std::vector<LinkJudgement> judgements;
  for (const Link& link : links) {
    LinkJudgement judgement;
    judgement.link = link.id;
    judgement.by_scans = link.judgement;
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (fixed && moving)
      judgement.off = difference(poses[*fixed].inverse() * poses[*moving], link.fixed_from_moving);
    const auto others = std::ranges::lower_bound(agreements, link.id, {}, &LinkAgreement::link);
    if (others != agreements.end() && others->link == link.id) judgement.others = *others;
    judgement.others.link = link.id;
    decide(judgement, settings);
    if (!link.succeeded) {
      judgement.quality = LinkQuality::Failed;
      judgement.badness = kFailed;
      judgement.reason = "registration ended with: " + link.stop_reason;
    } else if (link.state == LinkState::Disabled) {
      judgement.quality = LinkQuality::Disabled;
      judgement.badness = 0.0;
      judgement.reason = "disabled: nothing is computed from it; it was: " + judgement.reason;
    }
    judgements.push_back(std::move(judgement));
  }
  return judgements;
}

std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage,
                                      const std::vector<LinkAgreement>& agreements,
                                      const JudgementSettings& settings) {
  return judgeLinks(snapshot, snapshot.links(), stage, agreements, settings);
}

std::vector<LinkJudgement> judgeLinks(const ProjectSnapshot& snapshot, Stage stage) {
  const JudgementSettings settings = judgementSettingsOf(snapshot);
  return judgeLinks(snapshot, stage, linkAgreements(snapshot, settings), settings);
}

JudgementSettings judgementSettingsOf(const ProjectSnapshot& snapshot) {
  JudgementSettings settings;
  const ParameterTable<JudgementSettings>& table = judgementParameters();
  for (const JobRecord& job : snapshot.jobs()) {
    if (job.operation != table.operation()) continue;
    ParameterValues values;
    for (const ParameterInfo& info : table.infos())
      if (const auto value = job.values.find(info.name); value != job.values.end()) values.insert(*value);
    JudgementSettings used;
    if (table.apply(values, used)) settings = used;
  }
  return settings;
}

std::vector<JudgementLine> linkLines(const LinkJudgement& judgement) {
  std::vector<JudgementLine> lines;
  if (judgement.by_scans) lines = judgementLines(*judgement.by_scans);
  const LinkAgreement& others = judgement.others;
  lines.push_back(
      {"Other links",
       others.supported
           ? "put it " + differenceWords(others.off) + " elsewhere, " + timesWords(others.deviations)
           : "no others tie these two scans",
       "Where the other links together put the two scans, against this one, and that over what both are "
       "uncertain by"});
  lines.push_back({"Loop",
                   others.loop > 0 ? "of " + std::to_string(others.loop) + " links, closes within " +
                                         differenceWords(others.misclosure)
                                   : "in none",
                   "How far the shortest loop of links through this one is from closing"});
  return lines;
}

std::string linkText(const LinkJudgement& judgement) {
  std::string text = linkQualityName(judgement.quality) + ": " + judgement.reason;
  for (const JudgementLine& line : linkLines(judgement)) text += "\n" + line.name + ": " + line.value;
  return text;
}

}  // namespace tiltmap
