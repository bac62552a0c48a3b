#include "ui/models/project_tree_model.h"

#include <QDataStream>
#include <QFont>
#include <QIODevice>
#include <QIcon>
#include <QMimeData>
#include <QPainter>
#include <QPixmap>
#include <array>

#include "ui/models/edits.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kScanMime = "application/x-tiltmap-scans";
constexpr std::array kGroups = {TreeItem::Kind::ScansGroup, TreeItem::Kind::LinksGroup,
                                TreeItem::Kind::StagesGroup};

// A group has id 0; a child the number of its group, counted from 1.
int groupOf(const QModelIndex& index) {
  return static_cast<int>(index.internalId()) - 1;
}

}  // namespace

ProjectTreeModel::ProjectTreeModel(Workspace& workspace, QObject* parent)
    : QAbstractItemModel(parent), workspace_(workspace) {
  const ProjectSession& session = workspace.session();
  connect(&session, &ProjectSession::opened, this, &ProjectTreeModel::readAgain);
  connect(&session, &ProjectSession::closed, this, &ProjectTreeModel::readAgain);
  connect(&session, &ProjectSession::changed, this, &ProjectTreeModel::update);
  connect(&workspace.display(), &ScanDisplay::visibilityChanged, this, &ProjectTreeModel::repaintAll);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &ProjectTreeModel::repaintAll);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &ProjectTreeModel::repaintAll);
  readAgain();
}

void ProjectTreeModel::readAgain() {
  beginResetModel();
  snapshot_ = workspace_.snapshot();
  stages_ = snapshot_ ? snapshot_->stages() : std::vector<Stage>();
  endResetModel();
}

void ProjectTreeModel::update(const Change& change) {
  const bool rows = !change.scans_added.empty() || !change.scans_removed.empty() || change.order_changed ||
                    !change.links_added.empty() || !change.links_removed.empty() ||
                    workspace_.snapshot()->stages() != stages_;
  if (rows) return readAgain();
  snapshot_ = workspace_.snapshot();
  repaintAll();
}

void ProjectTreeModel::repaintAll() {
  for (int group = 0; group < rowCount(); ++group) {
    const QModelIndex parent = index(group, 0);
    Q_EMIT dataChanged(parent, parent.siblingAtColumn(kColumns - 1));
    if (const int rows = rowCount(parent); rows > 0)
      Q_EMIT dataChanged(index(0, 0, parent), index(rows - 1, kColumns - 1, parent));
  }
}

std::optional<TreeItem> ProjectTreeModel::itemAt(const QModelIndex& index) const {
  if (!index.isValid() || !snapshot_) return {};
  const auto row = static_cast<std::size_t>(index.row());
  TreeItem item;
  if (index.internalId() == 0) {
    item.kind = kGroups[row];
    return item;
  }
  switch (kGroups[static_cast<std::size_t>(groupOf(index))]) {
    case TreeItem::Kind::ScansGroup:
      item.kind = TreeItem::Kind::Scan;
      item.scan = snapshot_->scans()[row].id;
      break;
    case TreeItem::Kind::LinksGroup:
      item.kind = TreeItem::Kind::Link;
      item.link = snapshot_->links()[row].id;
      break;
    default:
      item.kind = TreeItem::Kind::Stage;
      item.stage = stages_[row];
  }
  return item;
}

QModelIndex ProjectTreeModel::groupIndex(TreeItem::Kind group) const {
  return snapshot_ ? index(static_cast<int>(group), 0) : QModelIndex();
}

QModelIndex ProjectTreeModel::indexOfScan(ScanId scan) const {
  const auto row = snapshot_ ? snapshot_->indexOf(scan) : std::nullopt;
  return row ? index(static_cast<int>(*row), 0, groupIndex(TreeItem::Kind::ScansGroup)) : QModelIndex();
}

QModelIndex ProjectTreeModel::indexOfLink(LinkId link) const {
  if (!snapshot_) return {};
  for (std::size_t row = 0; row < snapshot_->links().size(); ++row)
    if (snapshot_->links()[row].id == link)
      return index(static_cast<int>(row), 0, groupIndex(TreeItem::Kind::LinksGroup));
  return {};
}

QModelIndex ProjectTreeModel::index(int row, int column, const QModelIndex& parent) const {
  if (!hasIndex(row, column, parent)) return {};
  return createIndex(row, column, parent.isValid() ? static_cast<quintptr>(parent.row() + 1) : quintptr{0});
}

QModelIndex ProjectTreeModel::parent(const QModelIndex& child) const {
  if (!child.isValid() || child.internalId() == 0) return {};
  return createIndex(groupOf(child), 0, quintptr{0});
}

int ProjectTreeModel::rowCount(const QModelIndex& parent) const {
  if (!snapshot_) return 0;
  if (!parent.isValid()) return static_cast<int>(kGroups.size());
  if (parent.internalId() != 0 || parent.column() != 0) return 0;
  switch (kGroups[static_cast<std::size_t>(parent.row())]) {
    case TreeItem::Kind::ScansGroup:
      return static_cast<int>(snapshot_->scans().size());
    case TreeItem::Kind::LinksGroup:
      return static_cast<int>(snapshot_->links().size());
    default:
      return static_cast<int>(stages_.size());
  }
}

int ProjectTreeModel::columnCount(const QModelIndex&) const {
  return kColumns;
}

QVariant ProjectTreeModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return section == Name ? QString("Project") : QString("What it holds");
}

QVariant ProjectTreeModel::data(const QModelIndex& index, int role) const {
  const auto item = itemAt(index);
  if (!item) return {};
  if (role == KindRole) return static_cast<int>(item->kind);
  const auto row = static_cast<std::size_t>(index.row());
  switch (item->kind) {
    case TreeItem::Kind::Scan:
      return scanData(row, index.column(), role);
    case TreeItem::Kind::Link:
      return linkData(row, index.column(), role);
    case TreeItem::Kind::Stage:
      return stageData(row, index.column(), role);
    default:
      return groupData(item->kind, index.column(), role);
  }
}

QVariant ProjectTreeModel::groupData(TreeItem::Kind group, int column, int role) const {
  if (role == Qt::FontRole) {
    QFont font;
    font.setBold(column == Name);
    return font;
  }
  if (role != Qt::DisplayRole) return {};
  static const QStringList kNames = {"Scans", "Links", "Results"};
  if (column == Name) return kNames[static_cast<int>(group)];
  return rowCount(groupIndex(group));
}

namespace {

// The same where its row is selected: a tinted swatch would be another scan's colour.
QIcon swatch(const QColor& colour) {
  // Drawn at 2x: sharp on both kinds of screens.
  QPixmap pixmap(32, 32);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush(colour);
  painter.setPen(Qt::NoPen);
  painter.drawRoundedRect(QRectF(4, 4, 24, 24), 6, 6);
  painter.end();
  pixmap.setDevicePixelRatio(2.0);
  QIcon icon(pixmap);
  icon.addPixmap(pixmap, QIcon::Selected);
  return icon;
}

}  // namespace

QVariant ProjectTreeModel::scanData(std::size_t row, int column, int role) const {
  const ScanEntry& scan = snapshot_->scans()[row];
  const ScanDisplay& display = workspace_.display();
  switch (role) {
    case ScanIdRole:
      return static_cast<qlonglong>(scan.id);
    case Qt::DisplayRole:
      return column == Name ? QString("%1  %2").arg(row).arg(qt(scan.name)) : scanSummary(scan);
    case Qt::EditRole:
      return qt(scan.name);
    case Qt::ToolTipRole:
      return scanTip(scan, row);
    case Qt::CheckStateRole:
      if (column == Name) return display.isVisible(scan.id) ? Qt::Checked : Qt::Unchecked;
      return {};
    case Qt::DecorationRole:
      if (column == Name) return swatch(display.colour(scan.id));
      return {};
    default:
      return {};
  }
}

QVariant ProjectTreeModel::linkData(std::size_t row, int column, int role) const {
  const Link& link = snapshot_->links()[row];
  switch (role) {
    case LinkIdRole:
      return static_cast<qlonglong>(link.id);
    case Qt::DisplayRole:
      return column == Name ? qt(linkName(*snapshot_, link))
                            : linkSummary(link, workspace_.preferences().lengthUnit());
    case Qt::ToolTipRole:
      return linkTip(*snapshot_, link, workspace_.preferences().lengthUnit());
    case Qt::FontRole: {
      QFont font;
      font.setStrikeOut(column == Name && link.state == LinkState::Disabled);
      return font;
    }
    default:
      return {};
  }
}

QVariant ProjectTreeModel::stageData(std::size_t row, int column, int role) const {
  const Stage stage = stages_[row];
  const bool shown = workspace_.display().stage() == stage;
  switch (role) {
    case StageRole:
      return static_cast<int>(stage);
    case Qt::DisplayRole:
      return column == Name ? stageTitle(stage) : stageSummary(*snapshot_, stage) + (shown ? ", shown" : "");
    case Qt::ToolTipRole:
      return stageTip(stage) + (shown ? " Places the scans in all views now." : " Double-click to show it.");
    case Qt::FontRole: {
      QFont font;
      font.setBold(shown && column == Name);
      return font;
    }
    default:
      return {};
  }
}

bool ProjectTreeModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  const auto item = itemAt(index);
  if (!item || item->kind != TreeItem::Kind::Scan) return false;
  if (role == Qt::CheckStateRole) {
    workspace_.display().setVisible({item->scan}, value.toInt() == Qt::Checked);
    return true;
  }
  if (role != Qt::EditRole) return false;
  const std::string name = utf8(value.toString().trimmed());
  if (name.empty() || name == snapshot_->find(item->scan)->name) return false;
  return workspace_.session().apply(renameEdit(item->scan, name)).has_value();
}

Qt::ItemFlags ProjectTreeModel::flags(const QModelIndex& index) const {
  const auto item = itemAt(index);
  if (!item) return Qt::ItemIsDropEnabled;
  Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  const bool writable = workspace_.session().isWritable();
  if (item->kind == TreeItem::Kind::ScansGroup) flags |= Qt::ItemIsDropEnabled;
  if (item->kind == TreeItem::Kind::Scan) {
    if (index.column() == Name) flags |= Qt::ItemIsUserCheckable;
    if (writable) flags |= Qt::ItemIsDragEnabled;
    if (writable && index.column() == Name) flags |= Qt::ItemIsEditable;
  }
  return flags;
}

QStringList ProjectTreeModel::mimeTypes() const {
  return {kScanMime};
}

QMimeData* ProjectTreeModel::mimeData(const QModelIndexList& indexes) const {
  QByteArray bytes;
  QDataStream stream(&bytes, QIODevice::WriteOnly);
  for (const QModelIndex& index : indexes) {
    const auto item = itemAt(index);
    if (item && item->kind == TreeItem::Kind::Scan && index.column() == 0)
      stream << static_cast<qint64>(item->scan);
  }
  auto* data = new QMimeData;
  data->setData(kScanMime, bytes);
  return data;
}

bool ProjectTreeModel::canDropMimeData(const QMimeData* data, Qt::DropAction action, int, int,
                                       const QModelIndex& parent) const {
  const auto item = itemAt(parent);
  return action == Qt::MoveAction && data->hasFormat(kScanMime) && item &&
         item->kind == TreeItem::Kind::ScansGroup && workspace_.session().isWritable();
}

bool ProjectTreeModel::dropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                                    const QModelIndex& parent) {
  if (!canDropMimeData(data, action, row, column, parent)) return false;
  std::vector<ScanId> moved;
  QDataStream stream(data->data(kScanMime));
  while (!stream.atEnd()) {
    qint64 id = 0;
    stream >> id;
    moved.push_back(id);
  }
  const std::size_t place = row < 0 ? snapshot_->scans().size() : static_cast<std::size_t>(row);
  const ProjectEdit edit = reorderEdit(*snapshot_, moved, place);
  if (!edit.empty()) (void)workspace_.session().apply(edit);
  // False: the view would else take the dragged rows out itself; the model has been read again.
  return false;
}

}  // namespace tiltmap::ui
