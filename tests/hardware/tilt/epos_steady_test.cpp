// Long moves of an EPOS at one speed: where the tilt is on the way, and that nothing uncertain is believed.
#include <algorithm>

#include <gtest/gtest.h>

#include "hardware/emulator/epos_emulator.h"
#include "hardware/tilt/epos_unit.h"
#include "support/tilt_bench.h"

namespace tiltmap {
namespace {

class EposSteadyTest : public ::testing::TestWithParam<EposProtocol>,
                       protected test_support::TiltBench<EposUnit, EposEmulator> {
 protected:
  void SetUp() override {
    settings_.protocol = GetParam();
    settings_.baud = GetParam() == EposProtocol::V1 ? 38400 : 115200;
    make();
  }
  void make() {
    detach();
    pair_ = MemoryPair::make(clock_, "test");
    drive_.level_count = settings_.levelCount();
    attach(std::make_unique<EposEmulator>(clock_, *pair_.device, settings_));
    unit_ = std::make_unique<EposUnit>(std::move(pair_.host), clock_, drive_, EposSettings());
    ASSERT_TRUE(unit_->prepare({}));
  }
  struct Seen {
    Instant at;
    double angle;
  };
  // Up to 50 degrees; where the tilt truly was, every 20 ms.
  Result<TiltReading> glide(double wished_deg_s) {
    seen_.clear();
    const SteadySpeed speed = unit_->steadySpeed(wished_deg_s * kDegree);
    if (Status status = unit_->moveSteadily(50.0 * kDegree, speed.rate_rad_s); !status)
      return fail(status.error());
    for (const Instant end = clock_.now() + durationOf(200.0); clock_.now() < end;) {
      auto reading = unit_->poll();
      if (!reading) return fail(reading.error());
      if (*reading) return **reading;
      if (seen_.empty() || clock_.now() - seen_.back().at > durationOf(0.02))
        seen_.push_back({clock_.now(), emulator_->angle(clock_.now())});
      clock_.sleepFor(durationOf(0.0005));
      if (at_ && clock_.now() >= *at_) {
        at_.reset();
        emulator_->inject(fault_);
      }
    }
    return fail("nothing came", "test", "");
  }
  double worstOff(const SteadyMotion& motion) const {
    double worst = 0.0;
    for (const Seen& seen : seen_)
      if (seen.at >= motion.steadyFrom() && seen.at <= motion.steadyTo())
        worst = std::max(worst, std::abs(motion.angle(seen.at) - seen.angle));
    return worst;
  }

  EposEmulatorSettings settings_;
  std::vector<Seen> seen_;
  std::optional<Instant> at_;
  EposFault fault_ = EposFault::Recover;
};
INSTANTIATE_TEST_SUITE_P(Protocols, EposSteadyTest,
                         ::testing::Values(EposProtocol::V1, EposProtocol::V2, EposProtocol::V2Usb),
                         [](const auto& test) { return eposProtocolName(test.param); });

TEST_P(EposSteadyTest, TheAngleOfEveryInstantIsKnownAfterwards) {
  for (const double wished : {3.75, 100.0}) {
    ASSERT_TRUE(unit_->moveTo(-33.0 * kDegree));
    ASSERT_TRUE(wait());
    EXPECT_FALSE(unit_->steadyMotion()) << "of a move that is no steady one";
    const auto reading = glide(wished);
    ASSERT_TRUE(reading) << reading.error().what;
    EXPECT_NEAR(reading->angle_rad / kDegree, 50.0, 0.02);
    const auto motion = unit_->steadyMotion();
    ASSERT_TRUE(motion);
    EXPECT_LE(motion->rate_rad_s / kDegree, wished + 1e-6);
    EXPECT_GT(seen_.size(), 200U);
    EXPECT_LT(worstOff(*motion) / kDegree, 0.012) << wished;
  }
  // Moves from line to line are as fast as before.
  ASSERT_TRUE(unit_->moveTo(49.0 * kDegree));
  const Instant begin = clock_.now();
  ASSERT_TRUE(wait());
  EXPECT_LT(secondsOf(clock_.now() - begin), 1.0);
}

TEST_P(EposSteadyTest, SpeedIsWhatTheMotorCanAndInWholeTurnsAMinute) {
  const double counts_per_degree = drive_.counts_per_turn / 360.0;
  const double fastest = unit_->steadySpeed(1000.0).rate_rad_s / kDegree;
  EXPECT_LE(fastest, 120e3 / counts_per_degree);
  EXPECT_GT(fastest, 119.9e3 / counts_per_degree);
  const double rpm = fastest * counts_per_degree / 2048.0 * 60.0;
  EXPECT_NEAR(rpm, std::round(rpm), 1e-6);
}

TEST_P(EposSteadyTest, StopTakesEffectAndNoMotionIsClaimed) {
  ASSERT_TRUE(unit_->moveSteadily(50.0 * kDegree, 0.2));
  for (const Instant end = clock_.now() + durationOf(1.5); clock_.now() < end;) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.002));
  }
  ASSERT_FALSE(emulator_->still(clock_.now()));
  unit_->stop();
  clock_.sleepFor(durationOf(0.2));
  const double there = emulator_->angle(clock_.now());
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(emulator_->angle(clock_.now()), there);
  EXPECT_LT(there / kDegree, -10.0) << "far from its end";
  EXPECT_FALSE(unit_->steadyMotion());
  ASSERT_TRUE(unit_->moveTo(0.0)) << "home is still known";
  ASSERT_TRUE(wait());
  EXPECT_NEAR(emulator_->angle(clock_.now()), 0.0, 0.0004);
}

TEST_P(EposSteadyTest, AMoveThatWentWrongIsNotBelieved) {
  for (const EposFault fault : allEposFaults()) {
    if (fault == EposFault::Recover) continue;
    for (const bool later : {false, true}) {
      SCOPED_TRACE(eposFaultName(fault) + (later ? " on the way" : " at its beginning"));
      emulator_->inject(EposFault::Recover);
      make();
      fault_ = fault;
      at_.reset();
      if (later)
        at_ = clock_.now() + durationOf(2.0);
      else
        emulator_->inject(fault);
      const auto reading = glide(8.0);
      if (!reading) {
        EXPECT_GT(reading.error().remedy.size(), 10U) << reading.error().what;
      }
      if (const auto motion = unit_->steadyMotion()) {
        EXPECT_LT(worstOff(*motion), 0.001);
      }
      emulator_->inject(EposFault::Recover);
      clock_.sleepFor(durationOf(4.0));
      if (!reading) {
        EXPECT_TRUE(unit_->prepare({}));
      }
    }
  }
}

TEST_P(EposSteadyTest, AMotorThatIsSlowerThanToldIsFoundOut) {
  settings_.most_speed = 100.0;  // told 120
  make();
  const auto reading = glide(100.0);
  ASSERT_TRUE(reading) << reading.error().what;
  EXPECT_FALSE(unit_->steadyMotion());
  const auto warnings = unit_->takeWarnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("supply"), std::string::npos) << warnings.front();
}

TEST_P(EposSteadyTest, OutsideOfTheLimitsNothingMoves) {
  EXPECT_FALSE(unit_->moveSteadily(61.0 * kDegree, 0.2));
  EXPECT_TRUE(unit_->moveTo(0.0)) << "and it is ready as before";
}

}  // namespace
}  // namespace tiltmap
