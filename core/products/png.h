// Pictures as PNG, through libpng.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.h"
#include "core/products/rgb_image.h"

namespace tiltmap {

// 8-bit RGB marked as sRGB. The same picture gives the same bytes.
// Error: an empty picture, or libpng's own message.
Result<std::string> encodePng(const RgbImage& image);

// Whole or not at all (core/base/atomic_file.h).
Status writePng(const std::filesystem::path& path, const RgbImage& image);

}  // namespace tiltmap
