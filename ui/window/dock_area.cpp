#include "ui/window/dock_area.h"

#include <DockAreaWidget.h>
#include <DockManager.h>
#include <DockWidget.h>
#include <IconProvider.h>
#include <QSplitter>
#include <QVBoxLayout>

#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

// Of the saved layouts: raised when a stored arrangement would no longer make sense.
constexpr int kLayoutVersion = 2;

ads::CDockManager* makeManager(QWidget* parent) {
  using Manager = ads::CDockManager;
  Manager::setConfigFlags(Manager::DefaultOpaqueConfig);
  Manager::setConfigFlag(Manager::ActiveTabHasCloseButton, true);
  Manager::setConfigFlag(Manager::DockAreaHasUndockButton, false);
  Manager::setConfigFlag(Manager::DockAreaDynamicTabsMenuButtonVisibility, true);
  Manager::setConfigFlag(Manager::DockAreaHasCloseButton, false);
  Manager::setConfigFlag(Manager::OpaqueUndocking, false);
  Manager::setConfigFlag(Manager::MiddleMouseButtonClosesTab, true);
  Manager::setConfigFlag(Manager::FloatingContainerHasWidgetIcon, true);
  Manager::iconProvider().registerCustomIcon(ads::TabCloseIcon, icon("window-close"));
  Manager::iconProvider().registerCustomIcon(ads::DockAreaMenuIcon, icon("arrow-down"));
  return new Manager(parent);
}

ads::DockWidgetArea areaOf(DockSide side) {
  switch (side) {
    case DockSide::Left:
      return ads::LeftDockWidgetArea;
    case DockSide::Right:
      return ads::RightDockWidgetArea;
    case DockSide::Top:
      return ads::TopDockWidgetArea;
    case DockSide::Bottom:
      return ads::BottomDockWidgetArea;
    case DockSide::Tab:
      return ads::CenterDockWidgetArea;
  }
  return ads::CenterDockWidgetArea;
}

// Sizes of the parts of splitters, as if each place had been cut off from the one beside it in turn. When a
// part is really added a splitter shares its room out anew, so that sizes are set when all of them are there.
class Shares {
 public:
  void cut(ads::CDockAreaWidget* added, const ads::CDockAreaWidget* old, double share) {
    for (QWidget* part = added; part; part = part->parentWidget()) {
      auto* splitter = qobject_cast<QSplitter*>(part->parentWidget());
      if (!splitter || !splitter->isAncestorOf(old)) continue;
      int beside = 0;
      for (int i = 0; i < splitter->count(); ++i)
        if (splitter->widget(i) == old || splitter->widget(i)->isAncestorOf(old)) beside = i;
      QList<int>& sizes = sizes_[splitter];
      if (sizes.isEmpty()) {
        for (int i = 0; i < splitter->count(); ++i) sizes << 0;
        sizes[beside] = 100000;
      }
      const int size = static_cast<int>(sizes[beside] * share);
      sizes[beside] -= size;
      sizes[splitter->indexOf(part)] = size;
      return;
    }
  }
  void apply() const {
    for (const auto& [splitter, sizes] : sizes_) splitter->setSizes(sizes);
  }

 private:
  std::map<QSplitter*, QList<int>> sizes_;
};

}  // namespace

DockArea::DockArea(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), manager_(makeManager(this)) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(manager_);
  makeDocks(context);
  // Before any stored layout: the manager restores only docks that it has seen.
  arrange(perspective_);
  restyle();
  connect(&context.theme, &Theme::changed, this, &DockArea::restyle);
}

DockArea::~DockArea() = default;

void DockArea::makeDocks(const PanelContext& context) {
  for (const PanelInfo& info : panels()) {
    auto* dock = new ads::CDockWidget(info.title, manager_);
    dock->setObjectName(info.id);
    dock->setIcon(icon(info.icon));
    dock->setToolTip(info.help);
    dock->setFeature(ads::CDockWidget::DockWidgetDeleteOnClose, false);
    dock->setMinimumSizeHintMode(ads::CDockWidget::MinimumSizeHintFromContent);
    QWidget* content = info.make(context);
    content->setObjectName("panel:" + info.id);
    content->setAccessibleName(info.title);
    content->setAccessibleDescription(info.help);
    dock->setWidget(content, ads::CDockWidget::ForceNoScrollArea);
    docks_[info.id] = dock;
    connect(dock, &ads::CDockWidget::viewToggled, this, &DockArea::panelsChanged);
  }
}

QString DockArea::layoutKey(Perspective perspective) const {
  return "layout/" + perspectiveName(perspective).toLower();
}

void DockArea::saveLayout() const {
  context_.workspace.preferences().setBytes(layoutKey(perspective_), manager_->saveState(kLayoutVersion));
}

void DockArea::setPerspective(Perspective perspective) {
  if (restored_ && perspective == perspective_) return;
  if (restored_) saveLayout();
  restored_ = true;
  perspective_ = perspective;
  const QByteArray saved = context_.workspace.preferences().bytes(layoutKey(perspective));
  if (saved.isEmpty() || !manager_->restoreState(saved, kLayoutVersion)) arrange(perspective);
  restyle();  // the areas are new, and not all of them take the sheet that was there before them
  Q_EMIT perspectiveChanged();
  Q_EMIT panelsChanged();
}

void DockArea::resetLayout() {
  arrange(perspective_);
  saveLayout();
  Q_EMIT panelsChanged();
}

void DockArea::arrange(Perspective perspective) {
  for (const auto& [id, dock] : docks_)
    if (dock->dockContainer()) manager_->removeDockWidget(dock);
  std::map<QString, ads::CDockAreaWidget*> placed;
  QString first;
  for (const DockPlace& place : delivered(perspective)) {
    const auto found = docks_.find(place.panel);
    if (found == docks_.end()) continue;
    const auto beside = placed.find(placed.contains(place.beside) ? place.beside : first);
    ads::CDockAreaWidget* old = beside == placed.end() ? nullptr : beside->second;
    const DockSide side = old || place.side != DockSide::Tab ? place.side : DockSide::Left;
    placed[place.panel] = manager_->addDockWidget(areaOf(side), found->second, old);
    found->second->toggleView(true);
    if (first.isEmpty()) first = place.panel;
  }
  // Known to the manager, closed, so that they can be restored and opened.
  for (const auto& [id, dock] : docks_)
    if (!placed.contains(id)) {
      // As tabs: side by side they would ask for more width than a screen has before they are closed.
      manager_->addDockWidget(first.isEmpty() ? ads::RightDockWidgetArea : ads::CenterDockWidgetArea, dock,
                              first.isEmpty() ? nullptr : placed.at(first));
      // One that was closed before counts as closed, and would keep the tab that it has been given.
      dock->toggleView(true);
      dock->toggleView(false);
    }
  for (const auto& [id, area] : placed) area->setCurrentIndex(0);
  Shares shares;
  for (const DockPlace& place : delivered(perspective))
    if (place.share > 0.0 && placed.contains(place.panel) && placed.contains(place.beside))
      shares.cut(placed.at(place.panel), placed.at(place.beside), place.share);
  shares.apply();
}

bool DockArea::isShown(const QString& panel) const {
  const auto found = docks_.find(panel);
  return found != docks_.end() && !found->second->isClosed();
}

void DockArea::showPanel(const QString& panel) {
  const auto found = docks_.find(panel);
  if (found == docks_.end()) return;
  found->second->toggleView(true);
  found->second->setAsCurrentTab();
  found->second->raise();
}

void DockArea::togglePanel(const QString& panel) {
  if (isShown(panel))
    docks_.at(panel)->toggleView(false);
  else
    showPanel(panel);
}

QWidget* DockArea::panel(const QString& id) const {
  const auto found = docks_.find(id);
  return found == docks_.end() ? nullptr : found->second->widget();
}

void DockArea::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  restyle();
}

void DockArea::restyle() {
  const ThemeColours& c = context_.theme.colours();
  const QPalette p = Theme::palette(context_.theme.look());
  manager_->setStyleSheet(QString(R"(
    ads--CDockContainerWidget { background: %1; }
    ads--CDockContainerWidget > QSplitter { padding: 0; }
    ads--CDockContainerWidget ads--CDockSplitter::handle { background: %2; }
    ads--CDockAreaWidget { background: %3; border: none; }
    ads--CDockAreaTitleBar { background: %3; border-bottom: 1px solid %2; padding: 0; }
    ads--CDockWidget { background: %3; border: none; }
    ads--CTitleBarButton { padding: 2px; border: none; background: transparent; }
    ads--CTitleBarButton:hover { background: %2; }
    ads--CTitleBarButton::menu-indicator { image: none; }
    ads--CDockWidgetTab { background: transparent; border: none; border-bottom: 2px solid transparent;
                          padding: 4px 4px 2px 8px; min-height: 20px; }
    ads--CDockWidgetTab[activeTab="true"] { border-bottom: 2px solid %5; }
    ads--CDockWidgetTab QLabel { color: %6; }
    ads--CDockWidgetTab[activeTab="true"] QLabel { color: %4; }
    ads--CDockWidgetTab:hover QLabel { color: %4; }
    #tabCloseButton { margin: 2px; padding: 0px; border: none; background: transparent;
                      qproperty-icon: url(:/tiltmap/icons/tab-close-%7.svg); qproperty-iconSize: 12px; }
    #tabCloseButton:hover { background: %2; border-radius: 2px; }
  )")
                              .arg(c.line.name(), c.line.name(), p.color(QPalette::Window).name(),
                                   p.color(QPalette::WindowText).name(), c.accent.name(), c.muted.name(),
                                   context_.theme.isDark() ? "dark" : "light"));
}

}  // namespace tiltmap::ui
