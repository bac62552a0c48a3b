// Pictures taken at a stop: from a file into the project and out again.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/project/project_edit.h"

namespace tiltmap {

// By the first bytes: "image/jpeg", "image/png", "image/webp", "image/gif", "image/tiff", "image/bmp" or
// "image/heif"; empty for anything else.
std::string pictureMediaType(std::string_view bytes);
// ".jpg" for "image/jpeg" and so on; empty for a type that is not in the list above.
std::string pictureExtension(std::string_view media_type);

// A larger picture is refused: it would be a film or a mistake, and SQLite holds no more than 1 GB in one
// place.
inline constexpr std::size_t kLargestPicture = 200'000'000;

// Reads the picture, to be kept in the project (`keep`) or to be referred to by its absolute path. Error: the
// file cannot be read, is no picture, or is too large.
Result<NewPhotograph> photographFromFile(const std::filesystem::path& path, std::string caption, bool keep);

ProjectEdit addPhotographEdit(const ScanEntry& scan, NewPhotograph photograph);
// Error: no stop has such a photograph.
Result<ProjectEdit> removePhotographEdit(const ProjectSnapshot& snapshot, std::int64_t photograph);

// The picture itself, from the project or from the file it refers to. Error: no stop has such a photograph,
// or the file is gone.
Result<std::string> photographContents(const ProjectSnapshot& snapshot, std::int64_t photograph);

}  // namespace tiltmap
