#include "hardware/tilt/mip50_unit.h"

#include <gtest/gtest.h>

#include "hardware/emulator/mip50_emulator.h"
#include "support/tilt_bench.h"

namespace tiltmap {
namespace {

// A unit and an emulated controller, on a clock that costs nothing.
class Mip50UnitTest : public ::testing::Test, protected test_support::TiltBench<Mip50Unit, Mip50Emulator> {
 protected:
  void SetUp() override { make({}); }

  void make(Mip50EmulatorSettings settings, int host_baud = 19200) {
    detach();
    pair_ = MemoryPair::make(clock_, "test");
    ASSERT_TRUE(pair_.host->setLine({host_baud, Parity::None}));
    drive_.level_count = settings.levelCount();
    attach(std::make_unique<Mip50Emulator>(clock_, *pair_.device, settings));
    unit_ = std::make_unique<Mip50Unit>(std::move(pair_.host), clock_, drive_, settings.table);
  }
};

TEST_F(Mip50UnitTest, FindsHomeAndGoesWhereItIsSent) {
  EXPECT_FALSE(unit_->moveTo(0.0)) << "not before home is known";
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_NEAR(emulator_->angle(clock_.now()) / kDegree, -36.0, 0.01);
  for (const double degrees : {-30.0, -29.2, -28.4, 50.0, -30.0, 0.0}) expectAt(degrees);
  const Instant before = clock_.now();
  EXPECT_TRUE(unit_->prepare({}));
  EXPECT_EQ(clock_.now(), before) << "ready already";
  EXPECT_TRUE(unit_->release());
  EXPECT_FALSE(emulator_->regulated());
}

TEST_F(Mip50UnitTest, OneStepIsOverInTimeForTheNextTelegram) {
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(-30.0);
  const Instant start = clock_.now();
  ASSERT_TRUE(unit_->moveTo(-29.2 * kDegree));
  const auto reading = wait();
  ASSERT_TRUE(reading);
  // 118 ms of motion, 50 ms of settling, a command and an acknowledge at 19200 Bd.
  EXPECT_LT(secondsOf(reading->settled - start), 0.185);
  EXPECT_GT(secondsOf(reading->settled - start), 0.168);
}

TEST_F(Mip50UnitTest, LimitsAreKeptWithoutMoving) {
  ASSERT_TRUE(unit_->prepare({}));
  const Status status = unit_->moveTo(70.0 * kDegree);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("70.00"), std::string::npos);
  EXPECT_FALSE(unit_->checkAngle(-50.0 * kDegree));
  EXPECT_TRUE(unit_->checkAngle(-45.0 * kDegree));
}

TEST_F(Mip50UnitTest, StopTakesEffectWithin200Milliseconds) {
  ASSERT_TRUE(unit_->prepare({}));
  ASSERT_TRUE(unit_->moveTo(50.0 * kDegree));
  for (int i = 0; i < 700; ++i) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.001));
  }
  unit_->stop();
  const Instant stopped = clock_.now();
  double last = emulator_->angle(stopped);
  Instant rest = stopped;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(unit_->poll());
    clock_.sleepFor(durationOf(0.001));
    if (emulator_->counts(clock_.now()) != last) rest = clock_.now();
    last = emulator_->counts(clock_.now());
  }
  EXPECT_LE(secondsOf(rest - stopped), 0.2);
  EXPECT_LT(emulator_->angle(clock_.now()) / kDegree, 20.0);
  expectAt(10.0);
}

TEST_F(Mip50UnitTest, ComesUpFromTheTextMenuWithoutACarriageReturn) {
  Mip50EmulatorSettings settings;
  settings.text_menu = true;
  make(settings);
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(5.0);
  EXPECT_TRUE(unit_->takeWarnings().empty()) << "a carriage return would have left an error behind";
}

TEST_F(Mip50UnitTest, NobodyAtTheOtherEnd) {
  make({}, 9600);  // the emulator speaks 19200
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("does not answer"), std::string::npos);
  EXPECT_NE(status.error().remedy.find("9600"), std::string::npos);
}

TEST_F(Mip50UnitTest, ParametersCanBeRead) {
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_EQ(unit_->readParameter(15).value(), 1526);
  EXPECT_FALSE(unit_->readParameter(99));
}

TEST_F(Mip50UnitTest, AnotherTableIsSpokenByBoth) {
  Mip50EmulatorSettings settings;
  settings.table.move_absolute = "M{axis}:{value}G";
  settings.table.done = "OK";
  make(settings);
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(3.0);
  settings.table.speed.clear();
  make(settings);
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("table"), std::string::npos);
}

// A fault of the line or a late answer: the line is taken all the same, where it should be.
class Mip50PassingFault : public Mip50UnitTest, public ::testing::WithParamInterface<Mip50Fault> {};
TEST_P(Mip50PassingFault, IsGotOver) {
  ASSERT_TRUE(unit_->prepare({}));
  double degrees = -30.0;
  for (int i = 0; i < 12; ++i) {
    emulator_->inject(GetParam());
    if (i % 3 == 2) emulator_->inject(GetParam());
    expectAt(degrees += 0.8);
  }
  emulator_->inject(GetParam());
  expectAt(-30.0);
}
INSTANTIATE_TEST_SUITE_P(Faults, Mip50PassingFault,
                         ::testing::Values(Mip50Fault::LateReply, Mip50Fault::LostDone, Mip50Fault::LostByte,
                                           Mip50Fault::FlippedByte, Mip50Fault::InsertedByte,
                                           Mip50Fault::LostCommandByte, Mip50Fault::LostSteps),
                         [](const auto& test) {
                           std::string name = mip50FaultName(test.param);
                           std::erase(name, '-');
                           return name;
                         });

// A fault of the drive: an error that says what to do, and prepare() puts everything right.
class Mip50Trouble : public Mip50UnitTest, public ::testing::WithParamInterface<Mip50Fault> {};
TEST_P(Mip50Trouble, IsToldAndPreparingAgainMendsIt) {
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(-30.0);
  emulator_->inject(GetParam());
  const auto failed = goTo(10.0);
  ASSERT_FALSE(failed);
  EXPECT_FALSE(failed.error().what.empty());
  EXPECT_NE(failed.error().remedy.find("capture"), std::string::npos) << failed.error().remedy;
  EXPECT_FALSE(unit_->moveTo(0.0)) << "not before it is prepared again";
  emulator_->inject(Mip50Fault::Recover);
  clock_.sleepFor(durationOf(5.0));
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(10.0);
}
INSTANTIATE_TEST_SUITE_P(Faults, Mip50Trouble,
                         ::testing::Values(Mip50Fault::Stall, Mip50Fault::FollowError, Mip50Fault::Silence,
                                           Mip50Fault::PowerCut),
                         [](const auto& test) {
                           std::string name = mip50FaultName(test.param);
                           std::erase(name, '-');
                           return name;
                         });

TEST_F(Mip50UnitTest, APulledPlugIsAnError) {
  ASSERT_TRUE(unit_->prepare({}));
  pair_.unplug();
  const auto failed = goTo(0.0);
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().what.find("connection"), std::string::npos);
}

TEST_F(Mip50UnitTest, PreparingCanBeCancelled) {
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  job.report = [&](const Progress& progress) {
    if (progress.message.find("home") != std::string::npos) source.request_stop();
  };
  const Instant start = clock_.now();
  const Status status = unit_->prepare(job);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  EXPECT_LT(secondsOf(clock_.now() - start), 3.0);
  ASSERT_TRUE(unit_->prepare({}));
  expectAt(0.0);
}

TEST_F(Mip50UnitTest, ABadDriveIsABrokenContract) {
  drive_.speed = -1.0;
  auto pair = MemoryPair::make(clock_);
  EXPECT_THROW(Mip50Unit(std::move(pair.host), clock_, drive_), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
