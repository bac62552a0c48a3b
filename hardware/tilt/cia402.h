// The objects and words of CiA 402 that a tilt needs.
#pragma once

#include <cstdint>
#include <string>

namespace tiltmap::cia402 {

inline constexpr std::uint16_t kErrorCode = 0x603F, kControl = 0x6040, kStatus = 0x6041, kMode = 0x6060,
                               kModeShown = 0x6061, kPosition = 0x6064, kTarget = 0x607A,
                               kHomeOffset = 0x607C, kSpeed = 0x6081, kSpeedUp = 0x6083, kSlowDown = 0x6084,
                               kProfileType = 0x6086, kHomeMethod = 0x6098, kHomeSpeeds = 0x6099,
                               kHomeRamp = 0x609A;
// Control words.
inline constexpr std::uint32_t kShutdown = 0x0006, kSwitchOn = 0x0007, kEnable = 0x000F,
                               kStartHoming = 0x001F, kStartMove = 0x003F, kReset = 0x0080, kHalt = 0x010F;
// Bits of the status word: target reached; set-point taken, or home attained; following or homing error.
inline constexpr std::uint32_t kReached = 1U << 10, kTaken = 1U << 12, kFollowing = 1U << 13;

inline std::uint32_t stateOf(std::uint32_t status) {
  return status & 0x6F;
}
inline bool faulty(std::uint32_t status) {
  return (status & 0x4F) == 0x08 || (status & 0x4F) == 0x0F;
}
inline bool enabled(std::uint32_t status) {
  return stateOf(status) == 0x27;
}

// What an error code (object 603F) means, with its number.
std::string errorText(std::uint32_t code);
// Four hexadecimal digits.
std::string hexWord(std::uint32_t value);

}  // namespace tiltmap::cia402
