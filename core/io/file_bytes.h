// A whole file in memory. Scan files are small beside that, and a mapped file that someone cuts short would
// kill us.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace tiltmap {

// Refuses what is missing, a directory, no regular file (a pipe would hang us), unreadable or empty.
Result<std::string> fileBytes(const std::filesystem::path& path, const JobControl& control = {});

}  // namespace tiltmap
