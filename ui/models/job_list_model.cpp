#include "ui/models/job_list_model.h"

#include "ui/models/strings.h"
#include "ui/models/units.h"

namespace tiltmap::ui {

JobListModel::JobListModel(JobQueue& jobs, QObject* parent) : QAbstractTableModel(parent), queue_(jobs) {
  connect(&jobs, &JobQueue::changed, this, &JobListModel::readAgain);
  connect(&jobs, &JobQueue::busyChanged, this, &JobListModel::readAgain);
  readAgain();
}

void JobListModel::readAgain() {
  std::vector<JobStatus> now = queue_.jobs();
  if (now.size() == jobs_.size() && !now.empty()) {
    jobs_ = std::move(now);
    Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
    return;
  }
  beginResetModel();
  jobs_ = std::move(now);
  endResetModel();
}

int JobListModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(jobs_.size());
}
int JobListModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(kColumns);
}

QVariant JobListModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const JobStatus& job = jobs_[static_cast<std::size_t>(index.row())];
  if (role == Qt::TextAlignmentRole)
    return static_cast<int>((index.column() >= Progress ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
  if (role == Qt::ToolTipRole) {
    if (job.error) return qt(job.error->what) + "\n" + qt(job.error->remedy);
    return job.message;
  }
  if (role != Qt::DisplayRole) return {};
  switch (index.column()) {
    case Title:
      return job.title;
    case State:
      return jobPhaseName(job.phase);
    case Progress:
      return job.phase == JobPhase::Queued || job.fraction < 0.0
                 ? QString()
                 : QString("%1 %").arg(static_cast<int>(100.0 * job.fraction));
    case Time:
      return job.phase == JobPhase::Queued ? QString() : QString("%1 s").arg(job.elapsed_s, 0, 'f', 1);
    default:
      return {};
  }
}

QVariant JobListModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  if (role == Qt::TextAlignmentRole)
    return static_cast<int>((section >= Progress ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
  static const QStringList kTitles = {"Work", "State", "Done", "Time"};
  static const QStringList kTips = {"What is to be done", "Whether it waits, runs or has ended",
                                    "How much of it is done", "How long it has taken"};
  if (role == Qt::DisplayRole) return kTitles.value(section);
  if (role == Qt::ToolTipRole) return kTips.value(section);
  return {};
}

}  // namespace tiltmap::ui
