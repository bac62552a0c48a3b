// What a capture is at, in words and figures.
#include "ui/models/capture_model.h"
#include "ui/models/job_queue.h"
#include "ui/models/strings.h"
#include "ui/models/units.h"

namespace tiltmap::ui {

namespace {

QString capitalised(QString text) {
  if (!text.isEmpty()) text[0] = text[0].toUpper();
  return text;
}

QString degrees(double angle_rad, int digits, bool sign) {
  const double angle = angle_rad / kDegree;
  QString text = QString::number(angle, 'f', digits);
  if (sign && angle >= 0.0) text.prepend('+');
  return text + "°";
}

}  // namespace

QString errorSentence(const Error& error) {
  QString text = qt(error.what);
  if (!error.where.empty()) text += " (" + qt(error.where) + ")";
  if (!text.isEmpty()) text[0] = text[0].toUpper();
  if (!error.remedy.empty()) text += ". What to do: " + qt(error.remedy);
  return text + ".";
}

QString stationStateTitle(StationState state) {
  switch (state) {
    case StationState::Idle:
      return "Not connected";
    case StationState::Connecting:
      return "Connecting";
    case StationState::Ready:
      return "Ready";
    case StationState::Moving:
      return "The tilt moves";
    case StationState::Scanning:
      return "Scanning";
    case StationState::Reconnecting:
      return "Instrument lost";
    case StationState::Fault:
      return "Fault";
    case StationState::Verdict:
      return "Stop captured";
  }
  return {};
}

QString CaptureModel::title() const {
  if (verdict_->judgement() && state() == StationState::Verdict)
    return captureLightName(verdict_->judgement()->light);
  if (isSweeping() && !isBusy()) return "Waiting";
  return stationStateTitle(state());
}

QString CaptureModel::trouble() const {
  for (const StationInstrument* instrument : {&now_.scanner, &now_.tilt})
    for (const InstrumentFact& fact : instrument->facts)
      // Figures in brackets are for who looks closer.
      if (fact.trouble) return qt(fact.name) + ": " + qt(fact.value).section(" (", 0, 0);
  return {};
}

QString CaptureModel::sentence() const {
  if (refused_) return errorSentence(*refused_);
  if (now_.error) {
    QString text = errorSentence(*now_.error);
    if (state() == StationState::Reconnecting && !now_.doing.empty())
      text += " " + capitalised(qt(now_.doing)) + ".";
    return text;
  }
  switch (state()) {
    case StationState::Idle:
      return "Choose where the instruments are, and connect.";
    case StationState::Ready:
      if (isSweeping()) return "The sweep begins when the work before it is done.";
      if (!now_.doing.empty()) return capitalised(qt(now_.doing)) + ".";
      if (const QString wrong = trouble(); !wrong.isEmpty()) return capitalised(wrong) + ".";
      return now_.tilt_rad ? "Both instruments are there. The tilt stands at " + tiltText() + "."
                           : QString("Both instruments are there.");
    case StationState::Moving:
      return capitalised(qt(now_.doing)) +
             (now_.target_rad ? ", to " + degrees(*now_.target_rad, 2, true) : QString()) + ".";
    case StationState::Verdict:
      if (verdict_->judgement()) return verdict_->judgement()->reason;
      return verdict_->isJudging() ? QString("All lines are stored. Comparing the scan with the map.")
                                   : QString("All lines are stored.");
    default:
      break;
  }
  QString text = capitalised(qt(now_.doing));
  if (!text.isEmpty()) text += ".";
  if (state() == StationState::Scanning && verdict_->estimate())
    text += " " + capitalised(verdict_->estimate()->sentence) + ".";
  return text;
}

QString CaptureModel::linesText() const {
  if (now_.sweep.number == 0) return {};
  return QString("%1 of %2").arg(now_.sweep.rows_taken).arg(now_.sweep.geometry.rows);
}
QString CaptureModel::leftText() const {
  if (now_.sweep.complete) return "done in " + durationText(now_.sweep.elapsed_s);
  return isSweeping() && now_.sweep.left_s ? durationText(*now_.sweep.left_s) : QString();
}
QString CaptureModel::deadText() const {
  if (now_.sweep.cells == 0) return {};
  return QString::number(
             100.0 * static_cast<double>(now_.sweep.dead_cells) / static_cast<double>(now_.sweep.cells), 'f',
             1) +
         " %";
}
QString CaptureModel::retriesText() const {
  if (now_.sweep.number == 0) return {};
  QString text = QString::number(now_.sweep.retries);
  if (now_.sweep.recoveries > 0) text += QString(", lost %1 ×").arg(now_.sweep.recoveries);
  return text;
}
QString CaptureModel::tiltErrorText() const {
  if (!now_.sweep.tilt_error_rad) return {};
  return degrees(*now_.sweep.tilt_error_rad, 3, true) + ", worst " +
         degrees(now_.sweep.worst_tilt_error_rad, 3, false);
}
QString CaptureModel::diskText() const {
  if (disk_free_bytes_ < 0.0) return {};
  const ParameterValues all = parameters_->values();
  const int lines = static_cast<int>(std::get<long long>(all.at("lines")));
  const int columns = now_.sweep.number > 0 ? now_.sweep.geometry.columns : 361;
  const auto sweeps = static_cast<long long>(disk_free_bytes_ / storedBytes(lines, columns));
  // Short enough for large letters: more than a survey's worth need not be counted.
  constexpr long long kPlenty = 999;
  constexpr double kGigabyte = 1e9;
  const QString room = disk_free_bytes_ >= 10.0 * kGigabyte
                           ? groupedNumber(static_cast<long long>(disk_free_bytes_ / kGigabyte)) + " GB"
                           : sizeText(static_cast<unsigned long long>(disk_free_bytes_));
  return room + ", " + (sweeps > kPlenty ? ">" : "") + groupedNumber(std::min(sweeps, kPlenty)) +
         (sweeps == 1 ? " sweep" : " sweeps");
}
QString CaptureModel::tiltText() const {
  return now_.tilt_rad ? degrees(*now_.tilt_rad, 2, true) : QString();
}

}  // namespace tiltmap::ui
