#include "core/products/colour.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <Eigen/LU>

namespace tiltmap {

namespace {

// IEC 61966-2-1.
double toLinear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double toEncoded(double c) {
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

// The two matrices of OKLab: linear sRGB to cone-like responses, their cube roots to Lab.
const Eigen::Matrix3d& conesFromRgb() {
  static const Eigen::Matrix3d matrix{{0.4122214708, 0.5363325363, 0.0514459929},
                                      {0.2119034982, 0.6806995451, 0.1073969566},
                                      {0.0883024619, 0.2817188376, 0.6299787005}};
  return matrix;
}
const Eigen::Matrix3d& labFromCones() {
  static const Eigen::Matrix3d matrix{{0.2104542553, 0.7936177850, -0.0040720468},
                                      {1.9779984951, -2.4285922050, 0.4505937099},
                                      {0.0259040371, 0.7827717662, -0.8086757660}};
  return matrix;
}

Eigen::Vector3d linearOfOkLab(const Eigen::Vector3d& lab) {
  static const Eigen::Matrix3d cones_from_lab = labFromCones().inverse();
  static const Eigen::Matrix3d rgb_from_cones = conesFromRgb().inverse();
  const Eigen::Vector3d roots = cones_from_lab * lab;
  return rgb_from_cones * roots.cwiseProduct(roots).cwiseProduct(roots);
}

}  // namespace

std::optional<Rgb> rgbOfHex(std::string_view text) {
  if (text.starts_with('#')) text.remove_prefix(1);
  if (text.size() != 6) return std::nullopt;
  std::array<std::uint8_t, 3> channels{};
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const std::string_view digits = text.substr(2 * k, 2);
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), channels[k], 16);
    if (error != std::errc() || end != digits.end()) return std::nullopt;
  }
  return Rgb{channels[0], channels[1], channels[2]};
}

std::string hexOf(Rgb colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", static_cast<unsigned>(colour.r),
                static_cast<unsigned>(colour.g), static_cast<unsigned>(colour.b));
  return text.data();
}

Eigen::Vector3d linearOf(Rgb colour) {
  return {toLinear(colour.r / 255.0), toLinear(colour.g / 255.0), toLinear(colour.b / 255.0)};
}

Rgb rgbOfLinear(const Eigen::Vector3d& linear) {
  const auto channel = [](double c) {
    return static_cast<std::uint8_t>(std::lround(255.0 * toEncoded(std::clamp(c, 0.0, 1.0))));
  };
  return {channel(linear.x()), channel(linear.y()), channel(linear.z())};
}

Eigen::Vector3d okLabOf(const Eigen::Vector3d& linear) {
  const Eigen::Vector3d cones = conesFromRgb() * linear;
  return labFromCones() * Eigen::Vector3d(std::cbrt(cones.x()), std::cbrt(cones.y()), std::cbrt(cones.z()));
}

Rgb rgbOfOkLch(double lightness, double chroma, double hue_rad) {
  const auto at = [&](double c) {
    return linearOfOkLab({lightness, c * std::cos(hue_rad), c * std::sin(hue_rad)});
  };
  const auto shown = [](const Eigen::Vector3d& rgb) {
    return rgb.minCoeff() > -1e-4 && rgb.maxCoeff() < 1.0 + 1e-4;
  };
  if (shown(at(chroma))) return rgbOfLinear(at(chroma));
  double low = 0.0;
  double high = chroma;
  for (int step = 0; step < 20; ++step) (shown(at(0.5 * (low + high))) ? low : high) = 0.5 * (low + high);
  return rgbOfLinear(at(low));
}

Rgb evenColour(double t, double low_lightness, double high_lightness) {
  const double s = std::clamp(std::isfinite(t) ? t : 0.0, 0.0, 1.0);
  // Hue from 300 deg (violet) down to 105 deg (yellow), a steady turn.
  const double hue = (300.0 - 195.0 * s) * std::numbers::pi / 180.0;
  return rgbOfOkLch(low_lightness + (high_lightness - low_lightness) * s, 0.15, hue);
}

Rgb signedColour(double t, double middle_lightness) {
  const double s = std::clamp(std::isfinite(t) ? t : 0.0, -1.0, 1.0);
  const double hue = (s < 0.0 ? 255.0 : 55.0) * std::numbers::pi / 180.0;
  return rgbOfOkLch(middle_lightness - 0.28 * std::abs(s), 0.17 * std::abs(s), hue);
}

Rgb mixed(Rgb back, Rgb front, double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  const auto channel = [s](std::uint8_t b, std::uint8_t f) {
    return static_cast<std::uint8_t>(std::lround(b + s * (f - b)));
  };
  return {channel(back.r, front.r), channel(back.g, front.g), channel(back.b, front.b)};
}

}  // namespace tiltmap
