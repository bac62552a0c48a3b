#include "core/products/drawing.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/text.h"
#include "core/products/stroke_font.h"

namespace tiltmap {
namespace {

using Eigen::Vector2d;

constexpr Rgb kBlack{0, 0, 0};
constexpr Rgb kWhite{255, 255, 255};

double inkOf(const RgbImage& image) {
  double sum = 0.0;
  for (const Rgb& pixel : image.pixels) sum += pixel.r / 255.0;
  return sum;
}

TEST(Drawing, ADiscHasItsArea) {
  RgbImage image(60, 60, kBlack);
  drawDisc(image, {30.3, 29.6}, 12.0, {kWhite, 1.0});
  EXPECT_NEAR(inkOf(image), 3.14159 * 144, 3.0);
  EXPECT_EQ(image.at(30, 29), kWhite);
  EXPECT_EQ(image.at(30, 45), kBlack);
}

TEST(Drawing, ALineHasItsWidthAndPlace) {
  RgbImage image(50, 20, kBlack);
  drawPolyline(image, {{10, 10}, {40, 10}}, 4.0, {kWhite, 1.0});
  for (int y = 8; y < 12; ++y) EXPECT_EQ(image.at(25, y), kWhite);
  EXPECT_EQ(image.at(25, 6), kBlack);
  EXPECT_EQ(image.at(25, 13), kBlack);
  EXPECT_EQ(image.at(5, 10), kBlack);
}

TEST(Drawing, ALineOverItselfDoesNotGetDarker) {
  RgbImage once(40, 40, kBlack);
  RgbImage twice = once;
  drawPolyline(once, {{5, 20}, {35, 20}}, 3.0, {kWhite, 0.5});
  drawPolyline(twice, {{5, 20}, {35, 20}, {5, 20}}, 3.0, {kWhite, 0.5});
  EXPECT_TRUE(once.pixels == twice.pixels);
  EXPECT_NEAR(once.at(20, 20).r, 128, 1);
}

TEST(Drawing, ATriangleIsFilledWhicheverWayItTurns) {
  RgbImage one(40, 40, kBlack);
  RgbImage other = one;
  drawTriangle(one, {5, 5}, {35, 5}, {5, 35}, {kWhite, 1.0});
  drawTriangle(other, {5, 5}, {5, 35}, {35, 5}, {kWhite, 1.0});
  EXPECT_TRUE(one.pixels == other.pixels);
  EXPECT_NEAR(inkOf(one), 450.0, 8.0);
}

TEST(Drawing, IsClippedAtTheBorders) {
  RgbImage image(30, 20, kBlack);
  drawPolyline(image, {{-1e9, 10}, {1e9, 10}}, 2.0, {kWhite, 1.0});
  drawDisc(image, {-100, -100}, 5.0, {kWhite, 1.0});
  drawTriangle(image, {100, 100}, {130, 100}, {100, 130}, {kWhite, 1.0});
  fillRectangle(image, -5, 18, 100, 100, {kWhite, 1.0});
  drawText(image, "far away", {5000, -5000}, TextAnchor::Left, {});
  EXPECT_EQ(image.at(0, 10), kWhite);
  EXPECT_EQ(image.at(29, 19), kWhite);
  EXPECT_EQ(image.at(15, 5), kBlack);
  EXPECT_THROW(drawDisc(image, {std::numeric_limits<double>::quiet_NaN(), 0}, 5.0, {kWhite, 1.0}),
               std::invalid_argument);
}

TEST(Drawing, TextStandsOnItsLineAtItsAnchor) {
  for (const TextAnchor anchor : {TextAnchor::Left, TextAnchor::Middle, TextAnchor::Right}) {
    RgbImage image(200, 60, kBlack);
    drawText(image, "HH", {100, 40}, anchor, {20.0, kWhite, 0.1, 0.0, {}});
    const double width = textWidth("HH", 20.0);
    const double left = anchor == TextAnchor::Left     ? 100
                        : anchor == TextAnchor::Middle ? 100 - width / 2
                                                       : 100 - width;
    int first = 200, last = 0, top = 60, bottom = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 200; ++x)
        if (image.at(x, y).r > 127) {
          first = std::min(first, x);
          last = std::max(last, x);
          top = std::min(top, y);
          bottom = std::max(bottom, y);
        }
    EXPECT_NEAR(first, left, 2.0);
    EXPECT_NEAR(last, left + width, 2.0);
    EXPECT_NEAR(top, 20, 2.0);
    EXPECT_NEAR(bottom, 40, 2.0);
  }
}

TEST(StrokeFont, DrawsEveryPrintableLetterDifferently) {
  std::set<std::string> seen;
  for (char c = '!'; c <= '~'; ++c) {
    const Glyph& glyph = glyphOf(static_cast<char32_t>(c));
    EXPECT_NE(&glyph, &glyphOf(U'\ufffd')) << c;
    std::string drawing;
    for (const auto& stroke : glyph.strokes)
      for (const Vector2d& p : stroke) {
        drawing += shortestReal(p.x()) + "," + shortestReal(p.y()) + " ";
        EXPECT_GE(p.x(), -1.5) << c;
        EXPECT_LE(p.x(), glyph.advance) << c;
        EXPECT_GE(p.y(), -4.0) << c;
        EXPECT_LE(p.y(), 11.5) << c;
      }
    EXPECT_FALSE(drawing.empty()) << c;
    EXPECT_TRUE(seen.insert(drawing).second) << c << " looks like another letter";
  }
}

TEST(StrokeFont, DigitsAreEquallyWideAndAccentsAddStrokes) {
  for (char32_t digit = U'0'; digit <= U'9'; ++digit)
    EXPECT_EQ(glyphOf(digit).advance, glyphOf(U'0').advance);
  for (const auto& [accented, base] :
       {std::pair{U'ç', U'c'}, {U'Ü', U'U'}, {U'ğ', U'g'}, {U'İ', U'I'}, {U'š', U's'}}) {
    EXPECT_NE(&glyphOf(accented), &glyphOf(U'\ufffd'));
    EXPECT_GT(glyphOf(accented).strokes.size(), glyphOf(base).strokes.size());
    EXPECT_EQ(glyphOf(accented).advance, glyphOf(base).advance);
  }
  EXPECT_EQ(&glyphOf(U'語'), &glyphOf(U'\ufffd'));
}

TEST(Utf8, IsReadAndWrittenAndBrokenBytesAreMarked) {
  const std::string text = "aé²–語😀";
  std::string back;
  for (const char32_t c : codePointsOf(text)) back += utf8Of(c);
  EXPECT_EQ(back, text);
  EXPECT_EQ(codePointsOf(text).size(), 6U);
  EXPECT_EQ(codePointsOf("a\xff"
                         "b"),
            (std::vector<char32_t>{U'a', U'\ufffd', U'b'}));
  EXPECT_EQ(codePointsOf("\xe2\x82"), (std::vector<char32_t>{U'\ufffd', U'\ufffd'}));  // cut short
  EXPECT_EQ(codePointsOf("\xc0\xaf"), (std::vector<char32_t>{U'\ufffd', U'\ufffd'}));  // overlong
  EXPECT_EQ(codePointsOf("\xed\xa0\x80").front(), U'\ufffd');      // half of a surrogate pair
  EXPECT_EQ(codePointsOf("\xf5\x80\x80\x80").front(), U'\ufffd');  // beyond Unicode
}

TEST(NumberText, IsFixedAndGroupedWithoutALocale) {
  EXPECT_EQ(fixedReal(-0.0004, 3), "0.000");
  EXPECT_EQ(fixedReal(-0.0006, 3), "-0.001");
  EXPECT_EQ(fixedReal(1234.5, 0), "1234");
  EXPECT_EQ(fixedReal(-2.5, 2), "-2.50");
  EXPECT_EQ(groupedInteger(0), "0");
  EXPECT_EQ(groupedInteger(-999), "-999");
  EXPECT_EQ(groupedInteger(-1000), "-1,000");
  EXPECT_EQ(groupedInteger(1234567), "1,234,567");
}

}  // namespace
}  // namespace tiltmap
