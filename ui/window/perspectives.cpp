#include "ui/window/perspectives.h"

namespace tiltmap::ui {

QString perspectiveName(Perspective perspective) {
  switch (perspective) {
    case Perspective::Capture:
      return "Capture";
    case Perspective::Inspect:
      return "Inspect";
    case Perspective::Register:
      return "Register";
    case Perspective::Relax:
      return "Relax";
  }
  return {};
}

QString perspectiveHelp(Perspective perspective) {
  switch (perspective) {
    case Perspective::Capture:
      return "Bring scans in with the instruments, and see each one as it comes";
    case Perspective::Inspect:
      return "Look at every scan: depth image, 3D view and details side by side";
    case Perspective::Register:
      return "Find how pairs of scans fit together";
    case Perspective::Relax:
      return "Spread the remaining errors over the whole map";
  }
  return {};
}

std::vector<DockPlace> delivered(Perspective perspective) {
  using enum DockSide;
  switch (perspective) {
    case Perspective::Capture:
      return {{"view3d", Left, "", 0},
              {"project-tree", Left, "view3d", 0.17},
              {"capture", Right, "view3d", 0.33},
              {"capture-matrix", Bottom, "view3d", 0.42},
              {"capture-line", Right, "capture-matrix", 0.45},
              {"log", Tab, "capture-matrix", 0},
              // They ask for more width than half of the middle has.
              {"depth-image", Tab, "view3d", 0},
              {"photographs", Tab, "view3d", 0},
              {"calibration", Tab, "view3d", 0},
              {"details", Tab, "project-tree", 0}};
    case Perspective::Inspect:
      return {{"view3d", Left, "", 0},
              {"project-tree", Left, "view3d", 0.225},
              {"details", Bottom, "project-tree", 0.45},
              {"depth-image", Bottom, "view3d", 0.45},
              {"localisation", Tab, "depth-image", 0},
              {"photographs", Tab, "depth-image", 0},
              {"log", Tab, "depth-image", 0},
              {"history", Tab, "details", 0}};
    case Perspective::Register:
      return {{"view3d", Left, "", 0},
              {"stepper-view", Tab, "view3d", 0},
              {"project-tree", Left, "view3d", 0.19},
              {"details", Bottom, "project-tree", 0.45},
              {"stepper", Right, "view3d", 0.38},
              {"stepper-plots", Bottom, "view3d", 0.34},
              {"depth-image", Tab, "stepper-plots", 0},
              {"localisation", Tab, "stepper-plots", 0},
              {"log", Tab, "stepper-plots", 0},
              {"history", Tab, "details", 0}};
    case Perspective::Relax:
      return {{"view3d", Left, "", 0},          {"project-tree", Left, "view3d", 0.18},
              {"relax", Right, "view3d", 0.36}, {"sitemap", Bottom, "view3d", 0.52},
              {"links", Bottom, "relax", 0.45}, {"localisation", Tab, "sitemap", 0},
              {"log", Tab, "sitemap", 0},       {"history", Bottom, "project-tree", 0.40}};
  }
  return {};
}

}  // namespace tiltmap::ui
