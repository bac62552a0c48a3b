// What a project's scans tell about their scanner: computed as a proposal, looked at, applied or discarded.
#pragma once

#include <QObject>
#include <QString>
#include <QStringList>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/models/job_queue.h"
#include "ui/models/parameter_model.h"

namespace tiltmap::ui {

class Workspace;

enum class FindingState {
  Nothing,  // not computed in this session
  Running,
  Proposal,   // waits for apply() or discard()
  Applied,    // and in effect
  TakenBack,  // was applied; undone since, or the scans got another geometry
  Discarded,
  NothingToApply,  // computed, and there is nothing that could be applied
  Failed,
  Cancelled
};

// One line of the table.
struct FindingRow {
  QString quantity, before, value, deviation, unit;
  QString reason;  // where it could not be told, and why
  bool told = false;
};

// Of the operation "calibrate" or "body-mask", whoever started it: the last one counts. With its parameter
// `apply` the operation gives the same edit to the command line, which stores it at once; here it waits for a
// decision.
class CalibrationModel : public QObject {
  Q_OBJECT

 public:
  CalibrationModel(Workspace& workspace, const std::string& operation, QObject* parent = nullptr);

  ParameterModel& parameters() { return *parameters_; }
  const Operation& operation() const { return operation_; }
  // No rows of the form: decided here by apply() and discard(), chosen by useScans(), or one of the program's
  // preferences.
  static QStringList notAsked() { return {"apply", "scans", "threads"}; }

  // Which scans to take it from: "0-3,7", empty for all.
  QString scansText() const { return parameters_->valueText("scans"); }
  void useScans(const QString& text);
  // Those that are selected in the window.
  bool canUseSelected() const;
  void useSelected();

  QString whyNotRun() const;  // empty where it can
  void run();
  void cancel();
  void apply();
  void discard();

  FindingState state() const;
  const JobStatus* job() const;  // the one that the state is of; null before any
  QString sentence() const;      // what it is at, and what may be done
  const std::vector<FindingRow>& rows() const { return rows_; }
  QString summary() const { return summary_; }  // what it rests on; empty before
  QStringList warnings() const;

 Q_SIGNALS:
  void changed();

 private:
  ParameterValues values() const;
  void jobChanged(int id);
  void read(const nlohmann::json& report);
  void readEstimates(const nlohmann::json& report);
  void readMask(const nlohmann::json& report);
  std::vector<std::pair<ScanId, std::int64_t>> geometries() const;
  void forget();

  Workspace& workspace_;
  const Operation& operation_;
  ParameterModel* parameters_;
  int job_ = 0;
  std::string report_;  // that rows and summary are of
  std::vector<FindingRow> rows_;
  QString summary_;
  bool applied_ = false;
  std::vector<std::pair<ScanId, std::int64_t>> in_effect_;  // geometries once it was applied
};

}  // namespace tiltmap::ui
