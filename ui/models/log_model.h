// The lines of the log, newest last.
#pragma once

#include <QAbstractTableModel>
#include <deque>

#include "ui/models/deliveries.h"
#include "ui/models/log.h"

namespace tiltmap::ui {

class LogModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { Time, Level, Text, kColumns };
  static constexpr int kLines = 5000;  // older ones are in the file

  // Listens to the log while it lives.
  explicit LogModel(QObject* parent = nullptr);
  ~LogModel() override;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  const LogLine& line(int row) const { return lines_[static_cast<std::size_t>(row)]; }
  QString allText() const;

 private:
  void append(const LogLine& line);

  Deliveries deliveries_;  // from whatever thread logs
  std::deque<LogLine> lines_;
};

// The program's one: all windows show the same log. Made on first use, on the window thread.
LogModel& sharedLogModel();

}  // namespace tiltmap::ui
