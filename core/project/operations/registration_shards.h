// Splitting the pairs of a survey over several machines, and putting the parts together.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/project/operations/registration_part.h"

namespace tiltmap {

// Registers the pairs of one part; the project stays as it is. `preset` and `values` as for the operation
// `register`. Error: what the operation refuses, cancelled.
Result<RegistrationPart> registerShard(const SnapshotPtr& snapshot, const std::string& preset,
                                       const ParameterValues& values, const Shard& shard,
                                       const JobControl& control);

// Everything that `tiltmap register` would have stored in one process, bit for bit but for the times, with
// its record; the report likewise. In any order of the files. Error, naming the file: a part that is of
// another project, of other scans than the project's now, made with other parameters or by another version,
// that is there twice or missing, or that cannot be read.
Result<OperationResult> mergeRegistrationParts(const SnapshotPtr& snapshot,
                                               const std::vector<std::filesystem::path>& files);

}  // namespace tiltmap
