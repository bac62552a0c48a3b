#include "ui/panels/project_tree_panel.h"

#include <QHeaderView>
#include <QKeyEvent>
#include <QMenu>
#include <QTreeView>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/models/project_tree_model.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

ProjectTreePanel::ProjectTreePanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new ProjectTreeModel(context.workspace, this)),
      view_(new QTreeView(this)),
      empty_(new EmptyState("This project has no scans yet. Import scan files, or drop them on the window.",
                            context.actions.get("op.import"), this)) {
  view_->setObjectName("project-tree-view");
  view_->setAccessibleName("Project tree");
  view_->setToolTip("Scans, links and results; the right button shows what can be done with each");
  view_->setModel(model_);
  view_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  view_->setEditTriggers(QAbstractItemView::EditKeyPressed | QAbstractItemView::SelectedClicked);
  view_->setDragDropMode(QAbstractItemView::InternalMove);
  view_->setContextMenuPolicy(Qt::CustomContextMenu);
  view_->setAlternatingRowColors(false);
  view_->setUniformRowHeights(true);
  view_->setFrameShape(QFrame::NoFrame);
  view_->setIndentation(12);
  view_->setHeaderHidden(true);
  // The figures give way in a narrow panel; the names do not.
  view_->header()->setMinimumSectionSize(24);
  view_->header()->setStretchLastSection(false);
  view_->header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  view_->header()->setSectionResizeMode(1, QHeaderView::Stretch);
  view_->installEventFilter(this);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(view_, 1);
  layout->addWidget(empty_);
  empty_->setObjectName("project-tree-empty");
  setFocusProxy(view_);

  connect(model_, &QAbstractItemModel::modelReset, this, [this] {
    expandGroups();
    showEmpty();
    showSelection();
  });
  connect(view_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &ProjectTreePanel::takeSelection);
  connect(&context.workspace.selection(), &Selection::scansChanged, this, &ProjectTreePanel::showSelection);
  connect(&context.workspace.selection(), &Selection::linksChanged, this, &ProjectTreePanel::showSelection);
  connect(view_, &QWidget::customContextMenuRequested, this, &ProjectTreePanel::showMenu);
  connect(view_, &QAbstractItemView::doubleClicked, this, &ProjectTreePanel::activate);
  connect(&context.workspace.jobs(), &JobQueue::busyChanged, this, &ProjectTreePanel::showEmpty);
  expandGroups();
  showEmpty();
}

void ProjectTreePanel::showEmpty() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  empty_->setVisible(snapshot && snapshot->scans().empty() && !context_.workspace.jobs().busy());
}

void ProjectTreePanel::expandGroups() {
  for (int group = 0; group < model_->rowCount(); ++group) view_->expand(model_->index(group, 0));
}

void ProjectTreePanel::takeSelection() {
  if (following_) return;
  std::vector<ScanId> scans;
  std::vector<LinkId> links;
  const QModelIndexList rows = view_->selectionModel()->selectedRows();
  for (const QModelIndex& index : rows) {
    const auto item = model_->itemAt(index);
    if (item && item->kind == TreeItem::Kind::Scan) scans.push_back(item->scan);
    if (item && item->kind == TreeItem::Kind::Link) links.push_back(item->link);
  }
  const auto current = model_->itemAt(view_->currentIndex());
  following_ = true;
  // A link chosen alone leaves the scans: the panels of one scan go on showing theirs.
  if (!scans.empty() || links.empty())
    context_.workspace.selection().setScans(std::move(scans), current && current->kind == TreeItem::Kind::Scan
                                                                  ? std::optional(current->scan)
                                                                  : std::nullopt);
  context_.workspace.selection().setLinks(std::move(links));
  following_ = false;
}

void ProjectTreePanel::showSelection() {
  if (following_) return;
  following_ = true;
  const Selection& selection = context_.workspace.selection();
  QItemSelection rows;
  const auto add = [&](const QModelIndex& index) {
    if (index.isValid()) rows.select(index, index.siblingAtColumn(ProjectTreeModel::kColumns - 1));
  };
  for (const LinkId link : selection.links()) add(model_->indexOfLink(link));
  for (const ScanId scan : selection.scans()) add(model_->indexOfScan(scan));
  view_->selectionModel()->select(rows, QItemSelectionModel::ClearAndSelect);
  if (selection.currentScan()) {
    const QModelIndex current = model_->indexOfScan(*selection.currentScan());
    view_->selectionModel()->setCurrentIndex(current, QItemSelectionModel::NoUpdate);
    view_->scrollTo(current);
  }
  following_ = false;
}

void ProjectTreePanel::showMenu(const QPoint& at) {
  const auto item = model_->itemAt(view_->indexAt(at));
  QStringList ids;
  if (item && item->kind == TreeItem::Kind::Scan)
    ids = QStringList{"view.show",
                      "view.hide",
                      "view.show-only",
                      "view.show-all",
                      "",
                      "edit.rename",
                      "edit.note",
                      "edit.photograph",
                      "edit.colour",
                      "edit.colour-default",
                      "edit.move-up",
                      "edit.move-down",
                      "edit.rebase",
                      "",
                      "edit.delete"};
  else if (item && item->kind == TreeItem::Kind::Link)
    ids = QStringList{"link.show",    "link.register", "", "link.accept",
                      "link.disable", "link.enable",   "", "edit.delete"};
  else if (item && (item->kind == TreeItem::Kind::Stage || item->kind == TreeItem::Kind::StagesGroup))
    ids = QStringList{"stage.latest", "stage.truth", "stage.odometry", "stage.pairwise", "stage.relaxed", "",
                      "stage.clear",  "op.export"};
  else
    ids = QStringList{"op.import", "op.simulate", "op.register", "", "edit.select-all", "view.show-all"};
  context_.actions.refresh();
  auto* menu = new QMenu(this);
  menu->setAttribute(Qt::WA_DeleteOnClose);
  menu->setToolTipsVisible(true);
  for (const QString& id : ids)
    if (id.isEmpty())
      menu->addSeparator();
    else if (QAction* action = context_.actions.find(id))
      menu->addAction(action);
  menu->popup(view_->viewport()->mapToGlobal(at));
}

void ProjectTreePanel::activate(const QModelIndex& index) {
  const auto item = model_->itemAt(index);
  if (!item) return;
  if (item->kind == TreeItem::Kind::Stage) context_.workspace.display().setStage(item->stage);
  if (item->kind == TreeItem::Kind::Link) context_.actions.trigger("link.show");
}

void ProjectTreePanel::beginRename() {
  const auto current = context_.workspace.selection().currentScan();
  if (!current) return;
  const QModelIndex index = model_->indexOfScan(*current);
  view_->setFocus();
  view_->setCurrentIndex(index);
  view_->edit(index);
}

bool ProjectTreePanel::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::KeyPress) {
    const auto* key = static_cast<QKeyEvent*>(event);
    if (key->key() == Qt::Key_Return || key->key() == Qt::Key_Enter) activate(view_->currentIndex());
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace tiltmap::ui
