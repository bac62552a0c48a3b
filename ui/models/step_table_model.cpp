#include "ui/models/step_table_model.h"

#include "ui/models/stepper_model.h"

namespace tiltmap::ui {

namespace {

struct Heading {
  const char* text;
  const char* tip;
};
constexpr Heading kHeadings[] = {
    {"Step", "Number of the iteration within its attempt"},
    {"Attempt", "Which attempt it belongs to; more than one where the result was doubted"},
    {"RMS (mm)", "Root mean square of the kept pairs' residuals before the step, weighted by the loss"},
    {"Change (%)", "Of the mean squared residual against the step before"},
    {"Kept", "Pairs used for the motion"},
    {"Rejected", "Pairs found but not used"},
    {"Scale (mm)", "Of the loss; in the end what is added to the patches' own deviation"},
    {"Shift (mm)", "How far the step moved the scan"},
    {"Turn (deg)", "How far the step turned the scan"},
    {"Matched (%)", "Share of the moving scan's elements in reach of the fixed scan that fit it"},
    {"Agree (%)", "Share of the kept pairs within three deviations"}};

}  // namespace

StepTableModel::StepTableModel(const StepperModel& stepper, QObject* parent)
    : QAbstractTableModel(parent), stepper_(stepper), rows_(stepper.count()) {
  connect(&stepper, &StepperModel::stepsChanged, this, &StepTableModel::stepsChanged);
}

void StepTableModel::stepsChanged() {
  const int now = stepper_.count();
  if (now == rows_ + 1) {
    beginInsertRows({}, rows_, rows_);
    rows_ = now;
    endInsertRows();
  } else {
    beginResetModel();
    rows_ = now;
    endResetModel();
  }
}

int StepTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : rows_;
}

int StepTableModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : kColumns;
}

QVariant StepTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || section < 0 || section >= kColumns) return {};
  if (role == Qt::DisplayRole) return kHeadings[section].text;
  if (role == Qt::ToolTipRole) return kHeadings[section].tip;
  return {};
}

QVariant StepTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= stepper_.count()) return {};
  if (role == Qt::TextAlignmentRole) return static_cast<int>(Qt::AlignRight | Qt::AlignVCenter);
  if (role != Qt::DisplayRole) return {};
  const TraceStep& step = *stepper_.steps()[static_cast<std::size_t>(index.row())];
  const StepReport& report = step.report;
  const auto number = [](double value, int places) { return QString::number(value, 'f', places); };
  const PoseDifference motion = difference(report.motion, Pose());
  switch (index.column()) {
    case Iteration:
      return report.iteration;
    case Attempt:
      return static_cast<int>(step.attempt) + 1;
    case Rms:
      return number(1e3 * report.rms_m, 2);
    case Change:
      return report.iteration == 1 ? QString("–") : number(100.0 * report.change, 2);
    case Kept:
      return static_cast<int>(report.pairs);
    case Rejected:
      return static_cast<int>(step.pairs.size() - report.pairs);
    case Scale:
      return report.loss.scale_m > 0.0 || report.loss.isOwn() ? number(1e3 * report.loss.scale_m, 1)
                                                              : QString("–");
    case Shift:
      return number(1e3 * motion.translation_m, 2);
    case Turn:
      return number(motion.rotation_rad / kDegree, 4);
    case Overlap:
      return number(100.0 * report.overlap, 0);
    case Agreement:
      return number(100.0 * report.agreement, 0);
    default:
      return {};
  }
}

}  // namespace tiltmap::ui
