// The pixels of a PNG file, by libpng's simplified reader; needs linking with PNG::PNG.
#pragma once

#include <filesystem>
#include <png.h>
#include <stdexcept>

#include "core/products/rgb_image.h"

namespace tiltmap::test {

inline RgbImage pngPixels(const std::filesystem::path& file) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&header, file.c_str()))
    throw std::runtime_error(file.string() + ": " + header.message);
  header.format = PNG_FORMAT_RGB;
  RgbImage image(static_cast<int>(header.width), static_cast<int>(header.height), {});
  if (!png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr))
    throw std::runtime_error(file.string() + ": " + header.message);
  return image;
}

}  // namespace tiltmap::test
