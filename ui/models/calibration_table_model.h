// The table of what a calibration found: quantity, before, found, uncertainty, unit, and why not.
#pragma once

#include <QAbstractTableModel>

#include "ui/models/calibration_model.h"

namespace tiltmap::ui {

class CalibrationTableModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  enum Column { Quantity, Found, Deviation, Before, Unit, Reason, kColumns };

  explicit CalibrationTableModel(CalibrationModel& model, QObject* parent = nullptr);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role = Qt::DisplayRole) const override;

 private:
  void readAgain();

  CalibrationModel& model_;
  std::vector<FindingRow> rows_;
};

}  // namespace tiltmap::ui
