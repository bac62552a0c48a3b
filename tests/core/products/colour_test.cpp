#include "core/products/colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/products/scan_colours.h"

namespace tiltmap {
namespace {

// Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB: normal, protanopia, deuteranopia,
// tritanopia.
std::array<Eigen::Matrix3d, 4> eyes() {
  return {
      Eigen::Matrix3d::Identity(),
      Eigen::Matrix3d{
          {0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}},
      Eigen::Matrix3d{
          {0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}},
      Eigen::Matrix3d{
          {1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};
}

TEST(ScanColours, TheFixedOnesAreToldApartByEveryEye) {
  const std::array<double, 4> least = {0.14, 0.10, 0.10, 0.09};
  for (std::size_t eye = 0; eye < 4; ++eye)
    for (std::size_t i = 0; i < kFixedScanColours; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const auto seen = [&](std::size_t k) {
          return okLabOf((eyes()[eye] * linearOf(scanColour(k))).cwiseMax(0.0).cwiseMin(1.0));
        };
        EXPECT_GT((seen(i) - seen(j)).norm(), least[eye]) << "eye " << eye << ", scans " << j << " and " << i;
      }
}

TEST(Colour, HexadecimalIsReadAsItIsWritten) {
  for (const Rgb colour : {Rgb{255, 136, 0}, Rgb{0, 0, 0}, Rgb{1, 2, 254}})
    EXPECT_EQ(rgbOfHex(hexOf(colour)), colour);
  EXPECT_EQ(rgbOfHex("FF8800"), (Rgb{255, 136, 0}));
  for (const char* text : {"", "#", "#ff880", "#ff88000", "#gg0000", "orange", "#+10203", "# 10203"})
    EXPECT_EQ(rgbOfHex(text), std::nullopt) << text;
}

TEST(ScanColours, ShowOnBlackAndOnWhite) {
  for (std::size_t k = 0; k < 60; ++k) {
    const double lightness = okLabOf(linearOf(scanColour(k))).x();
    EXPECT_GT(lightness, 0.48) << k;
    EXPECT_LT(lightness, 0.87) << k;
  }
}

TEST(ScanColours, LaterOnesDifferFromThoseAround) {
  for (std::size_t k = kFixedScanColours; k < 200; ++k)
    for (std::size_t back = 1; back <= 4 && k - back >= kFixedScanColours; ++back)
      EXPECT_GT((okLabOf(linearOf(scanColour(k))) - okLabOf(linearOf(scanColour(k - back)))).norm(), 0.08)
          << k;
}

TEST(Colour, OkLabOfKnownColours) {
  // Values of the paper's definition: white is (1, 0, 0), sRGB red (0.628, 0.225, 0.126).
  EXPECT_TRUE(okLabOf(linearOf({255, 255, 255})).isApprox(Eigen::Vector3d(1, 0, 0), 1e-4));
  EXPECT_LT((okLabOf(linearOf({255, 0, 0})) - Eigen::Vector3d(0.62796, 0.22486, 0.12585)).norm(), 1e-4);
  EXPECT_LT(okLabOf(linearOf({0, 0, 0})).norm(), 1e-12);
}

TEST(Colour, LinearAndBackKeepsEveryValue) {
  for (int v = 0; v < 256; ++v) {
    const auto byte = static_cast<std::uint8_t>(v);
    EXPECT_EQ(rgbOfLinear(linearOf({byte, 7, 200})), (Rgb{byte, 7, 200}));
  }
}

TEST(EvenColour, RisesInLightnessInEvenSteps) {
  double last = 0.0;
  for (int k = 0; k <= 20; ++k) {
    const double lightness = okLabOf(linearOf(evenColour(k / 20.0))).x();
    EXPECT_NEAR(lightness, 0.38 + 0.54 * k / 20.0, 0.01);
    EXPECT_GT(lightness, last);
    last = lightness;
  }
  EXPECT_EQ(evenColour(-3.0), evenColour(0.0));
  EXPECT_EQ(evenColour(7.0), evenColour(1.0));
  EXPECT_EQ(evenColour(std::nan("")), evenColour(0.0));
}

TEST(Colour, HexAndMixing) {
  EXPECT_EQ(hexOf({15, 18, 255}), "#0f12ff");
  EXPECT_EQ(mixed({0, 100, 200}, {200, 100, 0}, 0.25), (Rgb{50, 100, 150}));
  EXPECT_EQ(mixed({1, 2, 3}, {9, 9, 9}, -1), (Rgb{1, 2, 3}));
  EXPECT_EQ(mixed({1, 2, 3}, {9, 9, 9}, 2), (Rgb{9, 9, 9}));
}

}  // namespace
}  // namespace tiltmap
