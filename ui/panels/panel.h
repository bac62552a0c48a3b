// How a panel comes into the window: one entry in panels.cpp.
#pragma once

#include <QIcon>
#include <QString>
#include <QWidget>
#include <functional>
#include <vector>

namespace tiltmap::ui {

class ActionRegistry;
class Theme;
class Workspace;

// What every panel may use. Lives as long as the window.
struct PanelContext {
  Workspace& workspace;
  ActionRegistry& actions;
  const Theme& theme;
};

struct PanelInfo {
  QString id;     // "project-tree": names the dock in saved layouts, so it must never change
  QString title;  // "Project"
  QString icon;
  QString help;  // one sentence, for the View menu and the command palette
  std::function<QWidget*(const PanelContext&)> make;
};

// All panels, in the order of the View menu. Their places are in ui/window/perspectives.cpp.
const std::vector<PanelInfo>& panels();

}  // namespace tiltmap::ui
