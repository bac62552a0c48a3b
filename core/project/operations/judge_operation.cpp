#include "core/project/operations/judge_operation.h"

#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/project/judgement_json.h"
#include "core/project/link_judgement.h"
#include "core/project/operations/index_list.h"

namespace tiltmap {

namespace {

struct JudgeSettings {
  std::string links;
  int threads = 0;
  JudgementSettings judgement;
};

const ParameterTable<JudgeSettings>& judgeTable() {
  static const ParameterTable<JudgeSettings> table = [] {
    ParameterTable<JudgeSettings> t("judge");
    t.text("links", &JudgeSettings::links,
           "Links to judge, by number: 3,5-8; empty: all. What the others say is told of all", "ours");
    t.integer("threads", &JudgeSettings::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    t.include(judgementParameters(), &JudgeSettings::judgement);
    return t;
  }();
  return table;
}

Result<std::vector<LinkId>> chosenLinks(const ProjectSnapshot& snapshot, const std::string& text) {
  if (snapshot.links().empty())
    return fail("there are no links to judge", snapshot.path().string(), "register pairs first");
  std::vector<LinkId> chosen;
  if (text.empty()) return chosen;
  const LinkId last = std::min<LinkId>(snapshot.links().back().id, std::numeric_limits<int>::max() - 1);
  const auto list = parseIndexList(text, static_cast<int>(last) + 1, "links");
  const std::string remedy = "choose links that `tiltmap link list` shows, such as 3,5-8";
  if (!list) return fail("\"" + text + "\" names no links of this project", "links", remedy);
  for (const int id : *list) {
    if (!snapshot.findLink(id)) return fail("there is no link " + std::to_string(id), "links", remedy);
    chosen.push_back(id);
  }
  return chosen;
}

class JudgeOperation : public SettingsOperation<JudgeSettings> {
 public:
  JudgeOperation() : SettingsOperation(judgeTable()) {}
  std::string title() const override { return "Judge links"; }
  std::string help() const override {
    return "Holds the scans of each link against each other at the link's pose, and the links against each "
           "other: whether each can be trusted, and why.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const JudgeSettings& settings) const override {
    return chosenLinks(snapshot, settings.links).map([](const std::vector<LinkId>&) {});
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const JudgeSettings& settings,
                                      const JobControl& control) const override {
    const auto chosen = chosenLinks(*snapshot, settings.links);
    if (!chosen) return fail(chosen.error());
    const auto judged = judgeLinkScans(*snapshot, settings.threads, settings.judgement, control, *chosen);
    if (!judged) return fail(judged.error());
    OperationResult outcome;
    outcome.edit = storeJudgementsEdit(snapshot, *judged);
    outcome.report_json = report(*snapshot, *judged, settings.judgement, outcome.warnings).dump();
    return outcome;
  }

 private:
  // Of the links as they will be.
  static nlohmann::json report(const ProjectSnapshot& snapshot, const std::vector<JudgedLink>& judged,
                               const JudgementSettings& settings, std::vector<std::string>& warnings) {
    std::vector<Link> links = snapshot.links();
    for (const JudgedLink& one : judged)
      std::ranges::find(links, one.link, &Link::id)->judgement =
          std::make_shared<const PairJudgement>(one.judgement);
    const auto judgements = judgeLinks(snapshot, links, snapshot.latestStage(),
                                       linkAgreements(snapshot, links, settings), settings);
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t k = 0; k < links.size(); ++k) {
      list.push_back(linkJson(snapshot, links[k], judgements[k]));
      if (judgements[k].quality == LinkQuality::Bad)
        warnings.push_back("link " + std::to_string(links[k].id) +
                           " is not to be trusted: " + judgements[k].reason);
    }
    return {{"links", std::move(list)}};
  }
};

}  // namespace

std::unique_ptr<Operation> makeJudgeOperation() {
  return std::make_unique<JudgeOperation>();
}

}  // namespace tiltmap
