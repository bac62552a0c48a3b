// Sweeps at a stop of the simulated site with other makes of scanner and tilt unit, drivers against
// emulators.
#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "core/world/experiment.h"
#include "hardware/capture/instruments.h"
#include "tests/support/captured_lines.h"

namespace tiltmap {
namespace {

class ModelsTest : public ::testing::Test {
 protected:
  // As makeWith(), with the scanner of the thesis.
  void make(const char* tilt, int rows, double speed = 0.0) { makeWith("lms291", tilt, rows, speed); }
  void makeWith(const char* scanner, const char* tilt, int rows, double speed = 0.0) {
    ASSERT_TRUE(settings_.chooseScanner(scanner));
    rows_ = rows;
    sweep_.reset();
    ASSERT_TRUE(settings_.chooseTilt(tilt));
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings_, speed);
    SweepOptions settings;
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

// Of scanners with codes of their own: ranges as the site gives them, and nothing where it gives nothing.
std::string differs(const RigView& view, const ScannerGeometry& geometry, const ScanLine& line) {
  const std::vector<Echo> truth = view.truth(geometry, line.tilt_rad);
  for (std::size_t j = 0; j < truth.size(); ++j) {
    const bool point = cell_code::hasPoint(truth[j].code);
    const bool same =
        point ? line.code[j] == cell_code::kMeasured && std::abs(line.range_m[j] - truth[j].range_m) < 1e-4F
              : !cell_code::hasPoint(line.code[j]) && line.range_m[j] == 0.0F &&
                    cell_code::isFar(truth[j].code) <= cell_code::isFar(line.code[j]);
    if (!same)
      return "beam " + std::to_string(j) + " has " + std::to_string(line.range_m[j]) + " m, code " +
             std::to_string(line.code[j]) + " instead of " + std::to_string(truth[j].range_m) + " m, code " +
             std::to_string(truth[j].code);
  }
  return {};
}

struct ScannerCase {
  const char* model;
  int columns;
  double start_deg, step_deg;
  int ahead;  // the beam that looks straight ahead
  int share;  // more than one beam in so many meets something; the URG reaches 4 m
};
constexpr ScannerCase kScanners[] = {{"lms111", 541, -45.0, 0.5, 270, 4},
                                     {"lms511", 381, -5.0, 0.5, 190, 4},
                                     {"urg04lx", 682, 90.0 - 340.0 * 360.0 / 1024.0, 360.0 / 1024.0, 340, 10},
                                     {"utm30lx", 1081, -45.0, 0.25, 540, 4},
                                     {"utm30lx-ew", 1081, -45.0, 0.25, 540, 4}};

TEST_F(ModelsTest, EveryScannerBringsTheSitesOwnLines) {
  for (const ScannerCase& each : kScanners) {
    SCOPED_TRACE(each.model);
    settings_ = {};
    makeWith(each.model, "epos", 8);
    const auto report = run();
    ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
    EXPECT_EQ(report->taken, 8);
    EXPECT_EQ(report->spoiled, 0);
    EXPECT_EQ(report->recoveries, 0);
    EXPECT_TRUE(report->warnings.empty()) << report->warnings.front();
    EXPECT_EQ(geometry_.columns, each.columns);
    EXPECT_NEAR(geometry_.azimuth_start_rad / kDegree, each.start_deg, 1e-9);
    EXPECT_NEAR(geometry_.azimuth_step_rad / kDegree, each.step_deg, 1e-9);
    EXPECT_NEAR(geometry_.azimuthOfColumn(each.ahead) / kDegree, 90.0, 1e-9);
    ASSERT_EQ(lines_.size(), 8U);
    for (const auto& [row, line] : lines_) {
      EXPECT_NEAR(line.tilt_rad, geometry_.tiltOfRow(row), test::kTiltToleranceRad);
      EXPECT_EQ(differs(bench_->rig().view(), geometry_, line), "") << "row " << row;
      EXPECT_GT(std::ranges::count(line.code, cell_code::kMeasured), each.columns / each.share)
          << "row " << row;
    }
  }
}

// Where the beams go, without asking any geometry: what stands where by the scanner of the thesis stands
// there by the others too. Numbers of beams are by hand.
TEST_F(ModelsTest, EveryScannerSeesThingsWhereTheyAre) {
  const auto lineOf = [this](const char* model) {
    settings_ = {};
    settings_.start_rad = 0.0;
    makeWith(model, "mip50", 1);
    EXPECT_TRUE(run());
    return lines_[0];
  };
  const ScanLine old = lineOf("lms291");
  for (const auto& [model, first, step] :
       {std::tuple{"lms111", 90, 1}, {"lms511", 10, 1}, {"utm30lx", 180, 2}}) {
    const ScanLine line = lineOf(model);
    int both = 0, same = 0, mirrored = 0;
    for (int k = 0; k <= 360; ++k) {
      const auto here = static_cast<std::size_t>(first + step * k), there = static_cast<std::size_t>(k);
      if (line.code[here] != cell_code::kMeasured || old.code[there] != cell_code::kMeasured) continue;
      ++both;
      same += std::abs(line.range_m[here] - old.range_m[there]) < 0.15F ? 1 : 0;
      mirrored += std::abs(line.range_m[here] - old.range_m[360 - there]) < 0.15F ? 1 : 0;
    }
    EXPECT_GT(both, 40) << model;
    EXPECT_GT(same, 0.85 * both) << model;
    EXPECT_LT(mirrored, 0.5 * both) << model;
  }
}

TEST_F(ModelsTest, FaultsOfTheScannersLoseNothing) {
  for (const auto& [model, faults] :
       {std::pair<const char*, std::vector<const char*>>{
            "lms111", {"split", "merge", "noise=3", "cut-telegram=2", "hang-up", "power-cut=3"}},
        {"urg04lx", {"lose-byte", "flip-bit", "insert-byte", "cut-telegram=2", "power-cut=3"}}})
    for (const char* fault : faults) {
      SCOPED_TRACE(std::string(model) + " " + fault);
      settings_ = {};
      makeWith(model, "mip50", 7);
      after_ = [&](int row) {
        if (row == 3) {
          EXPECT_TRUE(bench_->fault(fault));
        }
        if (row == 5 && std::string(fault).find("power") == std::string::npos) {
          EXPECT_TRUE(bench_->fault("none"));
        }
      };
      const auto report = run();
      ASSERT_TRUE(report) << report.error().what << " / " << report.error().remedy;
      ASSERT_EQ(lines_.size(), 7U);
      for (const auto& [row, line] : lines_)
        EXPECT_EQ(differs(bench_->rig().view(), geometry_, line), "") << "row " << row;
    }
}

// Through real connections: TCP and pseudo terminals, plugs pulled.
TEST_F(ModelsTest, ScannersOverTheirRealConnections) {
  for (const char* model : {"lms111", "urg04lx"}) {
    SCOPED_TRACE(model);
    settings_ = {};
    makeWith(model, "mip50", 3, 4.0);
    after_ = [&](int row) {
      if (row == 1) bench_->unplug();
    };
    const auto report = run();
    ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
    EXPECT_GE(report->recoveries, 1);
    ASSERT_EQ(lines_.size(), 3U);
    for (const auto& [row, line] : lines_)
      EXPECT_EQ(differs(bench_->rig().view(), geometry_, line), "") << "row " << row;
  }
}

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
  make("epos", 16,
       1.0);  // many and slow: a busy machine finds some of them waiting when the plugs are out already
  after_ = [&](int row) {
    if (row == 1) bench_->unplug();
  };
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_GE(report->recoveries, 1);
  expectTrueLines();
}

TEST(ModelNames, EveryFaultOfEveryRigIsKnownToIt) {
  std::vector<std::pair<std::string, std::string>> rigs;
  for (const std::string& tilt : RigSettings::tiltModels()) rigs.emplace_back("lms291", tilt);
  for (const std::string& scanner : RigSettings::scannerModels()) rigs.emplace_back(scanner, "mip50");
  for (const auto& [scanner, tilt] : rigs) {
    RigSettings settings;
    ASSERT_TRUE(settings.chooseScanner(scanner));
    ASSERT_TRUE(settings.chooseTilt(tilt));
    auto bench = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 1), settings, 0.0);
    for (const std::string& name : bench->rig().faultNames()) EXPECT_TRUE(bench->fault(name)) << name;
    EXPECT_FALSE(bench->fault("nonsense"));
  }
  RigSettings settings;
  EXPECT_FALSE(settings.chooseTilt("mip51"));
  EXPECT_FALSE(settings.chooseScanner("lms292"));
}

}  // namespace
}  // namespace tiltmap
