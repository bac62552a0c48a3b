// Reproducible random numbers: the same seed gives the same bytes on every machine, for any thread count.
//
// The standard's distributions may differ between libraries, so uniform and normal numbers are made here.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

namespace tiltmap {

// SplitMix64 (Steele, Lea, Flood 2014): a 64-bit counter through a mixing function. Cheap to seed, so that
// each beam or scan can have a stream of its own and the order of evaluation does not matter.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(seed) {}

  // A stream of its own for each tuple of keys, e.g. {seed, stop, row, column}.
  static RandomStream keyed(std::initializer_list<std::uint64_t> keys) {
    std::uint64_t state = 0x243f6a8885a308d3ULL;
    for (const std::uint64_t key : keys) state = mix(state ^ mix(key + 0x9e3779b97f4a7c15ULL));
    return RandomStream(state);
  }

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return mix(state_);
  }
  // In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // In [0, count); count > 0.
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  // Mean 0, deviation 1 (Box and Muller 1958; the second number is thrown away to keep one draw per call).
  double normal() {
    const double u = 1.0 - uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace tiltmap
