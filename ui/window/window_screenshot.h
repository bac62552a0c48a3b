// Pictures of the window and of single panels, without a display.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/products/rgb_image.h"
#include "core/project/stage.h"
#include "ui/models/preferences.h"
#include "ui/window/perspectives.h"

namespace tiltmap::ui {

struct WindowScreenshot {
  std::string panel = "window";  // the whole window, or a panel's id: that panel alone
  int width_px = 1366;           // before scaling, as on an ordinary screen
  int height_px = 768;
  double scale = 1.0;  // of a fine screen, 1 to 4: the picture has that many times more pixels
  ThemeChoice theme = ThemeChoice::Dark;
  Perspective perspective = Perspective::Inspect;
  std::vector<std::string> front;   // panels that are brought to the front
  std::optional<std::size_t> scan;  // selected
  struct Stepped {
    std::size_t fixed = 0, moving = 1;  // places of the scans
    std::string preset = "default";
    std::optional<int> iteration;  // 0 is the start; nothing: the last
  };
  std::optional<Stepped> stepped;  // what the ICP stepper shows, run to its end
  std::string colouring = "scan";  // of the 3D view, as its colour box has it
  std::string quantity = "range";  // of the depth image
  struct Relaxed {
    std::string preset = "default";
    std::optional<int> step;  // held within this step (1: the first); nothing: its proposal
  };
  std::optional<Relaxed> relaxed;  // a relaxation that is watched; nothing of it is stored
  std::optional<Stage> stage;      // whose poses place the scans; nothing: the latest
};

// "capture", "inspect", "register", "relax".
std::optional<Perspective> parsePerspective(const std::string& name);
std::vector<std::string> panelNames();

// Works on a copy of the project and with settings of its own: neither the project nor what the program
// remembers of its user changes. The 3D views are rendered apart and put into the picture of the other
// widgets. Once in a process, and not beside another QApplication. Error: a project that cannot be read, no
// OpenGL, a size out of range.
Result<RgbImage> windowScreenshot(const std::filesystem::path& project, const WindowScreenshot& settings);

}  // namespace tiltmap::ui
