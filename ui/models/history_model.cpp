#include "ui/models/history_model.h"

#include <QDateTime>
#include <QFont>
#include <algorithm>

#include "ui/models/project_session.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

HistoryModel::HistoryModel(const ProjectSession& session, QObject* parent)
    : QAbstractTableModel(parent), session_(session) {
  snapshot_ = session.snapshot();
  connect(&session, &ProjectSession::snapshotReplaced, this, [this] {
    beginResetModel();
    snapshot_ = session_.snapshot();
    endResetModel();
  });
}

int HistoryModel::currentRow() const {
  if (!snapshot_) return -1;
  return static_cast<int>(
      std::ranges::count(snapshot_->history(), false, [](const HistoryEntry& e) { return e.undone; }));
}

int HistoryModel::earliestRow() const {
  if (!snapshot_) return 0;
  return static_cast<int>(
      std::ranges::count(snapshot_->history(), true, [](const HistoryEntry& e) { return e.fixed; }));
}

int HistoryModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() || !snapshot_ ? 0 : static_cast<int>(snapshot_->history().size()) + 1;
}

int HistoryModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : kColumns;
}

QVariant HistoryModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || !snapshot_) return {};
  const HistoryEntry* entry =
      index.row() > 0 ? &snapshot_->history()[static_cast<std::size_t>(index.row() - 1)] : nullptr;
  const bool current = index.row() == currentRow();
  if (role == Qt::FontRole) {
    QFont font;
    font.setBold(current);
    font.setItalic(entry && entry->undone);
    return font;
  }
  const QDateTime when =
      entry ? QDateTime::fromString(qt(entry->time), Qt::ISODateWithMs).toLocalTime() : QDateTime();
  if (role == Qt::ToolTipRole) {
    const QString what = current ? QString("The project stands here")
                                 : QString("Double-click to bring the project to this state");
    return entry ? QString("%1, %2\n%3").arg(qt(entry->title), when.toString("yyyy-MM-dd HH:mm:ss"), what)
                 : what;
  }
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case What:
      return entry ? qt(entry->title) : QString("project made");
    case When:
      // Today's without their date: the column is in a narrow panel. The tooltip has all of it.
      return when.toString(when.date() == QDate::currentDate() ? "HH:mm:ss" : "yyyy-MM-dd HH:mm");
    case State:
      if (current) return "here";
      return !entry          ? QString()
             : entry->undone ? QString("undone")
             : entry->fixed  ? QString("fixed")
                             : QString("done");
    default:
      return {};
  }
}

QVariant HistoryModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  static const QStringList kNames = {"Edit", "When", "State"};
  return kNames.value(section);
}

Qt::ItemFlags HistoryModel::flags(const QModelIndex& index) const {
  if (!index.isValid() || index.row() < earliestRow()) return Qt::NoItemFlags;
  return Qt::ItemIsEnabled | Qt::ItemIsSelectable;
}

}  // namespace tiltmap::ui
