// The driver against the emulated scanner, on a clock that costs nothing.
#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/cola/cola_scanner_unit.h"
#include "hardware/emulator/cola_emulator.h"
#include "hardware/transport/memory_channel.h"
#include "support/captured_lines.h"

namespace tiltmap {
namespace {

class ColaScannerTest : public ::testing::Test {
 protected:
  void make(ColaEmulatorSettings settings = {}, ColaSettings wanted = {}) {
    TearDown();
    emulator_ = std::make_unique<ColaEmulator>(clock_, view_, settings);
    emulator_->onLine([this](const auto& line) { sent_.push_back(line); });
    clock_.attach(*emulator_);
    unit_ = std::make_unique<ColaScannerUnit>(
        [this]() -> Result<std::unique_ptr<ByteChannel>> {
          pair_ = MemoryPair::make(clock_, "test", Pacing::None);
          emulator_->plug(pair_.device.get());
          return std::move(pair_.host);
        },
        clock_, wanted);
  }
  void TearDown() override {
    if (emulator_) clock_.detach(*emulator_);
    emulator_.reset();
  }
  Result<LineTaken> line(double limit_s = 3.0) { return test::nextLine(clock_, *unit_, limit_s); }

  VirtualClock clock_;
  RoundView view_{5.0F};
  std::vector<LineScannerEmulator::SentLine> sent_;
  MemoryPair pair_;
  std::unique_ptr<ColaEmulator> emulator_;
  std::unique_ptr<ColaScannerUnit> unit_;
};

TEST_F(ColaScannerTest, SendsLinesOfItsFieldOfView) {
  struct Case {
    ColaEmulatorSettings settings;
    int columns;
    double start_deg, step_deg;
  };
  for (const Case& each : {Case{ColaEmulatorSettings::lms1xx(), 541, -45.0, 0.5},
                           Case{ColaEmulatorSettings::lms5xx(), 381, -5.0, 0.5}}) {
    make(each.settings);
    const Status prepared = unit_->prepare({});
    ASSERT_TRUE(prepared) << prepared.error().what << " / " << prepared.error().remedy;
    EXPECT_EQ(unit_->columns(), each.columns);
    EXPECT_NEAR(unit_->azimuthStart() / kDegree, each.start_deg, 1e-9);
    EXPECT_NEAR(unit_->azimuthStep() / kDegree, each.step_deg, 1e-9);
    EXPECT_NE(unit_->name().find(each.settings.type), std::string::npos);
    const auto taken = line();
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->range_m.size(), static_cast<std::size_t>(each.columns));
    EXPECT_EQ(taken->range_m[7], 5.0F);
    EXPECT_EQ(taken->code[7], cell_code::kMeasured);
    EXPECT_EQ(taken->intensity[7], 100.0F);
    const Instant before = clock_.now();
    EXPECT_TRUE(unit_->prepare({}));
    EXPECT_EQ(clock_.now(), before) << "ready already";
    EXPECT_TRUE(unit_->release());
    EXPECT_FALSE(line(0.5));
  }
}

TEST_F(ColaScannerTest, LinesAreAsOldAsTheyAre) {
  make();
  ASSERT_TRUE(unit_->prepare({}));
  for (int i = 0; i < 60; ++i) {
    // Telegrams held up for a while, now and then.
    emulator_->faults().merge_s = i % 7 == 3 ? 0.09 : 0.0;
    const auto taken = line();
    ASSERT_TRUE(taken);
    const auto& sent = *std::ranges::find_if(sent_.rbegin(), sent_.rend(), [&](const auto& one) {
      return one.from >= taken->measured.from && one.to <= taken->measured.to;
    });
    EXPECT_LE(taken->measured.from, sent.from);
    EXPECT_GE(taken->measured.to, sent.to);
    EXPECT_LT(secondsOf(taken->measured.to - taken->measured.from), 0.06);
  }
}

TEST_F(ColaScannerTest, ResolutionAndRateAreSetWhereTheyAreAskedFor) {
  make({}, {.resolution_deg = 0.25, .frequency_hz = 25.0});
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_EQ(unit_->columns(), 1081);
  EXPECT_EQ(emulator_->setting().frequency_chz, 2500U);
  EXPECT_TRUE(line());
  make({}, {.resolution_deg = 0.25, .frequency_hz = 50.0});
  const Status refused = unit_->prepare({});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("0.25 deg at 50 Hz"), std::string::npos) << refused.error().what;
  EXPECT_NE(refused.error().remedy.find("0.5 deg at 50 Hz"), std::string::npos);
  ColaEmulatorSettings locked;
  locked.password = "00000000";
  make(locked, {.resolution_deg = 0.25, .frequency_hz = 25.0});
  const Status closed = unit_->prepare({});
  ASSERT_FALSE(closed);
  EXPECT_NE(closed.error().remedy.find("password"), std::string::npos);
  make(locked);
  EXPECT_TRUE(unit_->prepare({})) << "nothing is to be changed";
}

TEST_F(ColaScannerTest, AScannerThatStandsIsStarted) {
  ColaEmulatorSettings settings;
  settings.measuring = false;
  make(settings);
  const Status prepared = unit_->prepare({});
  ASSERT_TRUE(prepared) << prepared.error().what;
  EXPECT_TRUE(line());
}

TEST_F(ColaScannerTest, AScannerThatIsStillStartingIsWaitedFor) {
  ColaEmulatorSettings settings;
  settings.timing.booted = false;
  settings.timing.boot_s = 25.0;
  make(settings);
  const Instant start = clock_.now();
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_GE(secondsOf(clock_.now() - start), 25.0);
  EXPECT_TRUE(line());
}

TEST_F(ColaScannerTest, AScannerWithoutThatStateSendsAllTheSame) {
  ColaEmulatorSettings settings;
  settings.type = "TiM561";
  settings.has_state = false;
  make(settings);
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_TRUE(line());
}

TEST_F(ColaScannerTest, TheOtherDialectIsToldAsSuch) {
  ColaEmulatorSettings settings;
  settings.binary = true;
  make(settings);
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("CoLa-B"), std::string::npos);
  EXPECT_NE(status.error().remedy.find("2111"), std::string::npos);
}

TEST_F(ColaScannerTest, ADeafScannerEndsWithAMessage) {
  make();
  emulator_->faults().silent = true;
  const Instant start = clock_.now();
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("does not answer"), std::string::npos);
  EXPECT_LT(secondsOf(clock_.now() - start), 70.0);
}

TEST_F(ColaScannerTest, PassingFaultsAreGotOver) {
  for (const char* fault : {"split=0.3", "merge=0.06", "noise=3", "cut-telegram=2", "miss-request=1"}) {
    SCOPED_TRACE(fault);
    make();
    ASSERT_TRUE(emulator_->applyFault(fault));
    const Status prepared = unit_->prepare({});
    ASSERT_TRUE(prepared) << prepared.error().what;
    ASSERT_TRUE(emulator_->applyFault(fault));
    for (int i = 0; i < 20; ++i) {
      const auto taken = line();
      ASSERT_TRUE(taken) << taken.error().what;
      for (const float range : taken->range_m) ASSERT_EQ(range, 5.0F);
    }
  }
}

TEST_F(ColaScannerTest, ALostConnectionIsToldAndPreparingAgainMendsIt) {
  make();
  ASSERT_TRUE(unit_->prepare({}));
  pair_.unplug();
  const auto failed = line();
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().what.find("connection"), std::string::npos);
  ASSERT_TRUE(unit_->prepare({}));
  EXPECT_TRUE(line());
}

TEST_F(ColaScannerTest, WhatTheDeviceReportsIsTold) {
  make();
  emulator_->faults().dirty_window = true;
  ASSERT_TRUE(unit_->prepare({}));
  ASSERT_TRUE(line());
  ASSERT_TRUE(line());
  const auto warnings = unit_->takeWarnings();
  ASSERT_EQ(warnings.size(), 1U) << "once";
  EXPECT_NE(warnings.front().find("window"), std::string::npos);
  emulator_->faults().dazzled = true;
  ASSERT_TRUE(line());
  ASSERT_TRUE(line());
  EXPECT_EQ(line()->code[5], cell_code::kLmsDazzled);
}

TEST_F(ColaScannerTest, ItSaysWhatItIs) {
  make();
  const auto identity = unit_->identify({});
  ASSERT_TRUE(identity) << identity.error().what;
  EXPECT_NE(identity->device.find("LMS111 V1.30"), std::string::npos) << identity->device;
  EXPECT_EQ(identity->state, 7);
  EXPECT_EQ(identity->setting, cola::ScanSetting{});
}

TEST_F(ColaScannerTest, PreparingCanBeCancelled) {
  ColaEmulatorSettings settings;
  settings.timing.booted = false;
  settings.timing.boot_s = 50.0;
  make(settings);
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  job.report = [&](const Progress& progress) {
    if (progress.message.find("not answer") != std::string::npos) source.request_stop();
  };
  const Instant start = clock_.now();
  const Status status = unit_->prepare(job);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  EXPECT_LT(secondsOf(clock_.now() - start), 10.0);
}

}  // namespace
}  // namespace tiltmap
