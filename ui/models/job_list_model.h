// The jobs of the window in the order they were started: what waits, what runs, what came of the rest.
#pragma once

#include <QAbstractTableModel>

#include "ui/models/job_queue.h"

namespace tiltmap::ui {

class JobListModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { Title, State, Progress, Time, kColumns };

  explicit JobListModel(JobQueue& jobs, QObject* parent = nullptr);
  int jobAt(int row) const { return jobs_[static_cast<std::size_t>(row)].id; }
  JobPhase phaseAt(int row) const { return jobs_[static_cast<std::size_t>(row)].phase; }

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  void readAgain();

  JobQueue& queue_;
  std::vector<JobStatus> jobs_;
};

}  // namespace tiltmap::ui
