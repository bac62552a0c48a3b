#include "ui/models/log_model.h"

#include <QThread>

namespace tiltmap::ui {

LogModel::LogModel(QObject* parent) : QAbstractTableModel(parent) {
  setLogListener([this](const LogLine& line) {
    if (QThread::currentThread() == thread())
      append(line);
    else
      deliveries_.post([this, line] { append(line); });
  });
}

LogModel::~LogModel() {
  setLogListener({});
}

void LogModel::append(const LogLine& line) {
  if (lines_.size() >= static_cast<std::size_t>(kLines)) {
    beginRemoveRows({}, 0, 0);
    lines_.pop_front();
    endRemoveRows();
  }
  const int row = static_cast<int>(lines_.size());
  beginInsertRows({}, row, row);
  lines_.push_back(line);
  endInsertRows();
}

int LogModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(lines_.size());
}

int LogModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : kColumns;
}

QVariant LogModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const LogLine& line = this->line(index.row());
  if (role == Qt::ToolTipRole) return line.text;
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case Time:
      return line.time.toString("HH:mm:ss.zzz");
    case Level:
      return logLevelName(line.level);
    case Text:
      return QString(line.text).replace('\n', "  ");
    default:
      return {};
  }
}

QVariant LogModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  static const QStringList kNames = {"Time", "Level", "What happened"};
  return kNames.value(section);
}

QString LogModel::allText() const {
  QString text;
  for (const LogLine& line : lines_)
    text += line.time.toString(Qt::ISODateWithMs) + " " + logLevelName(line.level) + " " + line.text + "\n";
  return text;
}

LogModel& sharedLogModel() {
  static LogModel model;
  return model;
}

}  // namespace tiltmap::ui
