// Writing a file so that a reader, a full disk or a power cut never meets half of it.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>

#include "core/base/result.h"

namespace tiltmap {

// Writes beside the target, into a file of the same folder (a rename is atomic only within one file system),
// brings it to the disk and renames it over the target. On any failure the new file is removed and what was
// at `path` before stays as it was. An existing file's permissions are kept; a symbolic link stays one, and
// its target is replaced; a device or a pipe is simply written to. Error: the folder is missing or not
// writable, `path` is a folder, the disk is full, or what `write` returns.

// `write` gets a binary stream; a stream that has gone bad counts as a failed write.
Status writeFileAtomically(const std::filesystem::path& path,
                           const std::function<Status(std::ostream&)>& write);
Status writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);

// For writers that insist on a path of their own (libraries): `write` fills the file it is given.
Status replaceFileAtomically(const std::filesystem::path& path,
                             const std::function<Status(const std::filesystem::path&)>& write);

}  // namespace tiltmap
