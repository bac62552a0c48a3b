// The driver against the emulated scanner, on a clock that costs nothing.
#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/emulator/scip_emulator.h"
#include "hardware/scip/scip_scanner_unit.h"
#include "hardware/transport/memory_channel.h"
#include "support/captured_lines.h"

namespace tiltmap {
namespace {

class ScipScannerTest : public ::testing::Test {
 protected:
  void make(ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx(), ScipSettings wanted = {}) {
    TearDown();
    emulator_ = std::make_unique<ScipEmulator>(clock_, view_, settings);
    emulator_->onLine([this](const auto& line) { sent_.push_back(line); });
    clock_.attach(*emulator_);
    unit_ = std::make_unique<ScipScannerUnit>(
        [this, network = settings.network]() -> Result<std::unique_ptr<ByteChannel>> {
          pair_ = MemoryPair::make(clock_, "test", network ? Pacing::None : Pacing::Baud);
          if (network) {
            if (Status status = pair_.host->setLine({100'000'000, Parity::None}); !status)
              return fail(status.error());
          }
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
  void expectLine() {
    const auto taken = line();
    ASSERT_TRUE(taken) << taken.error().what;
    for (const float range : taken->range_m) ASSERT_EQ(range, 5.0F);
  }

  VirtualClock clock_;
  RoundView view_{5.0F};
  std::vector<LineScannerEmulator::SentLine> sent_;
  MemoryPair pair_;
  std::unique_ptr<ScipEmulator> emulator_;
  std::unique_ptr<ScipScannerUnit> unit_;
};

TEST_F(ScipScannerTest, SendsLinesOfItsFieldOfView) {
  struct Case {
    ScipEmulatorSettings settings;
    int columns;
    double start_deg, step_deg;
  };
  for (const Case& each : {Case{ScipEmulatorSettings::urg04lx(), 682, 90.0 - 340 * 0.3515625, 0.3515625},
                           Case{ScipEmulatorSettings::utm30lx(), 1081, -45.0, 0.25},
                           Case{ScipEmulatorSettings::utm30lxEw(), 1081, -45.0, 0.25}}) {
    SCOPED_TRACE(each.settings.product);
    make(each.settings, {.bauds = {}, .intensities = each.settings.intensities});
    const Status prepared = unit_->prepare({});
    ASSERT_TRUE(prepared) << prepared.error().what << " / " << prepared.error().remedy;
    EXPECT_EQ(unit_->columns(), each.columns);
    EXPECT_NEAR(unit_->azimuthStart() / kDegree, each.start_deg, 1e-9);
    EXPECT_NEAR(unit_->azimuthStep() / kDegree, each.step_deg, 1e-9);
    EXPECT_NE(unit_->name().find(each.settings.product), std::string::npos);
    const auto taken = line();
    ASSERT_TRUE(taken);
    ASSERT_EQ(taken->range_m.size(), static_cast<std::size_t>(each.columns));
    EXPECT_EQ(taken->range_m[7], 5.0F);
    EXPECT_EQ(taken->code[7], cell_code::kMeasured);
    EXPECT_EQ(taken->intensity.size(), each.settings.intensities ? taken->range_m.size() : 0U);
    if (!taken->intensity.empty()) {
      EXPECT_EQ(taken->intensity[7], 100.0F);
    }
    const Instant before = clock_.now();
    EXPECT_TRUE(unit_->prepare({}));
    EXPECT_EQ(clock_.now(), before) << "ready already";
    EXPECT_TRUE(unit_->release());
    EXPECT_FALSE(emulator_->laserOn());
  }
}

TEST_F(ScipScannerTest, IsFoundAtItsRate) {
  for (const int baud : {19200, 38400, 115200}) {
    ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx();
    settings.baud = baud;
    make(settings);
    const Status prepared = unit_->prepare({});
    ASSERT_TRUE(prepared) << prepared.error().what;
    expectLine();
  }
  ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx();
  settings.baud = 57600;
  make(settings);
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("no Hokuyo scanner answers"), std::string::npos);
  EXPECT_NE(status.error().remedy.find("38400"), std::string::npos);
  make(settings, {.bauds = {57600}});
  EXPECT_TRUE(unit_->prepare({}));
}

TEST_F(ScipScannerTest, LinesAreAsOldAsTheyAre) {
  for (const int baud : {0, 115200}) {
    SCOPED_TRACE(baud);
    ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx();
    settings.baud = baud;
    make(settings);
    sent_.clear();
    ASSERT_TRUE(unit_->prepare({}));
    for (int i = 0; i < 30; ++i) {
      emulator_->faults().merge_s = i % 7 == 3 ? 0.09 : 0.0;
      const auto taken = line();
      ASSERT_TRUE(taken);
      const bool fits = std::ranges::any_of(sent_, [&](const auto& one) {
        return one.from >= taken->measured.from && one.to <= taken->measured.to;
      });
      EXPECT_TRUE(fits) << i;
      EXPECT_LT(secondsOf(taken->measured.to - taken->measured.from), 0.21);
    }
  }
}

TEST_F(ScipScannerTest, OddFirmwareIsUnderstood) {
  ScipEmulatorSettings settings = ScipEmulatorSettings::urg04lx();
  settings.old_firmware = true;
  settings.other_check = true;
  make(settings);
  ASSERT_TRUE(unit_->prepare({}));
  expectLine();
}

TEST_F(ScipScannerTest, AStreamThatSomebodyLeftRunningIsEnded) {
  make();
  ASSERT_TRUE(unit_->prepare({}));
  expectLine();
  // Another driver comes; the plug was pulled, so that nobody ended the stream.
  unit_ = std::make_unique<ScipScannerUnit>(
      [this]() -> Result<std::unique_ptr<ByteChannel>> {
        pair_ = MemoryPair::make(clock_, "test");
        emulator_->plug(pair_.device.get());
        return std::move(pair_.host);
      },
      clock_, ScipSettings{});
  clock_.sleepFor(durationOf(1.0));
  ASSERT_TRUE(unit_->prepare({}));
  expectLine();
}

TEST_F(ScipScannerTest, PassingFaultsAreGotOver) {
  for (const char* fault :
       {"lose-byte=0.0005", "flip-bit=0.0005", "duplicate-byte=0.0005", "insert-byte=0.0005", "split=0.3",
        "merge=0.06", "noise=3", "cut-telegram=2", "miss-request=1"}) {
    SCOPED_TRACE(fault);
    make();
    ASSERT_TRUE(emulator_->applyFault(fault));
    const Status prepared = unit_->prepare({});
    ASSERT_TRUE(prepared) << prepared.error().what;
    ASSERT_TRUE(emulator_->applyFault(fault));
    for (int i = 0; i < 20; ++i) expectLine();
  }
}

TEST_F(ScipScannerTest, WhatHasNoRangeSaysWhy) {
  make();
  ASSERT_TRUE(unit_->prepare({}));
  emulator_->faults().dazzled = true;
  ASSERT_TRUE(line());
  ASSERT_TRUE(line());
  EXPECT_EQ(line()->code[5], cell_code::kMissing);
}

TEST_F(ScipScannerTest, ALostPlugIsToldAndPreparingAgainMendsIt) {
  make();
  ASSERT_TRUE(unit_->prepare({}));
  pair_.unplug();
  const auto failed = line();
  ASSERT_FALSE(failed);
  ASSERT_TRUE(unit_->prepare({}));
  expectLine();
}

TEST_F(ScipScannerTest, IntensitiesThatItDoesNotHaveAreToldAsSuch) {
  make(ScipEmulatorSettings::urg04lx(), {.bauds = {}, .intensities = true});
  const Status status = unit_->prepare({});
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().remedy.find("intensit"), std::string::npos);
}

TEST_F(ScipScannerTest, ItSaysWhatItIsWithoutMeasuring) {
  make(ScipEmulatorSettings::utm30lx());
  const auto identity = unit_->identify({});
  ASSERT_TRUE(identity) << identity.error().what;
  EXPECT_EQ(identity->parameters, ScipEmulatorSettings::utm30lx().parameters);
  EXPECT_EQ(scip::property(identity->version, "FIRM"), "3.3.00");
  EXPECT_FALSE(emulator_->laserOn());
}

TEST_F(ScipScannerTest, PreparingCanBeCancelled) {
  make();
  emulator_->faults().silent = true;
  std::stop_source source;
  source.request_stop();
  JobControl job;
  job.stop = source.get_token();
  const Instant start = clock_.now();
  const Status status = unit_->prepare(job);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().what, kCancelled);
  EXPECT_LT(secondsOf(clock_.now() - start), 0.1);
}

// The emulator by itself, as any client finds it.
class ScipEmulatorTest : public ScipScannerTest {
 protected:
  void SetUp() override {
    make();
    pair_ = MemoryPair::make(clock_, "test", Pacing::None);
    emulator_->plug(pair_.device.get());
  }
  std::string said(const std::string& command, double wait_s = 0.05) {
    const std::string line = command + "\n";
    EXPECT_TRUE(pair_.host->write({reinterpret_cast<const Byte*>(line.data()), line.size()}));
    clock_.sleepFor(durationOf(wait_s));
    std::string all;
    std::array<Byte, 4096> buffer;
    while (true) {
      const auto count = pair_.host->read(buffer, clock_.now());
      if (!count || *count == 0) return all;
      all.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
    }
  }
};

TEST_F(ScipEmulatorTest, AnswersAsItShould) {
  EXPECT_EQ(said("QT"), "QT\n00P\n\n");
  EXPECT_EQ(said("GD0044072501").substr(0, 17), "GD0044072501\n10Q\n") << "the laser is off";
  EXPECT_EQ(said("BM"), "BM\n00P\n\n");
  EXPECT_EQ(said("BM"), "BM\n02R\n\n");
  EXPECT_EQ(said("XX"), "XX\n0Ee\n\n");
  EXPECT_EQ(said("TM0"), "TM0\n00P\n\n");
  EXPECT_EQ(said("QT"), "QT\n0Ee\n\n") << "it adjusts its clock";
  EXPECT_EQ(said("TM2"), "TM2\n00P\n\n");
  EXPECT_NE(said("PP").find("\nDMAX:5600;_\n"), std::string::npos);
  EXPECT_EQ(said("MD0000072501000"), "MD0000072501000\n04T\n\n") << "the first step is 44";
  EXPECT_NE(said("GD0044072501").find("GD0044072501\n00P\n"), std::string::npos);
  EXPECT_NE(said("GS0044072501").find("GS0044072501\n00P\n"), std::string::npos);
}

TEST_F(ScipEmulatorTest, AStreamOfThreeCountsThem) {
  const std::string text = said("MD0044072501003", 2.0);
  EXPECT_EQ(text.find("MD0044072501003\n00P\n\n"), 0U);
  for (const char* echo : {"MD0044072501002\n99b\n", "MD0044072501001\n99b\n", "MD0044072501000\n99b\n"})
    EXPECT_NE(text.find(echo), std::string::npos) << echo;
  EXPECT_EQ(said("II").find("II\n00P\n"), 0U) << "and then no more";
}

}  // namespace
}  // namespace tiltmap
