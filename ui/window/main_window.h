// One window, one project. Wires what the panels share; does nothing itself.
#pragma once

#include <QMainWindow>
#include <QPointer>
#include <map>

#include "ui/actions/action_registry.h"
#include "ui/actions/window_commands.h"
#include "ui/models/workspace.h"

class QDialog;
class QStackedWidget;

namespace tiltmap::ui {

class CommandPalette;
class DockArea;
class MessageBar;
class OperationDialog;
class StartPage;
class Theme;

class MainWindow : public QMainWindow, public WindowCommands {
  Q_OBJECT

 public:
  MainWindow(Preferences& preferences, const Theme& theme, QWidget* parent = nullptr);
  ~MainWindow() override;

  QWidget* widget() override { return this; }
  Workspace& workspace() override { return *workspace_; }
  ActionRegistry& actions() override { return actions_; }
  DockArea& docks() { return *docks_; }
  MessageBar& messageBar() { return *message_bar_; }

  void showOperation(const QString& operation, const ParameterValues& values = {}) override;
  OperationDialog* operationDialog(const QString& operation) const;
  void showPanel(const QString& panel) override;
  void togglePanel(const QString& panel) override;
  bool isPanelShown(const QString& panel) const override;
  Perspective perspective() const override;
  void setPerspective(Perspective perspective) override;
  void resetLayout() override;
  void showCommandPalette() override;
  void showPreferences() override;
  void showAbout() override;
  void showShortcuts() override;
  void showColours() override;
  void showSurvey() override;
  void newWindow() override;
  void closeNow() override;
  void beginRename() override;
  void beginNote() override;
  void addPhotographs() override;

 protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  void addActions();
  void makeMenus();
  void makeToolBar();
  void fillRecent(QMenu* menu);
  void showProject();
  void refreshTitle();
  void restoreWindow();
  void openDropped(const QStringList& files);

  Preferences& preferences_;
  const Theme& theme_;
  // Before the actions and panels, which look at it until they go.
  std::unique_ptr<Workspace> workspace_;
  ActionRegistry actions_;
  MessageBar* message_bar_ = nullptr;
  QStackedWidget* pages_ = nullptr;
  StartPage* start_page_ = nullptr;
  DockArea* docks_ = nullptr;
  CommandPalette* palette_ = nullptr;
  std::map<QString, QPointer<OperationDialog>> operation_dialogs_;
  QPointer<QDialog> preferences_dialog_;
  QPointer<QDialog> about_dialog_;
  QPointer<QDialog> shortcuts_dialog_;
  QPointer<QDialog> colour_dialog_;
  QPointer<QDialog> survey_dialog_;
};

}  // namespace tiltmap::ui
