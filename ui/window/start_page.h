// What the window shows with no project: ways to get one.
#pragma once

#include <QWidget>

class QLabel;
class QListWidget;

namespace tiltmap::ui {

class ActionRegistry;
class Workspace;

class StartPage : public QWidget {
  Q_OBJECT

 public:
  StartPage(Workspace& workspace, ActionRegistry& actions, QWidget* parent = nullptr);

 private:
  void refreshRecent();
  void openRecent(int row);

  Workspace& workspace_;
  QListWidget* recent_;
  QLabel* no_recent_;
};

}  // namespace tiltmap::ui
