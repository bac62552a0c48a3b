// What actions and panels may ask of the window they are in.
#pragma once

#include <QString>

#include "core/base/parameter.h"
#include "ui/window/perspectives.h"

class QWidget;

namespace tiltmap::ui {

class ActionRegistry;
class Workspace;

class WindowCommands {
 public:
  virtual ~WindowCommands() = default;

  virtual QWidget* widget() = 0;
  virtual Workspace& workspace() = 0;
  virtual ActionRegistry& actions() = 0;

  // The non-modal form of an operation, with some of its values set.
  virtual void showOperation(const QString& operation, const ParameterValues& values = {}) = 0;
  virtual void showPanel(const QString& panel) = 0;
  virtual void togglePanel(const QString& panel) = 0;
  virtual bool isPanelShown(const QString& panel) const = 0;
  virtual Perspective perspective() const = 0;
  virtual void setPerspective(Perspective perspective) = 0;
  virtual void resetLayout() = 0;
  virtual void showCommandPalette() = 0;
  virtual void showPreferences() = 0;
  virtual void showAbout() = 0;
  virtual void showShortcuts() = 0;
  virtual void showColours() = 0;
  virtual void showSurvey() = 0;
  virtual void newWindow() = 0;
  virtual void closeNow() = 0;  // without asking: what runs is cancelled
  // In the tree: the current scan's name becomes editable.
  virtual void beginRename() = 0;
  virtual void beginNote() = 0;
  virtual void addPhotographs() = 0;
};

// One function a group; each lives in the file of its name.
void addFileActions(ActionRegistry& actions, WindowCommands& window);
void addEditActions(ActionRegistry& actions, WindowCommands& window);
void addViewActions(ActionRegistry& actions, WindowCommands& window);
void addLinkActions(ActionRegistry& actions, WindowCommands& window);
void addOperationActions(ActionRegistry& actions, WindowCommands& window);
void addStepperActions(ActionRegistry& actions, WindowCommands& window);
void addHelpActions(ActionRegistry& actions, WindowCommands& window);

}  // namespace tiltmap::ui
