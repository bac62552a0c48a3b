#include "core/products/scan_colours.h"

#include <array>
#include <cmath>
#include <numbers>

namespace tiltmap {

namespace {

// Found by simulated annealing on the smallest distance in OKLab between any two, as seen by normal eyes and
// as simulated for protanopia, deuteranopia and tritanopia (Machado, Oliveira and Fernandes 2009), with
// lightness held to 0.50 to 0.85 so that each shows on black and on white. Smallest distances: 0.149, 0.109,
// 0.107, 0.097; 0.02 is about what can just be told apart side by side.
constexpr std::array<Rgb, kFixedScanColours> kColours = {{
    {222, 208, 17},   // yellow
    {94, 15, 255},    // violet
    {186, 16, 12},    // red
    {6, 234, 237},    // cyan
    {157, 11, 183},   // purple
    {249, 129, 0},    // orange
    {2, 184, 254},    // sky blue
    {118, 86, 123},   // plum
    {163, 185, 158},  // sage
    {88, 126, 240},   // blue
    {191, 126, 178},  // pink
    {116, 133, 104},  // moss
}};

}  // namespace

Rgb scanColour(std::size_t scan) {
  if (scan < kFixedScanColours) return kColours[scan];
  const std::size_t k = scan - kFixedScanColours;
  constexpr double kGoldenAngle = 2.0 * std::numbers::pi * 0.38196601125;
  constexpr std::array<double, 3> kLightness = {0.70, 0.55, 0.82};
  return rgbOfOkLch(kLightness[k % 3], 0.15,
                    std::fmod(kGoldenAngle * static_cast<double>(k), 2.0 * std::numbers::pi));
}

Rgb scanColour(const ScanEntry& scan, std::size_t index) {
  if (!scan.colour) return scanColour(index);
  const std::uint32_t rgb = *scan.colour;
  return {static_cast<std::uint8_t>(rgb >> 16 & 0xffU), static_cast<std::uint8_t>(rgb >> 8 & 0xffU),
          static_cast<std::uint8_t>(rgb & 0xffU)};
}

std::vector<Rgb> scanColours(const ProjectSnapshot& snapshot) {
  std::vector<Rgb> colours;
  for (std::size_t i = 0; i < snapshot.scans().size(); ++i)
    colours.push_back(scanColour(snapshot.scans()[i], i));
  return colours;
}

}  // namespace tiltmap
