// A project's summary page and picture, ready to be written.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/products/report.h"
#include "core/products/top_view.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

// The map at a stage, seen from above. At most about three million points are taken, evenly from every scan.
// Error: no scans, a matrix that cannot be read, cancelled.
Result<TopViewInput> topViewOf(const ProjectSnapshot& snapshot, Stage stage, const std::string& title,
                               const JobControl& control = {});

// Everything the project knows about how its map came about: stages (with their errors where the truth is
// known), links, warnings and parameters of the jobs that made what is there, by the last of each operation.
// Picture and files are left for the caller to add.
ReportData reportOf(const ProjectSnapshot& snapshot, const std::string& survey_name);

}  // namespace tiltmap
