// What a project holds, in the words of lists and tooltips.
#pragma once

#include <QString>

#include "core/project/project_snapshot.h"
#include "ui/models/units.h"

namespace tiltmap::ui {

QString scanSummary(const ScanEntry& scan);                 // "28,310 points", "7 of 101 lines"
QString scanTip(const ScanEntry& scan, std::size_t index);  // rich text
QString linkSummary(const Link& link, LengthUnit unit);     // "5.2 mm, 61 % overlap"
QString linkTip(const ProjectSnapshot& snapshot, const Link& link, LengthUnit unit);
QString stageTitle(Stage stage);                                     // "Pairwise"
QString stageTip(Stage stage);                                       // one sentence
QString stageSummary(const ProjectSnapshot& snapshot, Stage stage);  // "14 poses", "12 of 14 poses"
QString projectSummary(const ProjectSnapshot& snapshot);             // "14 scans, 350,000 points"

}  // namespace tiltmap::ui
