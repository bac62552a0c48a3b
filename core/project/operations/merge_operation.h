// Projects as a whole: taking in another one, reading every page of this one.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/project/operation.h"

namespace tiltmap {

// Appends everything of the project at `other`, which stays as it is. `world_from_other_world` places it;
// without it the place is taken from the frame that both were imported in, else the other's stop 0 comes
// where this one's is, with a warning. Error: the other cannot be read, or is this very project.
Result<OperationResult> mergeProjects(const SnapshotPtr& into, const std::filesystem::path& other,
                                      const std::optional<Pose>& world_from_other_world);
std::unique_ptr<Operation> makeMergeOperation();

// Project::verify() as a job. Not in operations(): it is about the file, and takes no parameters.
const Operation& verifyOperation();

}  // namespace tiltmap
