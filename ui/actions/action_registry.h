// Every action of a window in one place: menus, tool bar, shortcuts, tooltips and the command palette come
// from here.
#pragma once

#include <QAction>
#include <QKeySequence>
#include <QObject>
#include <QString>
#include <functional>
#include <vector>

namespace tiltmap::ui {

struct ActionInfo {
  QString id;    // "file.open"
  QString text;  // the menu's, with its & and ...
  QString help;  // one sentence: what it does
  QString icon;
  QKeySequence shortcut = {};
  std::function<void()> run;
  std::function<bool()> enabled = {};      // asked on refresh(); always enabled without
  std::function<bool()> checked = {};      // makes it checkable
  std::function<QString()> text_now = {};  // where the text changes: "Undo register 13 pairs"
};

class ActionRegistry : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  // Throws std::logic_error for an id or a shortcut that is taken.
  QAction* add(const ActionInfo& info);
  QAction* find(const QString& id) const;
  // Throws std::logic_error for one that is not there.
  QAction* get(const QString& id) const;
  std::vector<QAction*> all() const;
  // Runs it as a click would; false where it is missing or disabled.
  bool trigger(const QString& id);

  // Asks every action again whether it is enabled; scheduleRefresh() does so once from the event loop.
  void refresh();
  void scheduleRefresh();

 private:
  struct Entry {
    ActionInfo info;
    QAction* action = nullptr;
  };
  void refreshOne(const Entry& entry);

  std::vector<Entry> entries_;
  bool scheduled_ = false;
};

}  // namespace tiltmap::ui
