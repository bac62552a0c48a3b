// Long moves of the MIP 50 at one speed: where the tilt is on the way, and that nothing uncertain is
// believed.
#include <algorithm>

#include <gtest/gtest.h>

#include "hardware/emulator/mip50_emulator.h"
#include "hardware/tilt/mip50_unit.h"
#include "support/tilt_bench.h"

namespace tiltmap {
namespace {

TEST(SteadyMotion, IsALineBetweenItsRamps) {
  const SteadyMotion up{Instant{} + durationOf(1.0), -0.5, 0.5, 0.2, 0.1};
  EXPECT_NEAR(up.duration(), 5.1, 1e-12);
  EXPECT_NEAR(up.angle(up.start + durationOf(0.5 * up.duration())), 0.0, 1e-9) << "halfway in the middle";
  EXPECT_NEAR(up.angle(up.steadyFrom()), -0.49, 1e-9) << "a ramp goes half as far";
  EXPECT_NEAR(secondsOf(up.when(up.angle(up.start + durationOf(2.0))) - up.start), 2.0, 1e-9);
  SteadyMotion down = up;
  std::swap(down.from_rad, down.to_rad);
  EXPECT_NEAR(down.duration(), 5.1, 1e-12);
  EXPECT_NEAR(down.angle(down.steadyFrom()), 0.49, 1e-9);
  EXPECT_EQ((SteadyMotion{}).duration(), 0.0);
  EXPECT_EQ((SteadyMotion{}).when(1.0), kNever);
}

class Mip50SteadyTest : public ::testing::Test, protected test_support::TiltBench<Mip50Unit, Mip50Emulator> {
 protected:
  void SetUp() override { make({}); }
  void make(Mip50EmulatorSettings settings) {
    detach();
    pair_ = MemoryPair::make(clock_, "test");
    ASSERT_TRUE(pair_.host->setLine({19200, Parity::None}));
    drive_.level_count = settings.levelCount();
    attach(std::make_unique<Mip50Emulator>(clock_, *pair_.device, settings));
    unit_ = std::make_unique<Mip50Unit>(std::move(pair_.host), clock_, drive_, settings.table);
    ASSERT_TRUE(unit_->prepare({}));
  }

  struct Seen {
    Instant at;
    double angle;
  };
  // Up to 50 degrees; where the tilt truly was, every 20 ms.
  Result<TiltReading> glide(double wished_deg_s, double to_deg = 50.0) {
    seen_.clear();
    const SteadySpeed speed = unit_->steadySpeed(wished_deg_s * kDegree);
    if (Status status = unit_->moveSteadily(to_deg * kDegree, speed.rate_rad_s); !status)
      return fail(status.error());
    const Instant end = clock_.now() + durationOf(200.0);
    while (clock_.now() < end) {
      auto reading = unit_->poll();
      if (!reading) return fail(reading.error());
      if (*reading) return **reading;
      if (seen_.empty() || clock_.now() - seen_.back().at > durationOf(0.015))
        seen_.push_back({clock_.now(), emulator_->angle(clock_.now())});
      clock_.sleepFor(durationOf(0.0005));
      if (at_ && clock_.now() >= *at_) {
        at_.reset();
        then_();
      }
    }
    return fail("nothing came", "test", "");
  }

  void pollFor(double seconds) {
    for (const Instant end = clock_.now() + durationOf(seconds); clock_.now() < end;) {
      ASSERT_TRUE(unit_->poll());
      clock_.sleepFor(durationOf(0.002));
    }
  }

  std::vector<Seen> seen_;
  std::optional<Instant> at_;
  std::function<void()> then_;
};

TEST_F(Mip50SteadyTest, TheAngleOfEveryInstantIsKnownAfterwards) {
  for (const double wished : {3.75, 100.0}) {
    ASSERT_TRUE(unit_->moveTo(-33.0 * kDegree));
    while (!*unit_->poll()) clock_.sleepFor(durationOf(0.002));
    const auto reading = glide(wished);
    ASSERT_TRUE(reading) << reading.error().what;
    EXPECT_NEAR(reading->angle_rad / kDegree, 50.0, 0.01);
    const auto motion = unit_->steadyMotion();
    ASSERT_TRUE(motion);
    int compared = 0;
    for (const Seen& seen : seen_) {
      if (seen.at < motion->steadyFrom() || seen.at > motion->steadyTo()) continue;
      EXPECT_NEAR(motion->angle(seen.at) / kDegree, seen.angle / kDegree, 0.015);
      ++compared;
    }
    EXPECT_GT(compared, 250);
    EXPECT_LE(motion->rate_rad_s / kDegree, wished + 1e-9);
  }
  // Moves from line to line are as fast as before.
  ASSERT_TRUE(unit_->moveTo(49.0 * kDegree));
  const Instant begin = clock_.now();
  while (!*unit_->poll()) clock_.sleepFor(durationOf(0.002));
  EXPECT_LT(secondsOf(clock_.now() - begin), 1.0);
}

TEST_F(Mip50SteadyTest, SpeedIsWhatTheMotorCanAndInWholeCounts) {
  const double counts_per_degree = drive_.counts_per_turn / 360.0;
  EXPECT_NEAR(unit_->steadySpeed(1000.0).rate_rad_s / kDegree, 120e3 / counts_per_degree, 1e-6);
  EXPECT_NEAR(unit_->steadySpeed(3.7538 * kDegree).rate_rad_s / kDegree, 32e3 / counts_per_degree, 1e-6);
  EXPECT_NEAR(unit_->steadySpeed(0.5 * kDegree).rate_rad_s / kDegree, 0.5, 1e-6) << "slow ones as they are";
}

TEST_F(Mip50SteadyTest, StopTakesEffectWithin200MillisecondsAndHomeIsSearchedAgain) {
  ASSERT_TRUE(unit_->moveSteadily(50.0 * kDegree, 0.2));
  pollFor(1.5);
  ASSERT_FALSE(emulator_->still(clock_.now()));
  unit_->stop();
  clock_.sleepFor(durationOf(0.2));
  const double there = emulator_->angle(clock_.now());
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(emulator_->angle(clock_.now()), there);
  EXPECT_LT(there / kDegree, -10.0) << "far from its end";
  EXPECT_FALSE(unit_->poll()) << "has to be prepared again";
  EXPECT_FALSE(unit_->steadyMotion());
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_NEAR(emulator_->angle(clock_.now()) / kDegree, -36.0, 0.01);
}

TEST_F(Mip50SteadyTest, WithoutACommandToInterruptNoLongMoveIsBegun) {
  Mip50EmulatorSettings settings;
  settings.table.interrupt.clear();
  make(settings);
  EXPECT_EQ(unit_->steadySpeed(1.0).rate_rad_s, 0.0);
  const double there = emulator_->angle(clock_.now());
  const Status refused = unit_->moveSteadily(0.5, 0.2);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("--mode stop"), std::string::npos);
  clock_.sleepFor(durationOf(1.0));
  EXPECT_NEAR(emulator_->angle(clock_.now()), there, 1e-4);
}

TEST_F(Mip50SteadyTest, OutsideOfTheLimitsNothingMoves) {
  EXPECT_FALSE(unit_->moveSteadily(61.0 * kDegree, 0.2));
  EXPECT_TRUE(unit_->moveTo(0.0)) << "and it is ready as before";
}

// Whatever goes wrong on the way: no motion is claimed that was none.
TEST_F(Mip50SteadyTest, AMoveThatWentWrongIsNotBelieved) {
  for (const Mip50Fault fault :
       {Mip50Fault::Stall, Mip50Fault::FollowError, Mip50Fault::LostSteps, Mip50Fault::LostDone,
        Mip50Fault::PowerCut, Mip50Fault::FlippedCommandByte, Mip50Fault::LateReply}) {
    SCOPED_TRACE(mip50FaultName(fault));
    emulator_->inject(Mip50Fault::Recover);
    make({});
    const bool later =
        fault == Mip50Fault::LostDone || fault == Mip50Fault::PowerCut || fault == Mip50Fault::LateReply;
    if (later) {
      at_ = clock_.now() + durationOf(2.0);
      then_ = [&] { emulator_->inject(fault); };
    } else {
      emulator_->inject(fault);
    }
    const auto reading = glide(8.0);
    if (reading) {
      // A command that was garbled may have been sent again in time; then all is well.
      if (fault != Mip50Fault::FlippedCommandByte) {
        EXPECT_FALSE(unit_->steadyMotion());
      }
    } else {
      EXPECT_GT(reading.error().remedy.size(), 10U) << reading.error().what;
    }
    if (const auto motion = unit_->steadyMotion()) {
      for (const Seen& seen : seen_)
        if (seen.at > motion->steadyFrom() && seen.at < motion->steadyTo()) {
          EXPECT_NEAR(motion->angle(seen.at), seen.angle, 0.001);
        }
    }
    if (!reading) {
      EXPECT_TRUE(unit_->prepare({}));
    }
  }
}

TEST_F(Mip50SteadyTest, AMotorThatIsSlowerThanToldIsFoundOut) {
  Mip50EmulatorSettings settings;
  settings.most_speed = 100.0;  // told 120
  make(settings);
  const auto reading = glide(100.0);
  ASSERT_TRUE(reading);
  EXPECT_FALSE(unit_->steadyMotion());
  const auto warnings = unit_->takeWarnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("velocity"), std::string::npos) << warnings.front();
}

TEST_F(Mip50SteadyTest, AControllerThatDoesNotHeedTheInterruptEndsItsMove) {
  Mip50EmulatorSettings settings;
  settings.heeds_interrupt = false;
  make(settings);
  ASSERT_TRUE(unit_->moveSteadily(-20.0 * kDegree, 0.2));
  pollFor(0.5);
  unit_->stop();
  EXPECT_TRUE(unit_->prepare({})) << "waits for the end of the move, then begins anew";
}

}  // namespace
}  // namespace tiltmap
