// Sweeps at a stop of the simulated site with other makes of scanner and tilt unit, drivers against
// emulators.
#include <gtest/gtest.h>

#include "core/world/experiment.h"
#include "hardware/capture/instruments.h"
#include "tests/support/captured_lines.h"

namespace tiltmap {
namespace {

class ModelsTest : public ::testing::Test {
 protected:
  void make(const char* tilt, int rows, double speed = 0.0) {
    rows_ = rows;
    sweep_.reset();
    ASSERT_TRUE(settings_.chooseTilt(tilt));
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings_, speed);
    SweepSettings settings;
    settings.patience_s = 120.0 * std::max(1.0, speed);
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), settings);
    lines_.clear();
    after_ = {};
  }
  Result<SweepReport> run() {
    if (Status status = sweep_->prepare({}); !status) return fail(status.error());
    geometry_ = sweep_->geometry(rows_, settings_.start_rad, settings_.step_rad);
    return sweep_->run(geometry_, std::vector<bool>(static_cast<std::size_t>(rows_), false),
                       [this](int row, ScanLine line) {
                         EXPECT_FALSE(lines_.contains(row)) << "never twice";
                         lines_[row] = std::move(line);
                         if (after_) after_(row);
                         std::promise<Status> promise;
                         promise.set_value({});
                         return promise.get_future();
                       },
                       {});
  }
  void expectTrueLines() {
    EXPECT_EQ(lines_.size(), static_cast<std::size_t>(rows_));
    for (const auto& [row, line] : lines_) {
      ASSERT_EQ(line.range_m.size(), static_cast<std::size_t>(geometry_.columns));
      EXPECT_NEAR(line.tilt_rad, geometry_.tiltOfRow(row), test::kTiltToleranceRad) << row;
      EXPECT_EQ(test::differsFromSite(bench_->rig().view(), geometry_, line.tilt_rad, line.range_m.data(),
                                      line.code.data()),
                "")
          << "row " << row;
    }
  }

  RigSettings settings_;
  int rows_ = 0;
  std::unique_ptr<EmulatedBench> bench_;
  std::unique_ptr<Sweep> sweep_;
  ScannerGeometry geometry_;
  std::map<int, ScanLine> lines_;
  std::function<void(int)> after_;
};

TEST_F(ModelsTest, AWholeScanWithEachTiltUnit) {
  for (const auto& [model, most_s] : {std::pair{"epos", 25.0}, {"epos-usb", 25.0}, {"epos-v1", 45.0}}) {
    SCOPED_TRACE(model);
    settings_ = {};
    make(model, 101);
    const auto report = run();
    ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
    EXPECT_EQ(report->taken, 101);
    EXPECT_EQ(report->spoiled, 0);
    EXPECT_EQ(report->recoveries, 0);
    EXPECT_TRUE(report->warnings.empty()) << report->warnings.front();
    EXPECT_LT(report->duration_s, most_s) << "emulated time";
    expectTrueLines();
    RecordProperty(std::string(model) + " seconds", std::to_string(report->duration_s));
  }
}

TEST_F(ModelsTest, FaultsOfTheTiltUnitLoseNothing) {
  for (const char* model : {"epos", "epos-v1"}) {
    for (const auto& [fault, interrupts] : {std::pair{"motor-stall", true},
                                            {"follow-error", true},
                                            {"lost-steps", false},
                                            {"tilt-late-reply", false},
                                            {"tilt-lost-acknowledge", false},
                                            {"tilt-lost-byte", false},
                                            {"tilt-flipped-byte", false},
                                            {"tilt-inserted-byte", false},
                                            {"tilt-lost-command-byte", false},
                                            {"tilt-flipped-command-byte", false},
                                            {"tilt-refused-frame", false},
                                            {"tilt-power-cut", true}}) {
      SCOPED_TRACE(std::string(model) + " " + fault);
      settings_ = {};
      make(model, 10);
      after_ = [&, name = fault](int row) {
        if (row == 4) {
          EXPECT_TRUE(bench_->fault(name));
        }
      };
      const auto report = run();
      ASSERT_TRUE(report) << report.error().what << " / " << report.error().remedy;
      expectTrueLines();
      EXPECT_EQ(report->recoveries > 0, interrupts);
    }
  }
}

// Through the real serial port class, the emulators on a thread of their own, both plugs pulled.
TEST_F(ModelsTest, AnEposOverPseudoTerminals) {
  make("epos", 4, 4.0);
  after_ = [&](int row) {
    if (row == 1) bench_->unplug();
  };
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_GE(report->recoveries, 1);
  expectTrueLines();
}

TEST(ModelNames, EveryFaultOfEveryRigIsKnownToIt) {
  for (const std::string& tilt : RigSettings::tiltModels()) {
    RigSettings settings;
    ASSERT_TRUE(settings.chooseTilt(tilt));
    auto bench = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 1), settings, 0.0);
    for (const std::string& name : bench->rig().faultNames()) EXPECT_TRUE(bench->fault(name)) << name;
    EXPECT_FALSE(bench->fault("nonsense"));
  }
  RigSettings settings;
  EXPECT_FALSE(settings.chooseTilt("mip51"));
}

}  // namespace
}  // namespace tiltmap
