// Colours that people see evenly: OKLab (Ottosson 2020), in which equal steps look equal.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace tiltmap {

// sRGB, 8 bits a channel.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb&) const = default;
};

std::string hexOf(Rgb colour);  // "#0f1218"
// The other way, six digits with or without #; nothing for another text.
std::optional<Rgb> rgbOfHex(std::string_view text);

// Light intensities 0 to 1, in which colours may be averaged.
Eigen::Vector3d linearOf(Rgb colour);
Rgb rgbOfLinear(const Eigen::Vector3d& linear);  // clipped to 0..1

// Lightness 0 to 1, and the two opponent axes.
Eigen::Vector3d okLabOf(const Eigen::Vector3d& linear);
// Lightness, chroma and hue (radians); chroma is lowered until the colour exists on a screen.
Rgb rgbOfOkLch(double lightness, double chroma, double hue_rad);

// `t` 0 to 1 (clipped): from deep violet over teal to yellow, its lightness rising in even steps, so that it
// also reads in grey and to the colour-blind. The lightness range suits a dark or a white background.
Rgb evenColour(double t, double low_lightness = 0.38, double high_lightness = 0.92);

// `t` -1 to 1 (clipped): blue over grey to orange, equal sizes equally far from the grey in the middle; apart
// also for the colour-blind. On a white ground give a darker middle.
Rgb signedColour(double t, double middle_lightness = 0.86);

// The share of `front` over `back`, mixed in sRGB values: equal shares look about equally strong on dark and
// white.
Rgb mixed(Rgb back, Rgb front, double share);

}  // namespace tiltmap
