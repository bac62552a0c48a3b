// tiltmap link list|disable|enable|accept P.tiltmap ...: what a person thinks of the pairs that were
// registered.
#include <cstdio>

#include "app/cli/operation_runner.h"

namespace tiltmap::cli {

namespace {

struct LinkWords {
  std::string project;
  long long link = 0;
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
  std::string text = "link  fixed  moving  overlap    rms mm  state     origin     ended\n";
  for (const Link& link : (*snapshot)->links()) {
    const std::size_t fixed = (*snapshot)->indexOf(link.fixed).value();
    const std::size_t moving = (*snapshot)->indexOf(link.moving).value();
    list.push_back({{"id", link.id},
                    {"fixed", fixed},
                    {"moving", moving},
                    {"overlap", link.overlap},
                    {"rms_m", link.rms_m},
                    {"state", linkStateName(link.state)},
                    {"origin", linkOriginName(link.origin)},
                    {"succeeded", link.succeeded},
                    {"stop_reason", link.stop_reason}});
    char line[120];
    std::snprintf(line, sizeof line, "%4lld  %5zu  %6zu  %5.0f %%  %8.2f  %-8s  %-9s  ",
                  static_cast<long long>(link.id), fixed, moving, 100.0 * link.overlap, 1000.0 * link.rms_m,
                  linkStateName(link.state).c_str(), linkOriginName(link.origin).c_str());
    text += line + link.stop_reason + "\n";
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

}  // namespace

void addLink(CLI::App& app, Chosen& chosen) {
  auto* parent = app.add_subcommand("link", "Registered pairs: list, disable, enable, accept");
  parent->require_subcommand(1);
  auto words = std::make_shared<LinkWords>();
  auto* list = parent->add_subcommand("list", "Which links there are");
  list->add_option("project", words->project, "The project")->required();
  list->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return listLinks(context, *words); };
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
  add("accept", "Vouch for a link: registering again leaves it as it is", accepted);
}

}  // namespace tiltmap::cli
