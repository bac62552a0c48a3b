#include "ui/models/calibration_model.h"

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "ui/models/capture_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

QString capitalised(QString text) {
  if (!text.isEmpty()) text[0] = text[0].toUpper();
  return text;
}

// Millimetres, or feet for who measures in them.
QString lengthUnitOf(LengthUnit unit) {
  return unit == LengthUnit::Foot ? "ft" : "mm";
}
QString lengthCell(double metres, LengthUnit unit) {
  return unit == LengthUnit::Foot ? qt(fixedReal(inUnit(metres, unit), 4))
                                  : qt(fixedReal(1000.0 * metres, 1));
}

// "0-3,7" of ascending numbers.
QString rangesText(const std::vector<std::size_t>& numbers) {
  QStringList parts;
  for (std::size_t first = 0, last = 0; first < numbers.size(); first = ++last) {
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    parts << (first == last ? QString("%1").arg(numbers[first])
                            : QString("%1-%2").arg(numbers[first]).arg(numbers[last]));
  }
  return parts.join(",");
}

QString count(long long number, const QString& of) {
  return groupedNumber(number) + " " + of + (number == 1 ? "" : "s");
}

}  // namespace

CalibrationModel::CalibrationModel(Workspace& workspace, const std::string& operation, QObject* parent)
    : QObject(parent),
      workspace_(workspace),
      operation_(*operations().find(operation)),
      parameters_(new ParameterModel(operation_, this)) {
  parameters_->restore(workspace.preferences().lastParameters(qt(operation)));
  connect(&workspace.jobs(), &JobQueue::changed, this, &CalibrationModel::jobChanged);
  connect(&workspace.jobs(), &JobQueue::busyChanged, this, &CalibrationModel::changed);
  connect(&workspace.session(), &ProjectSession::closed, this, &CalibrationModel::forget);
  connect(&workspace.session(), &ProjectSession::opened, this, &CalibrationModel::forget);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &CalibrationModel::changed);
  connect(&workspace.selection(), &Selection::scansChanged, this, &CalibrationModel::changed);
  connect(parameters_, &ParameterModel::valueChanged, this, &CalibrationModel::changed);
  connect(parameters_, &ParameterModel::presetChanged, this, &CalibrationModel::changed);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, [this] {
    if (!report_.empty()) read(nlohmann::json::parse(report_));
    Q_EMIT changed();
  });
}

void CalibrationModel::useScans(const QString& text) {
  parameters_->setValueText("scans", text.trimmed());
}

bool CalibrationModel::canUseSelected() const {
  return !workspace_.selection().scans().empty();
}

void CalibrationModel::useSelected() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  if (!snapshot || !canUseSelected()) return;
  std::vector<std::size_t> indexes;
  for (std::size_t i = 0; i < snapshot->scans().size(); ++i)
    if (workspace_.selection().isSelected(snapshot->scans()[i].id)) indexes.push_back(i);
  useScans(rangesText(indexes));
}

ParameterValues CalibrationModel::values() const {
  ParameterValues values = parameters_->changes();
  values.erase("threads");
  values["apply"] = true;
  return values;
}

QString CalibrationModel::whyNotRun() const {
  const SnapshotPtr snapshot = workspace_.snapshot();
  if (!snapshot) return "Open or make a project first.";
  if (!workspace_.session().isWritable()) return "The project is open for reading only.";
  if (parameters_->hasErrors()) return "A parameter is not allowed: see below.";
  if (state() == FindingState::Running) return "It is being computed.";
  if (state() == FindingState::Proposal) return "Apply or discard what was found first.";
  ParameterValues all = parameters_->values();
  all["apply"] = true;
  const Status status = operation_.check(*snapshot, all);
  return status ? QString() : errorSentence(status.error());
}

void CalibrationModel::run() {
  if (!whyNotRun().isEmpty()) return;
  JobRequest request;
  request.operation = &operation_;
  request.values = values();
  request.ask = true;
  workspace_.preferences().setLastParameters(qt(operation_.id()), parameters_->last());
  (void)workspace_.start(request);
}

void CalibrationModel::cancel() {
  if (state() == FindingState::Running) workspace_.jobs().cancel(job_);
}
void CalibrationModel::apply() {
  if (state() == FindingState::Proposal) workspace_.jobs().accept(job_);
}
void CalibrationModel::discard() {
  if (state() == FindingState::Proposal) workspace_.jobs().discard(job_);
}

const JobStatus* CalibrationModel::job() const {
  return job_ > 0 ? workspace_.jobs().find(job_) : nullptr;
}

void CalibrationModel::jobChanged(int id) {
  const JobStatus* status = workspace_.jobs().find(id);
  if (!status || status->operation != qt(operation_.id()) || id < job_) return;
  if (id > job_) {
    forget();
    job_ = id;
  }
  if (!status->report_json.empty() && status->report_json != report_) {
    report_ = status->report_json;
    read(nlohmann::json::parse(report_));
  }
  if (status->phase == JobPhase::Accepted && !applied_ && !report_.empty()) {
    applied_ = nlohmann::json::parse(report_).value("applied", false);
    if (applied_) in_effect_ = geometries();
  }
  Q_EMIT changed();
}

void CalibrationModel::forget() {
  job_ = 0;
  report_.clear();
  rows_.clear();
  summary_.clear();
  applied_ = false;
  in_effect_.clear();
  Q_EMIT changed();
}

std::vector<std::pair<ScanId, std::int64_t>> CalibrationModel::geometries() const {
  std::vector<std::pair<ScanId, std::int64_t>> now;
  if (const SnapshotPtr snapshot = workspace_.snapshot())
    for (const ScanEntry& scan : snapshot->scans()) now.emplace_back(scan.id, scan.geometry_id);
  return now;
}

FindingState CalibrationModel::state() const {
  const JobStatus* status = job();
  if (!status) return FindingState::Nothing;
  switch (status->phase) {
    case JobPhase::Queued:
    case JobPhase::Running:
      return FindingState::Running;
    case JobPhase::Waiting:
      return FindingState::Proposal;
    case JobPhase::Failed:
      return FindingState::Failed;
    case JobPhase::Cancelled:
      return FindingState::Cancelled;
    case JobPhase::Discarded:
      return FindingState::Discarded;
    case JobPhase::Accepted:
      break;
  }
  if (!applied_) return FindingState::NothingToApply;
  // Scans that came later say nothing about those that were there.
  const SnapshotPtr snapshot = workspace_.snapshot();
  for (const auto& [scan, geometry] : in_effect_) {
    const ScanEntry* entry = snapshot ? snapshot->find(scan) : nullptr;
    if (entry && entry->geometry_id != geometry) return FindingState::TakenBack;
  }
  return FindingState::Applied;
}

QString CalibrationModel::sentence() const {
  const JobStatus* status = job();
  switch (state()) {
    case FindingState::Nothing:
      return "Nothing has been computed yet.";
    case FindingState::Running: {
      QString text = status->message.isEmpty() ? QString("Computing") : capitalised(status->message);
      if (status->left_s) text += ", " + durationText(*status->left_s) + " left";
      return text + ".";
    }
    case FindingState::Proposal:
      return "A proposal: nothing is stored before it is applied.";
    case FindingState::Applied:
      return "Applied to the scans. Undo takes it back.";
    case FindingState::TakenBack:
      return "It was applied; the scans have another geometry by now.";
    case FindingState::Discarded:
      return "Discarded: the project is as it was.";
    case FindingState::NothingToApply:
      return status->warnings.empty() ? QString("There is nothing to apply.")
                                      : capitalised(qt(status->warnings.back())) + ".";
    case FindingState::Failed:
      return status->error ? errorSentence(*status->error) : QString("It failed.");
    case FindingState::Cancelled:
      return "Cancelled: the project is as it was.";
  }
  return {};
}

QStringList CalibrationModel::warnings() const {
  QStringList list;
  if (const JobStatus* status = job(); status && state() != FindingState::NothingToApply)
    for (const std::string& warning : status->warnings) list << capitalised(qt(warning)) + ".";
  return list;
}

void CalibrationModel::read(const nlohmann::json& report) {
  rows_.clear();
  summary_.clear();
  if (report.contains("estimates"))
    readEstimates(report);
  else if (report.contains("cells"))
    readMask(report);
  else
    summary_ = count(report.value("scans", 0), "scan") + ", from the file.";
}

void CalibrationModel::readEstimates(const nlohmann::json& report) {
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  for (const auto& estimate : report["estimates"]) {
    const bool angle = estimate["unit"] == "rad";
    const auto cell = [&](const char* name) {
      const double value = estimate[name].get<double>();
      return angle ? qt(fixedReal(value / kDegree, 3)) : lengthCell(value, unit);
    };
    const std::string state = estimate["state"];
    FindingRow row;
    row.quantity = capitalised(qt(estimate["name"].get<std::string>()));
    row.before = cell("before");
    row.unit = angle ? "°" : lengthUnitOf(unit);
    row.told = state == "estimated";
    row.value = row.told ? cell("value") : QString("–");
    const bool known = row.told || (state == "weak" && estimate["deviation"].get<double>() > 0.0);
    row.deviation = known ? cell("deviation") : QString("–");
    if (!row.told) {
      const QString reason = qt(estimate["reason"].get<std::string>());
      row.reason = state == "held" ? capitalised(reason) : "Cannot be told from these scans: " + reason;
    }
    rows_.push_back(std::move(row));
  }
  summary_ = QString("%1, %2, ground at %3. Median residual %4 before, %5 after.")
                 .arg(count(report["scans"].get<int>(), "scan"), count(report["links"].get<int>(), "pair"),
                      count(report["ground_stops"].get<int>(), "stop"),
                      smallLengthText(report["residual_before_m"].get<double>(), unit),
                      smallLengthText(report["residual_after_m"].get<double>(), unit));
}

void CalibrationModel::readMask(const nlohmann::json& report) {
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const auto cells = report["cells"].get<long long>();
  const double minimum = report["minimum_range_m"].get<double>();
  rows_.push_back({"Cells that show the machine", "", groupedNumber(cells), "", "", "", true});
  rows_.push_back({"Masked, with the margin", "", groupedNumber(report["masked_cells"].get<long long>()), "",
                   "", "", true});
  rows_.push_back({"Furthest of them", "",
                   cells > 0 ? lengthNumber(report["furthest_m"].get<double>(), unit) : "–", "",
                   cells > 0 ? unitName(unit) : "", "", cells > 0});
  FindingRow range{"Minimum range that keeps it out", "", "–", "", "", "", minimum > 0.0};
  if (minimum > 0.0) {
    range.value = lengthNumber(minimum, unit);
    range.unit = unitName(unit);
  } else {
    range.reason = cells > 0 ? "None does: surroundings come as near as the machine itself"
                             : "No cell shows the machine";
  }
  rows_.push_back(std::move(range));
  summary_ = "Learnt from " + count(report["scans"].get<long long>(), "scan") + ".";
}

}  // namespace tiltmap::ui
