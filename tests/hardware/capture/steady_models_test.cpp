// Lines taken while the tilt moves on, with other makes of scanner and tilt unit: every beam is held against
// the tilt that the emulated rig truly had when it was fired.
#include <iostream>
#include <map>

#include <gtest/gtest.h>

#include "core/project/moving_line.h"
#include "core/scan/beam_tilts.h"
#include "hardware/capture/instruments.h"

namespace tiltmap {
namespace {

constexpr int kToTell = 20;

struct Rig {
  const char* scanner;
  const char* tilt;
  double most_off_deg;  // any beam of any line
  double most_s;        // of 101 lines
};

void PrintTo(const Rig& rig, std::ostream* out) {
  *out << rig.scanner << " on " << rig.tilt;
}

class SteadyModels : public ::testing::TestWithParam<Rig> {
 protected:
  void make(int rows, const char* fault = nullptr) {
    ASSERT_TRUE(settings_.chooseScanner(GetParam().scanner));
    ASSERT_TRUE(settings_.chooseTilt(GetParam().tilt));
    rows_ = rows;
    lines_.clear();
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings_, 0.0);
    if (auto* scanner = dynamic_cast<LineScannerEmulator*>(&bench_->rig().scanner()))
      scanner->onLine([this](const LineScannerEmulator::SentLine& line) { keep(line.from, line.echoes); });
    SweepOptions options;
    options.steady = true;
    options.patience_s = 240.0;
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), options);
    ASSERT_TRUE(sweep_->prepare({}));
    geometry_ = sweep_->geometry(rows_, settings_.start_rad, settings_.step_rad);
    if (fault) {
      ASSERT_TRUE(bench_->fault(fault));
    }
  }
  // The motor remembers some seconds; where it was is looked up at once.
  void keep(Instant from, const std::vector<Echo>& echoes) {
    Sent sent{{}, {}};
    ScannerGeometry fan = geometry_;
    for (std::size_t j = 0; j < echoes.size(); ++j) {
      sent.range_m.push_back(cell_code::hasPoint(echoes[j].code) ? echoes[j].range_m : 0.0F);
      sent.tilt_rad.push_back(
          bench_->rig().tilt().angle(from + durationOf(beamDelay(fan, settings_.beam, static_cast<int>(j)))));
    }
    sent_.push_back(std::move(sent));
  }
  Result<SweepReport> run() {
    if (Status status = sweep_->check(geometry_); !status) return fail(status.error());
    return sweep_->run(geometry_, std::vector<bool>(static_cast<std::size_t>(rows_), false),
                       [this](int row, ScanLine line) {
                         EXPECT_FALSE(lines_.contains(row)) << "never twice";
                         lines_[row] = std::move(line);
                         std::promise<Status> promise;
                         promise.set_value({});
                         return promise.get_future();
                       },
                       {});
  }
  struct Sent {
    std::vector<float> range_m;
    std::vector<double> tilt_rad;
  };
  const Sent* sentAs(const ScanLine& line) const {
    const auto same = [&](const Sent& sent) {
      int compared = 0, alike = 0;
      for (std::size_t j = 0; j < sent.range_m.size(); ++j) {
        if (line.code[j] != cell_code::kMeasured) continue;
        ++compared;
        alike += std::abs(sent.range_m[j] - line.range_m[j]) < 0.0005F ? 1 : 0;
      }
      return compared > kToTell && alike == compared;
    };
    const auto found = std::ranges::find_if(sent_, same);
    return found == sent_.end() ? nullptr : &*found;
  }
  // The largest error of any beam of any line, and that without the correction, degrees.
  std::pair<double, double> worst() {
    double with = 0.0, without = 0.0;
    for (const auto& [row, line] : lines_) {
      // Where hardly a beam meets anything (the URG reaches 4 m) lines cannot be told apart.
      if (std::ranges::count(line.code, cell_code::kMeasured) <= kToTell) continue;
      ++told_;
      const Sent* sent = sentAs(line);
      EXPECT_NE(sent, nullptr) << "row " << row << " was never sent so";
      if (!sent) continue;
      const double turns = mirrorTurns(geometry_), middle = line.tilt_rad - 0.5 * turns * turnTiltOf(line);
      EXPECT_NE(turnTiltOf(line), 0.0);
      EXPECT_NEAR(middle, geometry_.tiltOfRow(row), 0.52 * geometry_.tilt_step_rad);
      for (std::size_t j = 0; j < sent->tilt_rad.size(); ++j) {
        const double tilt =
            line.tilt_rad + turnTiltOf(line) * (beamTurns(geometry_, static_cast<int>(j)) - turns);
        with = std::max(with, std::abs(tilt - sent->tilt_rad[j]) / kDegree);
        without = std::max(without, std::abs(middle - sent->tilt_rad[j]) / kDegree);
      }
    }
    return {with, without};
  }

  RigSettings settings_;
  int rows_ = 0;
  std::unique_ptr<EmulatedBench> bench_;
  std::unique_ptr<Sweep> sweep_;
  ScannerGeometry geometry_;
  std::map<int, ScanLine> lines_;
  std::vector<Sent> sent_;
  int told_ = 0;
};

TEST_P(SteadyModels, AWholeScanHasEveryBeamAtItsOwnTilt) {
  make(101);
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_EQ(report->taken, 101);
  EXPECT_EQ(report->recoveries, 0);
  EXPECT_TRUE(report->warnings.empty()) << report->warnings.front();
  EXPECT_LT(report->duration_s, GetParam().most_s) << "emulated time";
  const auto [with, without] = worst();
  EXPECT_GT(told_, 40) << "lines that were compared";
  EXPECT_LT(with, GetParam().most_off_deg);
  std::cout << GetParam().scanner << " on " << GetParam().tilt << ": " << report->duration_s
            << " s; beams at most " << with << " deg off, " << without
            << " deg with the correction switched off\n";
  EXPECT_GT(without, 2.0 * with);
}

class SteadyModelFaults : public SteadyModels {};

TEST_P(SteadyModelFaults, LoseNoLineAndPlaceNoneWrongly) {
  for (const char* fault : {"motor-stall", "lost-steps", "tilt-late-reply", "power-cut=2"}) {
    SCOPED_TRACE(fault);
    sent_.clear();
    make(8, fault);
    const auto report = run();
    ASSERT_TRUE(report) << report.error().what << " / " << report.error().remedy;
    EXPECT_EQ(lines_.size(), 8U);
    EXPECT_LT(worst().first, GetParam().most_off_deg + 0.06);
  }
}

std::string nameOf(const ::testing::TestParamInfo<Rig>& info) {
  std::string name = std::string(info.param.scanner) + "_" + info.param.tilt;
  std::ranges::replace(name, '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    Rigs, SteadyModels,
    ::testing::Values(Rig{"lms111", "mip50", 0.07, 7.0}, Rig{"lms511", "mip50", 0.07, 7.0},
                      Rig{"utm30lx", "mip50", 0.12, 7.0}, Rig{"utm30lx-ew", "mip50", 0.12, 7.0},
                      Rig{"urg04lx", "mip50", 0.12, 40.0}, Rig{"lms111", "epos", 0.07, 7.0},
                      Rig{"lms111", "epos-v1", 0.07, 7.5}, Rig{"utm30lx", "epos-usb", 0.12, 7.0}),
    nameOf);
INSTANTIATE_TEST_SUITE_P(Rigs, SteadyModelFaults,
                         ::testing::Values(Rig{"lms111", "epos", 0.07, 7.0},
                                           Rig{"utm30lx", "mip50", 0.12, 7.0}),
                         nameOf);

// The scanner of the thesis on a newer controller.
class SteadyEpos : public ::testing::Test {
 protected:
  Result<SweepReport> run(RigSettings& settings, const char* tilt) {
    if (Status status = settings.chooseTilt(tilt); !status) return fail(status.error());
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings, 0.0, 500000);
    SweepOptions options;
    options.steady = true;
    Sweep sweep(bench_->instruments(), options);
    if (Status status = sweep.prepare({}); !status) return fail(status.error());
    const ScannerGeometry geometry = sweep.geometry(101, settings.start_rad, settings.step_rad);
    if (Status status = sweep.check(geometry); !status) return fail(status.error());
    return sweep.run(geometry, std::vector<bool>(101, false),
                     [this](int, ScanLine line) {
                       moved_ += turnTiltOf(line) != 0.0 ? 1 : 0;
                       std::promise<Status> promise;
                       promise.set_value({});
                       return promise.get_future();
                     },
                     {});
  }
  std::unique_ptr<EmulatedBench> bench_;
  int moved_ = 0;
};

TEST_F(SteadyEpos, TakesTheThesisScannerAsFastAsTheMip50Does) {
  RigSettings settings;
  const auto report = run(settings, "epos");
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_EQ(moved_, 101);
  EXPECT_LT(report->duration_s, 6.5);
  std::cout << "lms291 at 500000 Bd on epos: " << report->duration_s << " s\n";
}

// Cut to half a circle its beams would be taken for interlaced ones of an LMS 2xx.
TEST(SteadyModelsRefused, AFanThatWouldBeMistakenIsRefusedInWords) {
  RigSettings settings;
  ASSERT_TRUE(settings.chooseScanner("lms111"));
  settings.cola.setting.start = 0;
  settings.cola.setting.end = 1800000;
  auto bench = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings, 0.0);
  SweepOptions options;
  options.steady = true;
  Sweep sweep(bench->instruments(), options);
  ASSERT_TRUE(sweep.prepare({}));
  const Status refused = sweep.check(sweep.geometry(20, settings.start_rad, settings.step_rad));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("--mode stop"), std::string::npos) << refused.error().what;
}

}  // namespace
}  // namespace tiltmap
