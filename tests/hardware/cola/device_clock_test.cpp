#include "hardware/capture/device_clock.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace tiltmap {
namespace {

TEST(DeviceClock, ATelegramThatWasHeldUpIsNotTakenForAYoungerOne) {
  DeviceClock clock(1e-3, 24);
  const Instant start{std::chrono::seconds(5)};
  RandomStream random(3);
  // The counter wraps in between.
  std::uint32_t ticks = (1U << 24) - 50;
  for (int i = 0; i < 200; ++i, ticks += 25) {
    const Instant made = start + std::chrono::milliseconds(25 * i);
    const auto held_up = std::chrono::microseconds(i == 0 ? 1000 : 500 + random.below(60000));
    const Instant said = clock.heard(ticks & 0xFFFFFF, made + held_up);
    EXPECT_GE(said, made);
    EXPECT_LE(said, made + std::chrono::microseconds(1000) + std::chrono::milliseconds(2)) << i;
    EXPECT_LE(said, made + held_up);
  }
}

TEST(DeviceClock, ClocksMayDriftApart) {
  DeviceClock clock(1e-6, 32);
  const Instant start{std::chrono::seconds(5)};
  for (int i = 0; i < 20000; ++i) {
    const Instant made = start + std::chrono::milliseconds(20 * i);
    // The instrument's clock is fast or slow by 100 ppm.
    for (const double drift : {-1e-4}) {
      const auto ticks = static_cast<std::uint32_t>(20000.0 * i * (1.0 + drift));
      const Instant said = clock.heard(ticks, made + std::chrono::milliseconds(1));
      EXPECT_LE(std::abs(secondsOf(said - made)), 0.0015) << i;
    }
  }
}

TEST(DeviceClock, ACounterThatBeginsAnewIsMetAnew) {
  DeviceClock clock(1e-6, 32);
  const Instant start{std::chrono::seconds(5)};
  (void)clock.heard(100'000'000, start);
  const Instant later = start + std::chrono::seconds(60);
  EXPECT_EQ(clock.heard(2'000'000, later), later);
  const Instant next = clock.heard(2'020'000, later + std::chrono::milliseconds(25));
  EXPECT_NEAR(secondsOf(next - later), 0.020, 1e-5);
  EXPECT_EQ(clock.between(0xFFFFFFFF, 999), std::chrono::microseconds(1000));
}

}  // namespace
}  // namespace tiltmap
