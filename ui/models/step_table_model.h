// The iterations of the stepper as a table.
#pragma once

#include <QAbstractTableModel>

namespace tiltmap::ui {

class StepperModel;

// One row an iteration, in order; row k is position k + 1 of the stepper.
class StepTableModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column {
    Iteration,
    Attempt,
    Rms,
    Change,
    Kept,
    Rejected,
    Scale,
    Shift,
    Turn,
    Overlap,
    Agreement,
    kColumns
  };

  explicit StepTableModel(const StepperModel& stepper, QObject* parent = nullptr);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  void stepsChanged();

  const StepperModel& stepper_;
  int rows_ = 0;
};

}  // namespace tiltmap::ui
