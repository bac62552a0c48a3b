// What was done to the project, oldest first, with the place where it stands now.
#pragma once

#include <QAbstractTableModel>

#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

class ProjectSession;

// Row 0 is the project as it was made; row k the state after k edits. A row below the present one was undone
// and can be brought back.
class HistoryModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { What, When, State, kColumns };

  explicit HistoryModel(const ProjectSession& session, QObject* parent = nullptr);

  int currentRow() const;  // -1 with no project
  // Rows before it were compacted: undo does not reach them.
  int earliestRow() const;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;

 private:
  const ProjectSession& session_;
  SnapshotPtr snapshot_;
};

}  // namespace tiltmap::ui
