#include "core/products/png.h"

#include <csetjmp>
#include <png.h>
#include <stdexcept>

#include "core/base/atomic_file.h"

namespace tiltmap {

namespace {

struct Sink {
  std::string bytes;
  std::string message;
};

Sink& sinkOf(png_structp png) {
  return *static_cast<Sink*>(png_get_io_ptr(png));
}

void append(png_structp png, png_bytep data, std::size_t count) {
  sinkOf(png).bytes.append(reinterpret_cast<const char*>(data), count);
}

void onError(png_structp png, png_const_charp message) {
  static_cast<Sink*>(png_get_error_ptr(png))->message = message;
  std::longjmp(png_jmpbuf(png), 1);
}

// libpng leaves by longjmp: nothing here has a destructor.
bool encodeInto(Sink& sink, const RgbImage& image) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, onError, nullptr);
  if (!png) return false;
  png_infop info = png_create_info_struct(png);
  if (!info || setjmp(png_jmpbuf(png)) != 0) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &sink, append, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, reinterpret_cast<png_const_bytep>(image.pixels.data() + image.index(0, y)));
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

static_assert(sizeof(Rgb) == 3, "rows of Rgb are handed to libpng as they are");

}  // namespace

Result<std::string> encodePng(const RgbImage& image) {
  if (image.width <= 0 || image.height <= 0)
    return fail("the picture is empty", "PNG", "give it a width and a height of one pixel or more");
  if (image.pixels.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw std::invalid_argument("encodePng: the number of pixels is not width times height");
  Sink sink;
  if (!encodeInto(sink, image))
    return fail("the picture could not be encoded: " + sink.message, "PNG", "choose a smaller picture");
  return std::move(sink.bytes);
}

Status writePng(const std::filesystem::path& path, const RgbImage& image) {
  const Result<std::string> bytes = encodePng(image);
  if (!bytes) return fail({bytes.error().what, path.string(), bytes.error().remedy});
  return writeFileAtomically(path, *bytes);
}

}  // namespace tiltmap
