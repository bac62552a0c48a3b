// Scan by scan: pinned or not, what it is to the relaxation, and how far that moves it, before and after.
#pragma once

#include <QAbstractTableModel>

#include "core/project/project_snapshot.h"

namespace tiltmap::ui {

class Workspace;

// Of the relaxation that runs or waits to be accepted; else of the project's stages, the last but one and the
// relaxed. The pin is a check box: an edit of the project.
class RelaxationTableModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column {
    Stop,
    Pin,
    Role,
    Moved,
    Turned,
    ErrorBefore,  // against the truth, where that is known
    ErrorAfter,
    BeforeX,
    BeforeY,
    BeforeZ,
    AfterX,
    AfterY,
    AfterZ,
    kColumns
  };
  enum class Source { Nothing, Running, Proposal, Stages };
  // Numbers to sort by.
  static constexpr int kSortRole = Qt::UserRole + 1;

  explicit RelaxationTableModel(Workspace& workspace, QObject* parent = nullptr);

  Source source() const { return source_; }
  bool truthKnown() const { return truth_known_; }
  QString title() const;  // "Proposal: pairwise poses before, relaxed after"
  // "furthest 41.2 mm (scan 9); RMSE 23.1 mm before, 4.0 mm after": empty where there is nothing to compare.
  QString summary() const;
  ScanId scanAt(int row) const { return rows_[static_cast<std::size_t>(row)].scan; }
  int rowOf(ScanId scan) const;  // -1 where it is not there
  double moved_m(int row) const;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  struct Row {
    ScanId scan = 0;
    QString name;
    bool pinned = false, first = false;
    int role = 0;  // RelaxationRole; shown while it runs
    Pose before, after;
    PoseDifference moved;
    double error_before_m = 0.0, error_after_m = 0.0;
  };
  void readAgain();
  std::vector<Row> read();
  QString text(const Row& row, int column) const;
  QVariant number(const Row& row, int column) const;

  Workspace& workspace_;
  std::vector<Row> rows_;
  Source source_ = Source::Nothing;
  bool truth_known_ = false;
  QString stage_before_;
};

}  // namespace tiltmap::ui
