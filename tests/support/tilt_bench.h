// A tilt unit and the emulated controller behind it, on a clock that costs nothing.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/tilt/tilt_unit.h"
#include "hardware/transport/memory_channel.h"

namespace tiltmap::test_support {

// Who derives makes `unit_` and `emulator_`, each on one end of `pair_`.
template <typename Unit, typename Emulator>
class TiltBench {
 protected:
  ~TiltBench() { detach(); }
  // Before new ones are made.
  void detach() {
    if (emulator_) clock_.detach(*emulator_);
    unit_.reset();
    emulator_.reset();
  }
  void attach(std::unique_ptr<Emulator> emulator) {
    emulator_ = std::move(emulator);
    clock_.attach(*emulator_);
  }

  Result<TiltReading> wait(double limit_s = 60.0) {
    const Instant end = clock_.now() + durationOf(limit_s);
    while (clock_.now() < end) {
      auto reading = unit_->poll();
      if (!reading) return fail(reading.error());
      if (*reading) {
        clock_.sleepUntil((*reading)->settled);
        return **reading;
      }
      clock_.sleepFor(durationOf(0.001));
    }
    return fail("nothing came", "test", "");
  }
  Result<TiltReading> goTo(double degrees) {
    if (Status status = unit_->moveTo(degrees * kDegree); !status) return fail(status.error());
    return wait();
  }
  void expectAt(double degrees) {
    const auto reading = goTo(degrees);
    ASSERT_TRUE(reading) << reading.error().what << " / " << reading.error().remedy;
    EXPECT_NEAR(reading->angle_rad / kDegree, degrees, 0.02);
    EXPECT_NEAR(reading->angle_rad, emulator_->angle(clock_.now()), 1e-6) << "what is said is where it is";
    EXPECT_TRUE(emulator_->still(reading->settled));
  }

  VirtualClock clock_;
  TiltDrive drive_;
  MemoryPair pair_;
  std::unique_ptr<Emulator> emulator_;
  std::unique_ptr<Unit> unit_;
};

}  // namespace tiltmap::test_support
