// tiltmap [gui [P.tiltmap]]: the window.
#include <filesystem>

#include "app/cli/command.h"
#include "ui/window/gui_application.h"

namespace tiltmap::cli {

int openWindow(Context& context, const std::string& project) {
  if (const Status there = ui::displayThere(); !there) return context.console.failed(there.error());
  static char name[] = "tiltmap";
  static char* words[] = {name, nullptr};
  static int count = 1;
  return ui::runWindow(count, words, project, context.stop);
}

void addGui(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand("gui", "Open the window; so does tiltmap without words");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project to open");
  command->callback([path, &chosen] {
    chosen.body = [path](Context& context) -> int { return openWindow(context, *path); };
  });
}

}  // namespace tiltmap::cli
