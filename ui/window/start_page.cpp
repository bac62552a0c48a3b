#include "ui/window/start_page.h"

#include <QCommandLinkButton>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QVBoxLayout>

#include "core/base/version.h"
#include "ui/actions/action_registry.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

QLabel* title(const QString& text, double scale, QWidget* parent) {
  auto* label = new QLabel(text, parent);
  QFont font = label->font();
  font.setPointSizeF(font.pointSizeF() * scale);
  font.setWeight(QFont::DemiBold);
  label->setFont(font);
  label->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
  return label;
}

QCommandLinkButton* bigButton(QAction* action, QWidget* parent) {
  QString text = action->text();
  text.remove(QString::fromUtf8("…"));
  auto* button = new QCommandLinkButton(text, action->statusTip(), parent);
  button->setObjectName("start:" + action->objectName());
  button->setIcon(action->icon());
  button->setIconSize(QSize(24, 24));
  button->setToolTip(action->toolTip());
  button->setAccessibleName(text.remove('&'));
  button->setAccessibleDescription(action->statusTip());
  QObject::connect(button, &QAbstractButton::clicked, action, &QAction::trigger);
  return button;
}

}  // namespace

StartPage::StartPage(Workspace& workspace, ActionRegistry& actions, QWidget* parent)
    : QWidget(parent), workspace_(workspace), recent_(new QListWidget(this)), no_recent_(new QLabel(this)) {
  setObjectName("start-page");
  auto* left = new QVBoxLayout;
  left->setSpacing(4);
  left->addWidget(title("Tiltmap " + qt(programVersion()), 1.9, this));
  auto* line = new QLabel("From the range matrices of a tilted laser scanner to one consistent map.", this);
  line->setWordWrap(true);
  left->addWidget(line);
  left->addSpacing(16);
  for (const char* id : {"file.new", "file.open", "file.demo", "file.capture"})
    left->addWidget(bigButton(actions.get(id), this));
  left->addStretch();

  recent_->setObjectName("recent-files");
  recent_->setAccessibleName("Recent projects");
  recent_->setToolTip(
      "Projects that were opened lately, the newest first; Enter or a double click opens one");
  recent_->setSpacing(2);
  recent_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  recent_->setTextElideMode(Qt::ElideMiddle);
  no_recent_->setText(
      "None yet. Projects that you open are listed here; you can also drop a project or scan files "
      "on the window.");
  no_recent_->setWordWrap(true);
  no_recent_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  auto* right = new QVBoxLayout;
  right->setSpacing(8);
  right->addWidget(title("Recent", 1.2, this));
  right->addWidget(no_recent_);
  right->addWidget(recent_, 100);
  right->addStretch(1);

  auto* columns = new QHBoxLayout;
  columns->setSpacing(48);
  columns->addLayout(left, 1);
  columns->addLayout(right, 1);
  auto* frame = new QWidget(this);
  frame->setMaximumWidth(960);
  frame->setMaximumHeight(480);
  frame->setLayout(columns);
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(32, 32, 32, 32);
  layout->addStretch(1);
  layout->addWidget(frame, 8);
  layout->addStretch(1);

  connect(recent_, &QListWidget::itemActivated, this,
          [this](QListWidgetItem* item) { openRecent(recent_->row(item)); });
  connect(&workspace.preferences(), &Preferences::recentFilesChanged, this, &StartPage::refreshRecent);
  refreshRecent();
}

void StartPage::refreshRecent() {
  recent_->clear();
  for (const QString& path : workspace_.preferences().recentFiles()) {
    const QFileInfo file(path);
    auto* item = new QListWidgetItem(
        file.completeBaseName() + (file.exists() ? "" : "  (not there now)") + "\n" + file.absolutePath(),
        recent_);
    item->setToolTip(path);
    item->setData(Qt::UserRole, path);
    if (!file.exists()) item->setForeground(palette().color(QPalette::Disabled, QPalette::Text));
  }
  recent_->setVisible(recent_->count() > 0);
  no_recent_->setVisible(recent_->count() == 0);
}

void StartPage::openRecent(int row) {
  if (row < 0) return;
  (void)workspace_.session().open(recent_->item(row)->data(Qt::UserRole).toString());
}

}  // namespace tiltmap::ui
