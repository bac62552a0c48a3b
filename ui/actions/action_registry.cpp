#include "ui/actions/action_registry.h"

#include <QTimer>
#include <algorithm>
#include <stdexcept>

#include "ui/look/icons.h"

namespace tiltmap::ui {

QAction* ActionRegistry::add(const ActionInfo& info) {
  if (find(info.id)) throw std::logic_error("two actions are called " + info.id.toStdString());
  for (const Entry& other : entries_)
    if (!info.shortcut.isEmpty() && other.info.shortcut == info.shortcut)
      throw std::logic_error("two actions have the shortcut of " + info.id.toStdString());
  auto* action = new QAction(icon(info.icon), info.text, this);
  action->setObjectName(info.id);
  action->setShortcut(info.shortcut);
  action->setCheckable(static_cast<bool>(info.checked));
  action->setStatusTip(info.help);
  entries_.push_back({info, action});
  connect(action, &QAction::triggered, this, [this, run = info.run] {
    run();
    scheduleRefresh();
  });
  refreshOne(entries_.back());
  return action;
}

QAction* ActionRegistry::find(const QString& id) const {
  const auto found = std::ranges::find_if(entries_, [&](const Entry& e) { return e.info.id == id; });
  return found == entries_.end() ? nullptr : found->action;
}

QAction* ActionRegistry::get(const QString& id) const {
  QAction* action = find(id);
  if (!action) throw std::logic_error("there is no action " + id.toStdString());
  return action;
}

std::vector<QAction*> ActionRegistry::all() const {
  std::vector<QAction*> list;
  for (const Entry& entry : entries_) list.push_back(entry.action);
  return list;
}

bool ActionRegistry::trigger(const QString& id) {
  refresh();
  QAction* action = find(id);
  if (!action || !action->isEnabled()) return false;
  action->trigger();
  return true;
}

void ActionRegistry::refreshOne(const Entry& entry) {
  const ActionInfo& info = entry.info;
  QAction& action = *entry.action;
  if (info.enabled) action.setEnabled(info.enabled());
  if (info.checked) action.setChecked(info.checked());
  if (info.text_now) action.setText(info.text_now());
  QString plain = action.text();
  plain.remove('&').remove(QString::fromUtf8("…"));
  const QString keys = info.shortcut.toString(QKeySequence::NativeText);
  action.setToolTip(QString("<p><b>%1</b>%2<br>%3</p>")
                        .arg(plain.toHtmlEscaped(),
                             keys.isEmpty() ? QString() : " &nbsp;" + keys.toHtmlEscaped(),
                             info.help.toHtmlEscaped()));
}

void ActionRegistry::refresh() {
  for (const Entry& entry : entries_) refreshOne(entry);
}

void ActionRegistry::scheduleRefresh() {
  if (scheduled_) return;
  scheduled_ = true;
  QTimer::singleShot(0, this, [this] {
    scheduled_ = false;
    refresh();
  });
}

}  // namespace tiltmap::ui
