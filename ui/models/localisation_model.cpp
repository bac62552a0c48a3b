#include "ui/models/localisation_model.h"

#include <QFont>
#include <algorithm>

#include "core/base/text.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr std::size_t kNamedRows = 4;  // in one line; the table marks all

}  // namespace

LocalisationModel::LocalisationModel(Workspace& workspace, QObject* parent)
    : QAbstractTableModel(parent), workspace_(workspace) {
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &LocalisationModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &LocalisationModel::readAgain);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &LocalisationModel::readAgain);
  readAgain();
}

void LocalisationModel::readAgain() {
  beginResetModel();
  snapshot_ = workspace_.snapshot();
  table_ = {};
  filled_.clear();
  evaluation_.reset();
  overruled_.clear();
  if (snapshot_ && !snapshot_->scans().empty()) {
    stage_ = workspace_.display().stage();
    const std::vector<Pose> poses = snapshot_->filledPoses(stage_);
    table_ = localisationTable(stageName(stage_), poses);
    for (const auto& pose : snapshot_->poses(stage_)) filled_.push_back(!pose);
    if (stage_ != Stage::Truth && snapshot_->hasStage(Stage::Truth))
      if (auto evaluation = evaluateTrajectory(poses, snapshot_->filledPoses(Stage::Truth)))
        evaluation_ = std::move(*evaluation);
    const Stage latest = snapshot_->latestStage();
    if (latest == Stage::Pairwise || latest == Stage::Relaxed) overruled_ = overruledRows(*snapshot_, latest);
  }
  endResetModel();
}

QString LocalisationModel::summary() const {
  QString text;
  if (evaluation_)
    text = QString("RMSE %1, %2° against the truth")
               .arg(smallLengthText(evaluation_->rmse_translation_m, workspace_.preferences().lengthUnit()),
                    qt(fixedReal(evaluation_->rmse_rotation_deg, 3)));
  if (overruled_.empty()) return text;
  if (!text.isEmpty()) text += "; ";
  if (overruled_.size() > kNamedRows)
    return text + QString("odometry overruled at %1 stops").arg(overruled_.size());
  QStringList stops;
  for (const OverruledRow& row : overruled_) stops << QString::number(row.scan);
  return text + QString("odometry overruled at stop%1 %2").arg(stops.size() > 1 ? "s" : "", stops.join(", "));
}

const OverruledRow* LocalisationModel::overruled(std::size_t stop) const {
  const auto row = std::ranges::find(overruled_, stop, &OverruledRow::scan);
  return row == overruled_.end() ? nullptr : &*row;
}

QString LocalisationModel::asText() const {
  return table_.rows.empty() ? QString() : qt(textOf(table_));
}

QString LocalisationModel::asCsv() const {
  return table_.rows.empty() ? QString() : qt(csvOf(table_));
}

int LocalisationModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(table_.rows.size());
}

int LocalisationModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : evaluation_ ? Angle + 1 : static_cast<int>(kColumns);
}

QString LocalisationModel::number(const LocalisationRow& row, int column) const {
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  if (column == Stop) return QString::number(row.stop) + (overruled(row.stop) ? " !" : "");
  if (column <= Z) return lengthNumber(row.position_m[column - X], unit);
  if (column <= HeadingZ) return qt(fixedReal(row.heading[column - HeadingX], 4));
  const StopError& error = evaluation_->stops[row.stop];
  if (column == Distance)
    return unit == LengthUnit::Foot ? qt(fixedReal(inUnit(error.translation_error_m, unit), 3))
                                    : qt(fixedReal(1000.0 * error.translation_error_m, 1));
  return qt(fixedReal(error.rotation_error_deg, 3));
}

QVariant LocalisationModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const auto row = static_cast<std::size_t>(index.row());
  switch (role) {
    case Qt::DisplayRole:
      return number(table_.rows[row], index.column());
    case Qt::TextAlignmentRole:
      return static_cast<int>(Qt::AlignRight | Qt::AlignVCenter);
    case Qt::FontRole: {
      QFont font;
      font.setItalic(filled_[row]);
      return font;
    }
    case Qt::ToolTipRole: {
      QString text = QString("Stop %1: %2").arg(row).arg(qt(snapshot_->scans()[row].name));
      if (filled_[row])
        text += "\nNo pose of this stage: placed by odometry from the nearest stop that has one";
      if (const OverruledRow* wrong = overruled(row)) text += "\nBut " + qt(wrong->sentence());
      return text;
    }
    default:
      return {};
  }
}

QVariant LocalisationModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  if (role == Qt::TextAlignmentRole) return static_cast<int>(Qt::AlignRight | Qt::AlignVCenter);
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const QString name = unitName(unit);
  const QString small = unit == LengthUnit::Foot ? QString("ft") : QString("mm");
  const QStringList titles = {"Stop",      "x (" + name + ")", "y (" + name + ")", "z (" + name + ")",
                              "heading x", "heading y",        "heading z",        "error (" + small + ")",
                              "turned (°)"};
  static const QStringList kTips = {"Index of the stop in the survey",
                                    "Position, to the right of stop 0",
                                    "Position, ahead of stop 0",
                                    "Position, above stop 0",
                                    "Where the scanner looks: unit vector",
                                    "Where the scanner looks: unit vector",
                                    "Where the scanner looks: unit vector",
                                    "Distance from where the stop truly is",
                                    "Angle to how the stop truly stands"};
  if (role == Qt::DisplayRole) return titles.value(section);
  if (role == Qt::ToolTipRole) return kTips.value(section);
  return {};
}

ScanId LocalisationModel::scanAt(int row) const {
  return snapshot_->scans()[static_cast<std::size_t>(row)].id;
}

int LocalisationModel::rowOf(ScanId scan) const {
  const auto index = snapshot_ ? snapshot_->indexOf(scan) : std::nullopt;
  return index ? static_cast<int>(*index) : -1;
}

}  // namespace tiltmap::ui
