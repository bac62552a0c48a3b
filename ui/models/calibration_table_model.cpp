#include "ui/models/calibration_table_model.h"

#include <QFont>

namespace tiltmap::ui {

namespace {

bool same(const std::vector<FindingRow>& a, const std::vector<FindingRow>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FindingRow& x, const FindingRow& y) {
    return x.quantity == y.quantity && x.before == y.before && x.value == y.value &&
           x.deviation == y.deviation && x.unit == y.unit && x.reason == y.reason;
  });
}

}  // namespace

CalibrationTableModel::CalibrationTableModel(CalibrationModel& model, QObject* parent)
    : QAbstractTableModel(parent), model_(model), rows_(model.rows()) {
  connect(&model, &CalibrationModel::changed, this, &CalibrationTableModel::readAgain);
}

void CalibrationTableModel::readAgain() {
  if (same(rows_, model_.rows())) return;
  beginResetModel();
  rows_ = model_.rows();
  endResetModel();
}

int CalibrationTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}
int CalibrationTableModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(kColumns);
}

QVariant CalibrationTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const FindingRow& row = rows_[static_cast<std::size_t>(index.row())];
  if (role == Qt::ToolTipRole) return row.reason.isEmpty() ? QVariant() : QVariant(row.reason);
  if (role == Qt::TextAlignmentRole)
    return static_cast<int>(
        (index.column() >= Found && index.column() <= Before ? Qt::AlignRight : Qt::AlignLeft) |
        Qt::AlignVCenter);
  if (role == Qt::FontRole && row.told && index.column() == Found) {
    QFont font;
    font.setBold(true);
    return font;
  }
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case Quantity:
      return row.quantity;
    case Found:
      return row.value;
    case Deviation:
      return row.deviation;
    case Before:
      return row.before;
    case Unit:
      return row.unit;
    default:
      return row.reason;
  }
}

QVariant CalibrationTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  static const QStringList kTitles = {"Quantity", "Found", "σ", "Before", "Unit", "Not told"};
  static const QStringList kTips = {"What of the scanner is estimated",
                                    "The estimate; – where there is none",
                                    "One standard deviation of the estimate",
                                    "What the scans have had until now",
                                    "Unit of the numbers",
                                    "Why these scans do not tell it"};
  if (role == Qt::DisplayRole) return kTitles.value(section);
  if (role == Qt::ToolTipRole) return kTips.value(section);
  if (role == Qt::TextAlignmentRole)
    return static_cast<int>((section >= Found && section <= Before ? Qt::AlignRight : Qt::AlignLeft) |
                            Qt::AlignVCenter);
  return {};
}

}  // namespace tiltmap::ui
