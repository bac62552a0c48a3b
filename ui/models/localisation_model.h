// Where the stops are at a stage: the thesis' tables 5.1, 5.2 and 6.1 to 6.3, with errors where the truth is
// known.
#pragma once

#include <QAbstractTableModel>

#include "core/products/evaluation.h"
#include "core/products/localisation_table.h"
#include "core/project/odometry_check.h"
#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

class Workspace;

// Shows the workspace's stage. Columns: stop, x, y, z, heading x, y, z, and with a known truth the distance
// and the angle to it.
class LocalisationModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { Stop, X, Y, Z, HeadingX, HeadingY, HeadingZ, kColumns, Distance = kColumns, Angle };

  explicit LocalisationModel(Workspace& workspace, QObject* parent = nullptr);

  const LocalisationTable& table() const { return table_; }
  Stage stage() const { return stage_; }
  const std::optional<TrajectoryEvaluation>& evaluation() const { return evaluation_; }
  // "RMSE 12.3 mm, 0.041 deg against the truth" where that is known, and the stops whose odometry the scans
  // contradict.
  QString summary() const;
  // The table as text for a letter or a spreadsheet (metres); all rows.
  QString asText() const;
  QString asCsv() const;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  ScanId scanAt(int row) const;
  int rowOf(ScanId scan) const;  // -1 where it is not in the table

 private:
  void readAgain();
  QString number(const LocalisationRow& row, int column) const;
  const OverruledRow* overruled(std::size_t stop) const;  // null where its odometry holds

  Workspace& workspace_;
  SnapshotPtr snapshot_;
  Stage stage_ = Stage::Odometry;
  LocalisationTable table_;
  std::vector<bool> filled_;  // the pose is carried on by odometry, not of the stage
  std::optional<TrajectoryEvaluation> evaluation_;
  std::vector<OverruledRow> overruled_;  // at the latest stage, whichever is shown
};

}  // namespace tiltmap::ui
