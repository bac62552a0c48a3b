// The project as a tree: scans, links, results by stage.
#pragma once

#include <QAbstractItemModel>
#include <optional>

#include "core/project/project_edit.h"

namespace tiltmap::ui {

class Workspace;

// What a row stands for.
struct TreeItem {
  enum class Kind { ScansGroup, LinksGroup, StagesGroup, Scan, Link, Stage };
  Kind kind = Kind::ScansGroup;
  ScanId scan = 0;
  LinkId link = 0;
  Stage stage = Stage::Odometry;
  bool isGroup() const { return kind <= Kind::StagesGroup; }
};

// Scans have a check box (visible), a colour and an editable name, and may be dragged into another order; the
// stage that places the scans is in bold. All changes go through the session as edits.
class ProjectTreeModel : public QAbstractItemModel {
  Q_OBJECT

 public:
  enum Column { Name, Detail, kColumns };
  enum Role { ScanIdRole = Qt::UserRole, LinkIdRole, StageRole, KindRole };

  explicit ProjectTreeModel(Workspace& workspace, QObject* parent = nullptr);

  std::optional<TreeItem> itemAt(const QModelIndex& index) const;
  QModelIndex indexOfScan(ScanId scan) const;
  QModelIndex indexOfLink(LinkId link) const;
  QModelIndex groupIndex(TreeItem::Kind group) const;

  QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  QModelIndex parent(const QModelIndex& child) const override;
  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;

  Qt::DropActions supportedDropActions() const override { return Qt::MoveAction; }
  QStringList mimeTypes() const override;
  QMimeData* mimeData(const QModelIndexList& indexes) const override;
  bool canDropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                       const QModelIndex& parent) const override;
  bool dropMimeData(const QMimeData* data, Qt::DropAction action, int row, int column,
                    const QModelIndex& parent) override;

 private:
  void readAgain();
  void update(const Change& change);
  void repaintAll();
  QVariant groupData(TreeItem::Kind group, int column, int role) const;
  QVariant scanData(std::size_t row, int column, int role) const;
  QVariant linkData(std::size_t row, int column, int role) const;
  QVariant stageData(std::size_t row, int column, int role) const;

  Workspace& workspace_;
  SnapshotPtr snapshot_;
  std::vector<Stage> stages_;
};

}  // namespace tiltmap::ui
