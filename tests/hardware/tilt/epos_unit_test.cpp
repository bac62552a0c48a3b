#include "hardware/tilt/epos_unit.h"

#include <gtest/gtest.h>

#include "hardware/emulator/epos_emulator.h"
#include "support/tilt_bench.h"

namespace tiltmap {
namespace {

// A unit and an emulated controller, on a clock that costs nothing.
class EposUnitTest : public ::testing::TestWithParam<EposProtocol>,
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
    unit_ = std::make_unique<EposUnit>(std::move(pair_.host), clock_, drive_, wanted_);
  }

  EposSettings wanted_;
  EposEmulatorSettings settings_;
};
std::string protocolName(const ::testing::TestParamInfo<EposProtocol>& test) {
  return eposProtocolName(test.param);
}
INSTANTIATE_TEST_SUITE_P(Protocols, EposUnitTest,
                         ::testing::Values(EposProtocol::V1, EposProtocol::V2, EposProtocol::V2Usb),
                         protocolName);

TEST_P(EposUnitTest, IsFoundAtWhateverRateAndGoesWhereItIsSent) {
  EXPECT_FALSE(unit_->moveTo(0.0)) << "not before home is known";
  const Status prepared = unit_->prepare({});
  ASSERT_TRUE(prepared) << prepared.error().what << " / " << prepared.error().remedy;
  EXPECT_EQ(unit_->protocol(), GetParam());
  EXPECT_NEAR(emulator_->angle(clock_.now()) / kDegree, -36.0, 0.01);
  for (const double degrees : {-30.0, -29.2, -28.4, 50.0, -30.0, 0.0}) expectAt(degrees);
  const Instant before = clock_.now();
  EXPECT_TRUE(unit_->prepare({}));
  EXPECT_EQ(clock_.now(), before) << "ready already";
  EXPECT_TRUE(unit_->takeWarnings().empty());
  EXPECT_TRUE(unit_->release());
  EXPECT_FALSE(emulator_->enabled());
}

TEST_P(EposUnitTest, OneStepIsOverInTimeForTheNextTelegram) {
  settings_.baud = 115200;
  make();
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(-30.0);
  const Instant start = clock_.now();
  ASSERT_TRUE(unit_->moveTo(-29.2 * kDegree));
  const auto reading = wait();
  ASSERT_TRUE(reading);
  // 118 ms of motion, 50 ms of settling, two objects written before and one read after it.
  EXPECT_LT(secondsOf(reading->settled - start), 0.186);
  EXPECT_GT(secondsOf(reading->settled - start), 0.168);
}

TEST_P(EposUnitTest, LimitsAreKeptWithoutMoving) {
  ASSERT_TRUE(unit_->prepare({}));
  const Status status = unit_->moveTo(70.0 * kDegree);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("70.00"), std::string::npos);
  EXPECT_FALSE(unit_->checkAngle(-50.0 * kDegree));
  EXPECT_TRUE(unit_->checkAngle(-45.0 * kDegree));
}

TEST_P(EposUnitTest, StopTakesEffectWithin200Milliseconds) {
  ASSERT_TRUE(unit_->prepare({}));
  ASSERT_TRUE(unit_->moveTo(50.0 * kDegree));
  for (int i = 0; i < 700; ++i) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.001));
  }
  const Instant asked = clock_.now();
  unit_->stop();
  EXPECT_LE(secondsOf(clock_.now() - asked), 0.11);
  double last = emulator_->counts(clock_.now());
  Instant rest = asked;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.001));
    if (emulator_->counts(clock_.now()) != last) rest = clock_.now();
    last = emulator_->counts(clock_.now());
  }
  EXPECT_LE(secondsOf(rest - asked), 0.2);
  EXPECT_LT(emulator_->angle(clock_.now()) / kDegree, 20.0);
  expectAt(10.0);
}

// The halt is lost as well: the segment ends by itself.
TEST_P(EposUnitTest, StopTakesEffectWithoutAnAnswer) {
  ASSERT_TRUE(unit_->prepare({}));
  ASSERT_TRUE(unit_->moveTo(50.0 * kDegree));
  for (int i = 0; i < 700; ++i) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.001));
  }
  emulator_->inject(EposFault::Silence);
  emulator_->inject(EposFault::LostCommandByte);
  const Instant asked = clock_.now();
  unit_->stop();
  clock_.sleepUntil(asked + durationOf(0.2));
  const double there = emulator_->counts(clock_.now());
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(emulator_->counts(clock_.now()), there);
}

TEST_P(EposUnitTest, NobodyAtTheOtherEnd) {
  wanted_.bauds = {19200};
  make();
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("does not answer"), std::string::npos);
  EXPECT_NE(status.error().remedy.find("19200"), std::string::npos);
}

TEST_P(EposUnitTest, AnotherNodeIsToldAsSuch) {
  wanted_.node = 2;
  make();
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  settings_.node = 2;
  make();
  ASSERT_TRUE(unit_->prepare({}));
}

TEST_P(EposUnitTest, AnotherHomingMethod) {
  wanted_.home_method = 35;
  make();
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_NEAR(emulator_->angle(clock_.now()) / kDegree, 0.0, 0.01) << "home is where it stood";
  wanted_.home_method = 21;
  make();
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("6098"), std::string::npos) << status.error().what;
}

TEST_P(EposUnitTest, ItSaysWhatItIsWithoutMoving) {
  const auto identity = unit_->identify({});
  ASSERT_TRUE(identity) << identity.error().what;
  EXPECT_EQ(identity->protocol, GetParam());
  EXPECT_EQ(identity->baud, settings_.baud);
  EXPECT_EQ(identity->status & 0x6F, 0x40U);
  EXPECT_EQ(identity->position, 0);
  EXPECT_FALSE(emulator_->enabled());
}

TEST_P(EposUnitTest, AStoredErrorIsToldAndCleared) {
  ASSERT_TRUE(unit_->prepare({}));
  emulator_->inject(EposFault::Stall);
  ASSERT_FALSE(goTo(10.0));
  ASSERT_TRUE(unit_->prepare({}));
  const auto warnings = unit_->takeWarnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("following error"), std::string::npos) << warnings.front();
  expectAt(10.0);
}

TEST_P(EposUnitTest, APulledPlugIsAnError) {
  ASSERT_TRUE(unit_->prepare({}));
  pair_.unplug();
  const auto failed = goTo(0.0);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().what.find("connection"), std::string::npos);
}

TEST_P(EposUnitTest, PreparingCanBeCancelled) {
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  job.report = [&](const Progress& progress) {
    if (progress.message.find("home") != std::string::npos) source.request_stop();
  };
  const Status status = unit_->prepare(job);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  clock_.sleepFor(durationOf(0.2));
  const double there = emulator_->counts(clock_.now());
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(emulator_->counts(clock_.now()), there) << "it stands";
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(0.0);
}

// A search for home that is under way, and cancelled.
TEST_P(EposUnitTest, TheSearchForHomeCanBeCancelled) {
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  class Ender : public Actor {
   public:
    Ender(Instant at, std::stop_source& source) : at_(at), source_(source) {}
    Instant nextEvent() const override { return at_; }
    void act(Instant) override {
      at_ = kNever;
      source_.request_stop();
    }

   private:
    Instant at_;
    std::stop_source& source_;
  } ender(clock_.now() + durationOf(7.0), source);
  clock_.attach(ender);
  const Status status = unit_->prepare(job);
  clock_.detach(ender);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  clock_.sleepFor(durationOf(0.2));
  const double there = emulator_->counts(clock_.now());
  EXPECT_NE(there, 0.0) << "it was on its way";
  clock_.sleepFor(durationOf(1.0));
  EXPECT_EQ(emulator_->counts(clock_.now()), there) << "it stands";
}

TEST_P(EposUnitTest, ABadDriveIsABrokenContract) {
  drive_.speed = -1.0;
  auto pair = MemoryPair::make(clock_);
  EXPECT_THROW(EposUnit(std::move(pair.host), clock_, drive_), std::invalid_argument);
  drive_.speed = 100.0;
  pair = MemoryPair::make(clock_);
  wanted_.node = 200;
  EXPECT_THROW(EposUnit(std::move(pair.host), clock_, drive_, wanted_), std::invalid_argument);
}

// A fault of the line or a late answer: the tilt goes all the same where it should.
TEST_P(EposUnitTest, PassingFaultsAreGotOver) {
  ASSERT_TRUE(unit_->prepare({}));
  for (const EposFault fault :
       {EposFault::LateReply, EposFault::LostAcknowledge, EposFault::RefusedFrame, EposFault::LostByte,
        EposFault::FlippedByte, EposFault::InsertedByte, EposFault::LostCommandByte,
        EposFault::FlippedCommandByte, EposFault::LostSteps}) {
    SCOPED_TRACE(eposFaultName(fault));
    double degrees = -30.0;
    for (int i = 0; i < 8; ++i) {
      emulator_->inject(fault);
      expectAt(degrees += 0.8);
      // Between two objects of a move, wherever that is.
      ASSERT_TRUE(unit_->moveTo((degrees += 0.8) * kDegree));
      for (int k = 0; k < 3 * i; ++k) {
        clock_.sleepFor(durationOf(0.001));
        ASSERT_TRUE(unit_->poll());
      }
      emulator_->inject(fault);
      const auto reading = wait();
      ASSERT_TRUE(reading) << reading.error().what;
      EXPECT_NEAR(reading->angle_rad / kDegree, degrees, 0.02);
      EXPECT_NEAR(reading->angle_rad, emulator_->angle(clock_.now()), 1e-6);
    }
    emulator_->inject(EposFault::Recover);
    expectAt(-30.0);
  }
}

// A fault of the drive: an error that says what to do, and prepare() puts everything right.
TEST_P(EposUnitTest, TroubleIsToldAndPreparingAgainMendsIt) {
  for (const EposFault fault :
       {EposFault::Stall, EposFault::FollowError, EposFault::Silence, EposFault::PowerCut}) {
    SCOPED_TRACE(eposFaultName(fault));
    make();
    ASSERT_TRUE(unit_->prepare({}));
    expectAt(-30.0);
    emulator_->inject(fault);
    const auto failed = goTo(10.0);
    ASSERT_FALSE(failed);
    EXPECT_FALSE(failed.error().what.empty());
    EXPECT_NE(failed.error().remedy.find("capture"), std::string::npos) << failed.error().remedy;
    EXPECT_FALSE(unit_->moveTo(0.0)) << "not before it is prepared again";
    emulator_->inject(EposFault::Recover);
    clock_.sleepFor(durationOf(5.0));
    ASSERT_TRUE(unit_->prepare({}));
    expectAt(10.0);
  }
}

}  // namespace
}  // namespace tiltmap
