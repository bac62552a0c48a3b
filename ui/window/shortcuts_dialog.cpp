#include "ui/window/shortcuts_dialog.h"

#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLineEdit>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"

namespace tiltmap::ui {

namespace {

struct OwnKey {
  const char* name;
  const char* keys;
  const char* help;
};

// Keys that panels take themselves while they have the focus: no actions of the window.
constexpr OwnKey kOwnKeys[] = {
    {"3D view: top, bottom", "8  2", "Look from above, from below"},
    {"3D view: front, back", "5  0", "Look along the y axis, and against it"},
    {"3D view: left, right", "4  6", "Look along the x axis, and against it"},
    {"3D view: at an angle", "7  9", "From above at an angle, from in front and from behind"},
    {"3D view: orthographic", "O", "With and without perspective"},
    {"3D view: frame", "F", "The selected scans fill the view"},
    {"3D view: turn, zoom", "arrows  +  -", "Turn about the middle, come nearer and go back"},
    {"Depth image: fit", "F", "Show the whole matrix"},
    {"Tables: copy", "Ctrl+C", "Copy the selected rows"},
};

}  // namespace

ShortcutsDialog::ShortcutsDialog(const ActionRegistry& actions, QWidget* parent)
    : QDialog(parent), actions_(actions), table_(new QTableWidget(this)) {
  setObjectName("shortcuts");
  setWindowTitle("Shortcuts");
  auto* search = new QLineEdit(this);
  search->setObjectName("shortcuts-filter");
  search->setPlaceholderText("Show actions with …");
  search->setAccessibleName("Filter of the shortcuts");
  search->setToolTip("Show only actions whose name, keys or help hold this text");
  search->setClearButtonEnabled(true);
  table_->setObjectName("shortcuts-table");
  table_->setAccessibleName("Actions and their keys");
  table_->setToolTip("All actions that have keys; the others are in the menus and the command palette");
  table_->setColumnCount(3);
  table_->setHorizontalHeaderLabels({"Action", "Keys", "What it does"});
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setShowGrid(false);
  table_->setAlternatingRowColors(true);
  table_->setTabKeyNavigation(false);
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table_->horizontalHeader()->setStretchLastSection(true);
  table_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  buttons->button(QDialogButtonBox::Close)->setToolTip("Close this list");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(8);
  layout->addWidget(search);
  layout->addWidget(table_, 1);
  layout->addWidget(buttons);
  resize(900, 560);
  connect(search, &QLineEdit::textChanged, this, &ShortcutsDialog::fill);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  fill({});
}

void ShortcutsDialog::fill(const QString& wanted) {
  table_->setRowCount(0);
  const auto add = [&](const QString& name, const QString& keys, const QString& help) {
    if (!(name + " " + keys + " " + help).contains(wanted, Qt::CaseInsensitive)) return;
    const int row = table_->rowCount();
    table_->insertRow(row);
    int column = 0;
    for (const QString& text : {name, keys, help}) {
      auto* item = new QTableWidgetItem(text);
      item->setToolTip(help);
      table_->setItem(row, column++, item);
    }
  };
  for (const QAction* action : actions_.all()) {
    if (action->shortcut().isEmpty()) continue;
    QString name = action->text();
    name.remove('&').remove(QString::fromUtf8("…"));
    add(name, action->shortcut().toString(QKeySequence::NativeText), action->statusTip());
  }
  for (const OwnKey& own : kOwnKeys) add(own.name, own.keys, own.help);
}

}  // namespace tiltmap::ui
