#include "core/products/png.h"

#include <fstream>
#include <iterator>
#include <png.h>
#include <stdlib.h>

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

// libpng's simplified reader: another way through the library than the one under test.
RgbImage decoded(const std::string& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  RgbImage image;
  if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) return image;
  header.format = PNG_FORMAT_RGB;
  image = RgbImage(static_cast<int>(header.width), static_cast<int>(header.height), {});
  if (!png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr)) return {};
  return image;
}

RgbImage noise(int width, int height) {
  RgbImage image(width, height, {});
  RandomStream random(4);
  for (Rgb& pixel : image.pixels) {
    const std::uint64_t bits = random.next();
    pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
             static_cast<std::uint8_t>(bits >> 16U)};
  }
  return image;
}

TEST(Png, DecodesToTheSamePixels) {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 3}, {301, 200}}) {
    const RgbImage image = noise(width, height);
    const auto bytes = encodePng(image);
    ASSERT_TRUE(bytes);
    const RgbImage back = decoded(*bytes);
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_TRUE(back.pixels == image.pixels);
  }
}

TEST(Png, TheSamePictureGivesTheSameBytes) {
  EXPECT_EQ(*encodePng(noise(40, 30)), *encodePng(noise(40, 30)));
}

TEST(Png, WritesTheFileOrSaysWhyNot) {
  std::string pattern = (std::filesystem::temp_directory_path() / "tiltmap-test-XXXXXX").string();
  ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
  const std::filesystem::path folder = pattern;
  const RgbImage image = noise(20, 10);
  ASSERT_TRUE(writePng(folder / "a.png", image));
  std::ifstream file(folder / "a.png", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(decoded(bytes).pixels == image.pixels);

  const Status missing = writePng(folder / "none" / "a.png", image);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().where, (folder / "none" / "a.png").string());
  const Status empty = writePng(folder / "empty.png", RgbImage());
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().where, (folder / "empty.png").string());
  EXPECT_FALSE(std::filesystem::exists(folder / "empty.png"));
  std::filesystem::remove_all(folder);
}

TEST(Png, APictureWithMissingPixelsIsABrokenContract) {
  RgbImage image(10, 10, {});
  image.pixels.pop_back();
  EXPECT_THROW((void)encodePng(image), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
