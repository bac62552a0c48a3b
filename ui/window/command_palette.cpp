#include "ui/window/command_palette.h"

#include <QAction>
#include <QFrame>
#include <QKeyEvent>
#include <QLineEdit>
#include <QListWidget>
#include <QVBoxLayout>
#include <algorithm>

#include "ui/actions/action_registry.h"

namespace tiltmap::ui {

namespace {

QString plainText(const QAction& action) {
  return QString(action.text()).remove('&').remove(QString::fromUtf8("…"));
}

bool lettersInOrder(const QString& text, const QString& wanted) {
  int at = 0;
  for (const QChar letter : wanted) {
    at = text.indexOf(letter, at, Qt::CaseInsensitive);
    if (at < 0) return false;
    ++at;
  }
  return true;
}

}  // namespace

int CommandPalette::score(const QAction& action, const QString& wanted) {
  const QString text = plainText(action);
  if (wanted.isEmpty()) return 1;
  if (text.startsWith(wanted, Qt::CaseInsensitive)) return 5;
  if (text.contains(" " + wanted, Qt::CaseInsensitive)) return 4;
  if (text.contains(wanted, Qt::CaseInsensitive)) return 3;
  const QStringList words = wanted.split(' ', Qt::SkipEmptyParts);
  const QString all = text + " " + action.statusTip();
  if (std::ranges::all_of(words,
                          [&](const QString& word) { return all.contains(word, Qt::CaseInsensitive); }))
    return 2;
  return lettersInOrder(text, wanted) ? 1 : 0;
}

CommandPalette::CommandPalette(ActionRegistry& actions, QWidget* parent)
    : QDialog(parent, Qt::Popup),
      actions_(actions),
      search_(new QLineEdit(this)),
      list_(new QListWidget(this)) {
  setObjectName("command-palette");
  setAccessibleName("Command palette");
  search_->setObjectName("palette-search");
  search_->setPlaceholderText("Type what you want to do");
  search_->setAccessibleName("Command to find");
  search_->setToolTip("Letters of a command's name, or words of its help; Enter runs the first");
  search_->installEventFilter(this);
  list_->setObjectName("palette-list");
  list_->setAccessibleName("Commands found");
  list_->setToolTip("Enter or a click runs a command; grey ones cannot be run now");
  list_->setFocusPolicy(Qt::NoFocus);
  list_->setUniformItemSizes(true);
  list_->setIconSize(QSize(16, 16));
  list_->setFrameShape(QFrame::NoFrame);
  auto* frame = new QFrame(this);  // an edge against what is behind
  frame->setFrameShape(QFrame::Box);
  frame->setForegroundRole(QPalette::Mid);
  auto* around = new QVBoxLayout(this);
  around->setContentsMargins(0, 0, 0, 0);
  around->addWidget(frame);
  auto* layout = new QVBoxLayout(frame);
  layout->setContentsMargins(8, 8, 8, 8);
  layout->addWidget(search_);
  layout->addWidget(list_);
  connect(search_, &QLineEdit::textChanged, this, &CommandPalette::filter);
  connect(list_, &QListWidget::itemClicked, this, &CommandPalette::runCurrent);
}

void CommandPalette::popUp() {
  actions_.refresh();
  search_->clear();
  filter({});
  const QWidget* window = parentWidget();
  const QSize size(std::min(640, window->width() - 32), std::min(420, window->height() - 64));
  resize(size);
  move(window->mapToGlobal(QPoint((window->width() - size.width()) / 2, 48)));
  show();
  search_->setFocus();
}

void CommandPalette::filter(const QString& wanted) {
  std::vector<std::pair<int, QAction*>> found;
  for (QAction* action : actions_.all()) {
    if (action->objectName() == "view.palette") continue;
    const int rank = score(*action, wanted.trimmed());
    // What cannot be done now stands below, greyed: that it exists is worth knowing.
    if (rank > 0) found.emplace_back(rank + (action->isEnabled() ? 10 : 0), action);
  }
  std::ranges::stable_sort(found, std::greater(), &std::pair<int, QAction*>::first);
  list_->clear();
  QPixmap nothing(16, 16);
  nothing.fill(Qt::transparent);
  const QIcon blank(nothing);  // so that all texts begin at one line
  for (const auto& [rank, action] : found) {
    const QString keys = action->shortcut().toString(QKeySequence::NativeText);
    // Its help tells apart what has nearly the same name: a perspective, a panel, a stage.
    auto* item = new QListWidgetItem(
        action->icon().isNull() ? blank : action->icon(),
        plainText(*action) + (keys.isEmpty() ? "" : "    " + keys) + "    –  " + action->statusTip(), list_);
    item->setToolTip(action->statusTip());
    item->setData(Qt::UserRole, action->objectName());
    if (!action->isEnabled()) item->setFlags(Qt::NoItemFlags);
  }
  if (list_->count() > 0) list_->setCurrentRow(0);
}

void CommandPalette::runCurrent() {
  const QListWidgetItem* item = list_->currentItem();
  if (!item || !(item->flags() & Qt::ItemIsEnabled)) return;
  const QString id = item->data(Qt::UserRole).toString();
  hide();
  actions_.trigger(id);
}

bool CommandPalette::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::KeyPress) {
    const auto* key = static_cast<QKeyEvent*>(event);
    if (key->key() == Qt::Key_Return || key->key() == Qt::Key_Enter) {
      runCurrent();
      return true;
    }
    const int step = key->key() == Qt::Key_Down ? 1 : key->key() == Qt::Key_Up ? -1 : 0;
    if (step != 0) {
      list_->setCurrentRow(std::clamp(list_->currentRow() + step, 0, std::max(0, list_->count() - 1)));
      return true;
    }
  }
  return QDialog::eventFilter(watched, event);
}

}  // namespace tiltmap::ui
