#include "ui/models/project_words.h"

#include <algorithm>

#include "core/base/text.h"
#include "ui/models/edits.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

QString row(const QString& name, const QString& value) {
  return QString("<tr><td style='padding-right:12px'>%1</td><td>%2</td></tr>")
      .arg(name, value.toHtmlEscaped());
}

QString percent(double share) {
  return qt(fixedReal(100.0 * share, 0)) + " %";
}

}  // namespace

QString scanSummary(const ScanEntry& scan) {
  if (scan.lines < scan.rows) return QString("%1 of %2 lines").arg(scan.lines).arg(scan.rows);
  return groupedNumber(static_cast<long long>(scan.valid_cells)) + " points";
}

QString scanTip(const ScanEntry& scan, std::size_t index) {
  QString tip = QString("<b>Scan %1: %2</b><table>").arg(index).arg(qt(scan.name).toHtmlEscaped());
  tip += row("Matrix", QString("%1 × %2 beams").arg(scan.rows).arg(scan.columns));
  tip += row("Points", groupedNumber(static_cast<long long>(scan.valid_cells)));
  tip += row("Source", qt(scan.source));
  if (!scan.note.empty()) tip += row("Note", qt(scan.note));
  return tip + "</table>";
}

QString linkSummary(const Link& link, LengthUnit unit) {
  if (!link.succeeded) return "failed: " + qt(link.stop_reason);
  const QString text = smallLengthText(link.rms_m, unit) + ", " + percent(link.overlap) + " overlap";
  return link.state == LinkState::Disabled ? "disabled, " + text : text;
}

QString linkTip(const ProjectSnapshot& snapshot, const Link& link, LengthUnit unit) {
  QString tip = "<b>Link " + qt(linkName(snapshot, link)) + "</b><table>";
  const auto scanName = [&](ScanId id) {
    const ScanEntry* scan = snapshot.find(id);
    return scan ? QString("%1  %2").arg(*snapshot.indexOf(id)).arg(qt(scan->name)) : QString("not there");
  };
  tip += row("Fixed scan", scanName(link.fixed));
  tip += row("Moving scan", scanName(link.moving));
  tip += row("Result", link.succeeded ? QString("found") : QString("not found"));
  tip += row("Ended because", qt(link.stop_reason));
  tip += row("Residual (rms)", smallLengthText(link.rms_m, unit));
  tip += row("Matched", percent(link.overlap));
  tip += row("Correspondences", groupedNumber(link.correspondences));
  tip += row("Iterations", QString::number(link.iterations));
  tip += row("Origin", qt(linkOriginName(link.origin)));
  tip += row("State", qt(linkStateName(link.state)));
  return tip + "</table>";
}

QString stageTitle(Stage stage) {
  QString title = qt(stageName(stage));
  title[0] = title[0].toUpper();
  return title;
}

QString stageTip(Stage stage) {
  switch (stage) {
    case Stage::Truth:
      return "Where the stops truly are, known from simulation or control.";
    case Stage::Odometry:
      return "Where the wheels and sensors of the vehicle put the stops.";
    case Stage::Pairwise:
      return "Where registration of pairs, one after the other, puts the stops.";
    case Stage::Relaxed:
      return "Where the stops are after the errors have been spread over all links.";
  }
  return {};
}

QString stageSummary(const ProjectSnapshot& snapshot, Stage stage) {
  const auto poses = snapshot.poses(stage);
  const auto there = std::ranges::count_if(poses, [](const auto& pose) { return pose.has_value(); });
  if (static_cast<std::size_t>(there) == poses.size()) return QString("%1 poses").arg(there);
  return QString("%1 of %2 poses").arg(there).arg(poses.size());
}

QString projectSummary(const ProjectSnapshot& snapshot) {
  std::size_t points = 0;
  for (const ScanEntry& scan : snapshot.scans()) points += scan.valid_cells;
  const auto scans = snapshot.scans().size();
  return QString("%1 %2, %3 points")
      .arg(scans)
      .arg(scans == 1 ? "scan" : "scans", groupedNumber(static_cast<long long>(points)));
}

}  // namespace tiltmap::ui
