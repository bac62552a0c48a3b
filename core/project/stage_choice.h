// The stage that a person means by a word, or by none.
#pragma once

#include <string>

#include "core/project/project_snapshot.h"

namespace tiltmap {

// The named stage, or the latest there is where the name is empty. An error where there is no stage of that
// name, or the project has no poses of it.
Result<Stage> stageOrLatest(const ProjectSnapshot& snapshot, const std::string& name);

}  // namespace tiltmap
