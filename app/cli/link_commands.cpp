// tiltmap link list|judge|add|delete|disable|enable|accept|what-if P.tiltmap ...: what a person thinks of the
// pairs that were registered.
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/project/link_judgement.h"
#include "core/project/link_quality.h"
#include "core/project/link_what_if.h"

namespace tiltmap::cli {

namespace {

struct LinkWords {
  std::string project;
  long long link = 0;
  long long fixed = 0, moving = 0;
  std::vector<long long> links;
};

Result<Link> linkOf(const ProjectSnapshot& snapshot, long long id) {
  if (const Link* link = snapshot.findLink(id)) return *link;
  return fail(
      "there is no link " + std::to_string(id), snapshot.path().string(),
      snapshot.links().empty() ? "register pairs first" : "choose one that `tiltmap link list` shows");
}

int listLinks(Context& context, const LinkWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text = "link  fixed  moving  overlap    rms mm  quality   state     origin     ended\n";
  const auto judged = judgeLinks(**snapshot, (*snapshot)->latestStage());
  std::size_t place = 0;
  for (const Link& link : (*snapshot)->links()) {
    const std::size_t fixed = (*snapshot)->indexOf(link.fixed).value();
    const std::size_t moving = (*snapshot)->indexOf(link.moving).value();
    const LinkJudgement& judgement = judged[place++];
    list.push_back({{"id", link.id},
                    {"fixed", fixed},
                    {"moving", moving},
                    {"overlap", link.overlap},
                    {"rms_m", link.rms_m},
                    {"quality", linkQualityName(judgement.quality)},
                    {"reason", judgement.reason},
                    {"off_m", judgement.off.translation_m},
                    {"off_deg", judgement.off.rotation_rad / kDegree},
                    {"state", linkStateName(link.state)},
                    {"origin", linkOriginName(link.origin)},
                    {"succeeded", link.succeeded},
                    {"stop_reason", link.stop_reason}});
    char line[140];
    std::snprintf(line, sizeof line, "%4lld  %5zu  %6zu  %5.0f %%  %8.2f  %-8s  %-8s  %-9s  ",
                  static_cast<long long>(link.id), fixed, moving, 100.0 * link.overlap, 1000.0 * link.rms_m,
                  linkQualityName(judgement.quality).c_str(), linkStateName(link.state).c_str(),
                  linkOriginName(link.origin).c_str());
    text += line + link.stop_reason + "\n";
  }
  context.console.printJson({{"links", list}});
  context.console.print(list.empty() ? "there are no links" : text);
  return kDone;
}

nlohmann::json judgementJson(const PairJudgement& j) {
  return {{"verdict", verdictName(j.verdict)},
          {"reason", j.reason},
          {"badness", j.badness},
          {"overlap_fixed", j.overlap_fixed},
          {"overlap_moving", j.overlap_moving},
          {"fit", j.fit},
          {"through", j.through},
          {"residual_m", j.residual_m},
          {"expected_m", j.expected_m},
          {"excess_m", j.excess_m},
          {"pull_m", j.pull_m},
          {"moved_m", j.moved.translation_m},
          {"moved_deg", j.moved.rotation_rad / kDegree},
          {"deviation_m", {j.strength.right_m, j.strength.forward_m, j.strength.up_m}},
          {"deviation_deg",
           {j.strength.pitch_rad / kDegree, j.strength.roll_rad / kDegree, j.strength.heading_rad / kDegree}},
          {"strength", j.strength_sentence}};
}

int judgeLinksByScans(Context& context, const LinkWords& words) {
  const auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto judged = judgeLinkScans(**snapshot);
  if (!judged) return context.console.failed(judged.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text = "link  fixed  moving  overlap    fit  verdict   why\n";
  for (const JudgedLink& one : *judged) {
    const Link& link = *(*snapshot)->findLink(one.link);
    const std::size_t fixed = (*snapshot)->indexOf(link.fixed).value();
    const std::size_t moving = (*snapshot)->indexOf(link.moving).value();
    nlohmann::json entry = judgementJson(one.judgement);
    entry["id"] = link.id, entry["fixed"] = fixed, entry["moving"] = moving;
    list.push_back(std::move(entry));
    char line[80];
    std::snprintf(line, sizeof line, "%4lld  %5zu  %6zu  %5.0f %%  %3.0f %%  %-8s  ",
                  static_cast<long long>(link.id), fixed, moving, 100.0 * one.judgement.overlap(),
                  100.0 * one.judgement.fit, verdictName(one.judgement.verdict).c_str());
    text += line + one.judgement.reason + "\n";
  }
  context.console.printJson({{"links", list}});
  context.console.print(list.empty() ? "there are no links" : text);
  return kDone;
}

Result<ProjectEdit> accepted(const Link& link) {
  if (link.succeeded) return acceptLinkEdit(link);
  return fail("link " + std::to_string(link.id) + " has nothing to accept: it ended with " + link.stop_reason,
              "tiltmap link accept", "register the pair again with other parameters");
}

Result<ProjectEdit> deleted(const Link& link) {
  ProjectEdit edit;
  edit.title = "delete a link";
  edit.steps.emplace_back(DeleteLinks{{link.id}});
  return edit;
}

int askWhatIf(Context& context, const LinkWords& words) {
  const auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto what_if = whatIfWithout(**snapshot, {words.links.begin(), words.links.end()});
  if (!what_if) return context.console.failed(what_if.error());
  nlohmann::json links = nlohmann::json::array();
  std::string text = "link  fixed  moving   off mm with   off mm without\n";
  for (const LinkVerdict& verdict : what_if->links) {
    const Link& link = *(*snapshot)->findLink(verdict.link);
    const std::size_t fixed = (*snapshot)->indexOf(link.fixed).value();
    const std::size_t moving = (*snapshot)->indexOf(link.moving).value();
    links.push_back({{"id", verdict.link},
                     {"fixed", fixed},
                     {"moving", moving},
                     {"left_out", verdict.left_out},
                     {"supported", verdict.supported},
                     {"before_m", verdict.before.translation_m},
                     {"after_m", verdict.after.translation_m},
                     {"before_deg", verdict.before.rotation_rad / kDegree},
                     {"after_deg", verdict.after.rotation_rad / kDegree}});
    char line[100];
    std::snprintf(line, sizeof line, "%4lld  %5zu  %6zu  %12.2f  %15.2f%s\n", static_cast<long long>(link.id),
                  fixed, moving, 1000.0 * verdict.before.translation_m, 1000.0 * verdict.after.translation_m,
                  verdict.left_out ? "  left out" : "");
    text += line;
  }
  nlohmann::json moved = nlohmann::json::array();
  for (std::size_t i = 0; i < what_if->moved.size(); ++i)
    moved.push_back({{"scan", i},
                     {"translation_m", what_if->moved[i].translation_m},
                     {"rotation_deg", what_if->moved[i].rotation_rad / kDegree}});
  const std::string words_of_it = whatIfText(**snapshot, *what_if);
  context.console.printJson({{"links", links},
                             {"moved", moved},
                             {"separated", what_if->separated},
                             {"rms_before_m", what_if->rms_before_m},
                             {"rms_after_m", what_if->rms_after_m},
                             {"text", words_of_it}});
  context.console.print(text + words_of_it);
  return kDone;
}

std::string addedText(const nlohmann::json& report) {
  char line[160];
  std::snprintf(line, sizeof line,
                "linked %d to %d: overlap %.0f %%, rms %.2f mm, %.1f mm and %.3f deg from the start",
                report["moving"].get<int>(), report["fixed"].get<int>(),
                100.0 * report["overlap"].get<double>(), 1000.0 * report["rms_m"].get<double>(),
                1000.0 * report["moved_m"].get<double>(), report["moved_deg"].get<double>());
  return line;
}

// Fixed and moving are words here, all else flags of the operation.
void addAdd(CLI::App& parent, Chosen& chosen) {
  auto words = std::make_shared<LinkWords>();
  auto* command = parent.add_subcommand("add", "Link two scans, from where they stand now");
  command->add_option("project", words->project, "The project")->required();
  command->add_option("fixed", words->fixed, "Number of the scan that stays")->required();
  command->add_option("moving", words->moving, "Number of the scan that is fitted to it")->required();
  std::vector<ParameterInfo> infos = operations().find("link")->parameters();
  std::erase_if(infos,
                [](const ParameterInfo& info) { return info.name == "fixed" || info.name == "moving"; });
  auto preset = std::make_shared<std::string>("default");
  command->add_option("--preset", *preset, "Parameters to start from: default or thesis");
  auto flags = ParameterFlags::addTo(*command, infos);
  command->callback([words, preset, flags, &chosen] {
    chosen.body = [words, preset, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      (*values)["fixed"] = words->fixed;
      (*values)["moving"] = words->moving;
      return operationCommand(context, words->project, "link", *preset, *values, addedText);
    };
  });
}

}  // namespace

void addLink(CLI::App& app, Chosen& chosen) {
  auto* parent = app.add_subcommand(
      "link", "Links between scans: list, judge, add, delete, disable, enable, accept, what-if");
  parent->require_subcommand(1);
  auto words = std::make_shared<LinkWords>();
  auto* list = parent->add_subcommand("list", "Which links there are");
  list->add_option("project", words->project, "The project")->required();
  list->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return listLinks(context, *words); };
  });
  auto* judge =
      parent->add_subcommand("judge", "Whether each link can be trusted, by its two scans, and why");
  judge->add_option("project", words->project, "The project")->required();
  judge->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return judgeLinksByScans(context, *words); };
  });
  using MakeEdit = Result<ProjectEdit> (*)(const Link&);
  const auto add = [&](const char* name, const char* help, MakeEdit make) {
    auto* command = parent->add_subcommand(name, help);
    command->add_option("project", words->project, "The project")->required();
    command->add_option("link", words->link, "Its number, as `tiltmap link list` shows it")->required();
    command->callback([words, make, &chosen] {
      chosen.body = [words, make](Context& context) -> int {
        return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
          return linkOf(*snapshot, words->link).and_then(make);
        });
      };
    });
  };
  add("disable", "Keep a link, but compute nothing from it when registering or relaxing next",
      [](const Link& link) -> Result<ProjectEdit> { return linkStateEdit(link.id, LinkState::Disabled); });
  add("enable", "Use a disabled link again",
      [](const Link& link) -> Result<ProjectEdit> { return linkStateEdit(link.id, LinkState::Active); });
  addAdd(*parent, chosen);
  add("delete", "Take a link out", deleted);
  auto* ask = parent->add_subcommand("what-if", "What the other links say without these; changes nothing");
  ask->add_option("project", words->project, "The project")->required();
  ask->add_option("links", words->links, "Their numbers, as `tiltmap link list` shows them")->required();
  ask->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return askWhatIf(context, *words); };
  });
  add("accept", "Vouch for a link: registering again leaves it as it is", accepted);
}

}  // namespace tiltmap::cli
