// tiltmap link list|judge|add|delete|disable|enable|accept|what-if P.tiltmap ...: what a person thinks of the
// pairs that were registered.
#include <algorithm>
#include <cstdio>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/project/judgement_json.h"
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

// "5.2 mm" of one that is known, else a dash.
std::string shown(const nlohmann::json& in, const char* name, double factor, int places) {
  return in.is_object() && in.contains(name) ? fixedReal(factor * in[name].get<double>(), places) : "-";
}

constexpr const char* kTableHead =
    "link  fixed  moving  verdict     overlap    fit  residual mm  moved cm  others mm   x  loop mm  ";

// The figures of linkJson in a row.
std::string tableRow(const nlohmann::json& link) {
  const nlohmann::json &scans = link["by_scans"], &others = link["others"], &loop = link["loop"];
  std::string overlap = "-";
  if (scans.is_object())
    overlap =
        percentWords(std::max(scans["overlap_moving"].get<double>(), scans["overlap_fixed"].get<double>()));
  char line[200];
  std::snprintf(line, sizeof line, "%4lld  %5d  %6d  %-10s  %7s  %5s  %11s  %8s  %9s  %3s  %7s  ",
                link["id"].get<long long>(), link["fixed"].get<int>(), link["moving"].get<int>(),
                link["verdict"].get<std::string>().c_str(), overlap.c_str(),
                scans.is_object() ? percentWords(scans["fit"].get<double>()).c_str() : "-",
                shown(scans, "residual_m", 1000.0, 1).c_str(), shown(scans, "moved_m", 100.0, 1).c_str(),
                shown(others, "off_m", 1000.0, 1).c_str(), shown(others, "deviations", 1.0, 1).c_str(),
                shown(loop, "misclosure_m", 1000.0, 1).c_str());
  return line;
}

int listLinks(Context& context, const LinkWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text = kTableHead + std::string("state     origin     ended\n");
  const auto judged = judgeLinks(**snapshot, (*snapshot)->latestStage());
  for (std::size_t k = 0; k < judged.size(); ++k) {
    const Link& link = (*snapshot)->links()[k];
    list.push_back(linkJson(**snapshot, link, judged[k]));
    char line[40];
    std::snprintf(line, sizeof line, "%-8s  %-9s  ", linkStateName(link.state).c_str(),
                  linkOriginName(link.origin).c_str());
    text += tableRow(list.back()) + line + link.stop_reason + "\n";
  }
  context.console.printJson({{"links", list}});
  context.console.print(list.empty() ? "there are no links" : text);
  return kDone;
}

std::string judgedText(const nlohmann::json& report) {
  std::string text = kTableHead + std::string("why\n");
  for (const nlohmann::json& link : report["links"])
    text += tableRow(link) + link["reason"].get<std::string>() + "\n";
  return text;
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
                "linked %d to %d: %.0f %% matched, rms %.2f mm, %.1f mm and %.3f deg from the start\n%s: ",
                report["moving"].get<int>(), report["fixed"].get<int>(),
                100.0 * report["overlap"].get<double>(), 1000.0 * report["rms_m"].get<double>(),
                1000.0 * report["moved_m"].get<double>(), report["moved_deg"].get<double>(),
                report["verdict"].get<std::string>().c_str());
  return line + report["verdict_reason"].get<std::string>();
}

void addJudge(CLI::App& parent, Chosen& chosen) {
  auto* command = parent.add_subcommand(
      "judge",
      "Whether each link can be trusted, by its scans and the other links, and why; kept in the project");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  auto flags = ParameterFlags::addTo(*command, operations().find("judge")->parameters());
  command->callback([path, flags, &chosen] {
    chosen.body = [path, flags](Context& context) -> int {
      const auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      return operationCommand(context, *path, "judge", "default", *values, judgedText);
    };
  });
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
  addJudge(*parent, chosen);
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
