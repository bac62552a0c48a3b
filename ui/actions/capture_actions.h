// Capturing by menu, key and palette.
#pragma once

namespace tiltmap::ui {

class ActionRegistry;
class WindowCommands;

void addCaptureActions(ActionRegistry& actions, WindowCommands& window);

}  // namespace tiltmap::ui
