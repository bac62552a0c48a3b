#include "ui/models/relaxation_table_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ui/models/project_words.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

RelaxationTableModel::RelaxationTableModel(Workspace& workspace, QObject* parent)
    : QAbstractTableModel(parent), workspace_(workspace) {
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &RelaxationTableModel::readAgain);
  connect(&workspace.relaxation(), &RelaxationModel::reset, this, &RelaxationTableModel::readAgain);
  connect(&workspace.relaxation(), &RelaxationModel::changed, this, &RelaxationTableModel::readAgain);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &RelaxationTableModel::readAgain);
  readAgain();
}

std::vector<RelaxationTableModel::Row> RelaxationTableModel::read() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const RelaxationModel& relaxation = workspace_.relaxation();
  source_ = Source::Nothing;
  truth_known_ = false;
  if (!snapshot) return {};
  const std::size_t count = snapshot->scans().size();
  std::vector<Pose> before = snapshot->filledPoses(snapshot->latestStage()), after = before;
  const bool live = relaxation.isRunning() || relaxation.isProposal();
  if (live && relaxation.scans().size() == count) {
    source_ = relaxation.isProposal() ? Source::Proposal : Source::Running;
    before = relaxation.startPoses();
    after = relaxation.poses();
    stage_before_ = "pairwise";
  } else if (snapshot->hasStage(Stage::Relaxed)) {
    const Stage stage = snapshot->hasStage(Stage::Pairwise) ? Stage::Pairwise : Stage::Odometry;
    source_ = Source::Stages;
    before = snapshot->filledPoses(stage);
    after = snapshot->filledPoses(Stage::Relaxed);
    stage_before_ = qt(stageName(stage));
  }
  truth_known_ = source_ != Source::Nothing && snapshot->hasStage(Stage::Truth);
  const std::vector<Pose> truth = truth_known_ ? snapshot->filledPoses(Stage::Truth) : std::vector<Pose>();
  std::vector<Row> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    Row& row = rows[i];
    row.scan = snapshot->scans()[i].id;
    row.name = qt(snapshot->scans()[i].name);
    row.first = i == 0;
    row.pinned = row.first || snapshot->isPinned(row.scan);
    row.role = source_ == Source::Running ? static_cast<int>(relaxation.role(static_cast<int>(i))) : 0;
    row.before = before[i];
    row.after = after[i];
    row.moved = difference(before[i], after[i]);
    if (!truth_known_) continue;
    row.error_before_m = (before[i].translation() - truth[i].translation()).norm();
    row.error_after_m = (after[i].translation() - truth[i].translation()).norm();
  }
  return rows;
}

void RelaxationTableModel::readAgain() {
  const bool truth = truth_known_;
  const Source source = source_;
  std::vector<Row> rows = read();
  const auto sameScans = std::ranges::equal(rows, rows_, {}, &Row::scan, &Row::scan);
  // While numbers run, the table keeps its selection and its place.
  if (sameScans && truth == truth_known_ && source == source_) {
    rows_ = std::move(rows);
    if (!rows_.empty())
      Q_EMIT dataChanged(index(0, 0), index(static_cast<int>(rows_.size()) - 1, columnCount() - 1));
    return;
  }
  beginResetModel();
  rows_ = std::move(rows);
  endResetModel();
}

QString RelaxationTableModel::title() const {
  switch (source_) {
    case Source::Nothing:
      return "Nothing has been relaxed yet";
    case Source::Running:
      return "So far: where it began, and where it is";
    case Source::Proposal:
      return "Proposal, not stored yet: before, and after";
    case Source::Stages:
      return "In the project: " + stage_before_ + " before, relaxed after";
  }
  return {};
}

QString RelaxationTableModel::summary() const {
  if (source_ == Source::Nothing || rows_.empty()) return {};
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const auto furthest =
      std::ranges::max_element(rows_, {}, [](const Row& row) { return row.moved.translation_m; });
  QString text = QString("Furthest: scan %1 by %2")
                     .arg(furthest - rows_.begin())
                     .arg(smallLengthText(furthest->moved.translation_m, unit));
  if (!truth_known_) return text;
  double before = 0.0, after = 0.0;
  for (const Row& row : rows_) {
    before += row.error_before_m * row.error_before_m;
    after += row.error_after_m * row.error_after_m;
  }
  const auto count = static_cast<double>(rows_.size());
  return text + QString(". RMSE against the truth: %1 before, %2 after")
                    .arg(smallLengthText(std::sqrt(before / count), unit),
                         smallLengthText(std::sqrt(after / count), unit));
}

int RelaxationTableModel::rowOf(ScanId scan) const {
  const auto row = std::ranges::find(rows_, scan, &Row::scan);
  return row == rows_.end() ? -1 : static_cast<int>(row - rows_.begin());
}

double RelaxationTableModel::moved_m(int row) const {
  return rows_[static_cast<std::size_t>(row)].moved.translation_m;
}

int RelaxationTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}
int RelaxationTableModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(kColumns);
}

QVariant RelaxationTableModel::number(const Row& row, int column) const {
  switch (column) {
    case Stop:
      return rowOf(row.scan);
    case Pin:
      return row.pinned;
    case Role:
      return row.role;
    case Moved:
      return row.moved.translation_m;
    case Turned:
      return row.moved.rotation_rad;
    case ErrorBefore:
      return row.error_before_m;
    case ErrorAfter:
      return row.error_after_m;
    default:
      return column < AfterX ? row.before.translation()[column - BeforeX]
                             : row.after.translation()[column - AfterX];
  }
}

QString RelaxationTableModel::text(const Row& row, int column) const {
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const auto small = [unit](double metres) {
    return unit == LengthUnit::Foot ? qt(fixedReal(inUnit(metres, unit), 4))
                                    : qt(fixedReal(1000.0 * metres, 1));
  };
  if (column == Stop) return QString::number(rowOf(row.scan));
  if (column == Pin) return {};
  if (column == Role) {
    if (source_ == Source::Running) return relaxationRoleName(static_cast<RelaxationRole>(row.role));
    return row.first ? "origin" : row.pinned ? "pinned" : "";
  }
  if (source_ == Source::Nothing && (column < BeforeX || column > BeforeZ)) return {};
  if ((column == ErrorBefore || column == ErrorAfter) && !truth_known_) return {};
  if (column == Moved) return small(row.moved.translation_m);
  if (column == Turned) return qt(fixedReal(row.moved.rotation_rad / kDegree, 3));
  if (column == ErrorBefore) return small(row.error_before_m);
  if (column == ErrorAfter) return small(row.error_after_m);
  return lengthNumber(number(row, column).toDouble(), unit);
}

QVariant RelaxationTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Row& row = rows_[static_cast<std::size_t>(index.row())];
  const int column = index.column();
  switch (role) {
    case Qt::DisplayRole:
      return text(row, column);
    case kSortRole:
      return number(row, column);
    case Qt::CheckStateRole:
      if (column != Pin) return {};
      return row.pinned ? Qt::Checked : Qt::Unchecked;
    case Qt::TextAlignmentRole:
      return static_cast<int>((column == Role || column == Pin ? Qt::AlignLeft : Qt::AlignRight) |
                              Qt::AlignVCenter);
    case Qt::ToolTipRole: {
      if (column == Pin)
        return row.first ? "Scan 0 is the origin and never moves"
                         : "Pinned scans stay where they are when the survey is relaxed";
      const auto what = static_cast<RelaxationRole>(row.role);
      const QString tip = QString("Stop %1: %2").arg(rowOf(row.scan)).arg(row.name);
      return column == Role && what != RelaxationRole::None ? tip + "\n" + relaxationRoleTip(what) : tip;
    }
    case Qt::AccessibleTextRole:
      if (column == Pin)
        return QString("Stop %1 %2").arg(rowOf(row.scan)).arg(row.pinned ? "pinned" : "not pinned");
      return {};
    default:
      return {};
  }
}

Qt::ItemFlags RelaxationTableModel::flags(const QModelIndex& index) const {
  Qt::ItemFlags flags = QAbstractTableModel::flags(index);
  if (index.column() != Pin) return flags;
  flags |= Qt::ItemIsUserCheckable;
  // The work would go on with the pins that it began with.
  const bool free = workspace_.session().isWritable() && !workspace_.jobs().busy();
  if (rows_[static_cast<std::size_t>(index.row())].first || !free) flags &= ~Qt::ItemIsEnabled;
  return flags;
}

bool RelaxationTableModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (index.column() != Pin || role != Qt::CheckStateRole || !(flags(index) & Qt::ItemIsEnabled))
    return false;
  const SnapshotPtr snapshot = workspace_.snapshot();
  const ScanId scan = scanAt(index.row());
  std::vector<ScanId> pins = snapshot->pins();
  const bool pinned = value.toInt() == Qt::Checked;
  if (pinned == snapshot->isPinned(scan)) return false;
  if (pinned)
    pins.push_back(scan);
  else
    std::erase(pins, scan);
  ProjectEdit edit = pinsEdit(*snapshot, pins);
  const std::string name = snapshot->find(scan)->name;
  edit.title = (pinned ? "pin " : "unpin ") + name;
  return static_cast<bool>(workspace_.session().apply(edit));
}

QVariant RelaxationTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  if (role == Qt::TextAlignmentRole)
    return static_cast<int>((section == Role || section == Pin ? Qt::AlignLeft : Qt::AlignRight) |
                            Qt::AlignVCenter);
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const QString name = unitName(unit);
  const QString small = unit == LengthUnit::Foot ? QString("ft") : QString("mm");
  const QStringList titles = {"Stop",
                              "Pin",
                              "Set",
                              "Moved (" + small + ")",
                              "Turned (°)",
                              "Error before (" + small + ")",
                              "Error after (" + small + ")",
                              "x before (" + name + ")",
                              "y before (" + name + ")",
                              "z before (" + name + ")",
                              "x after (" + name + ")",
                              "y after (" + name + ")",
                              "z after (" + name + ")"};
  static const QStringList kTips = {"Index of the stop in the survey",
                                    "Whether a relaxation leaves the stop where it is",
                                    "What the stop is to the relaxation that runs",
                                    "Distance between before and after",
                                    "Angle between before and after",
                                    "Distance from where the stop truly is, before",
                                    "Distance from where the stop truly is, after",
                                    "Position before",
                                    "Position before",
                                    "Position before",
                                    "Position after",
                                    "Position after",
                                    "Position after"};
  if (role == Qt::DisplayRole) return titles.value(section);
  if (role == Qt::ToolTipRole) return kTips.value(section);
  return {};
}

}  // namespace tiltmap::ui
