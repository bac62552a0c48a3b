// Edits that the window makes from what its user did by hand; the others come from operations.
#pragma once

#include <vector>

#include "core/project/project_edit.h"

namespace tiltmap::ui {

// Moves the named scans together to stand before the scan that is at `place` now (the number of scans: to the
// end). Empty where that changes nothing.
ProjectEdit reorderEdit(const ProjectSnapshot& snapshot, const std::vector<ScanId>& moved, std::size_t place);
ProjectEdit deleteLinksEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links);
ProjectEdit linkStatesEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links,
                           LinkState state);
// A person vouches for them: registering again leaves them alone. Links without a result, and those that are
// a person's own already, are left out.
ProjectEdit acceptLinksEdit(const ProjectSnapshot& snapshot, const std::vector<LinkId>& links);
// Takes the stage's poses away. Not odometry: every scan has one.
ProjectEdit clearStageEdit(Stage stage);

// "4 – 5", by index; how the window names a link.
std::string linkName(const ProjectSnapshot& snapshot, const Link& link);

}  // namespace tiltmap::ui
