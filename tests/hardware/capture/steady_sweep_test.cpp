// Lines taken while the tilt moves on: the drivers against the emulated rig, which looks at the site at the
// instant of every beam.
#include <map>

#include <gtest/gtest.h>

#include "core/project/moving_line.h"
#include "core/scan/beam_tilts.h"
#include "hardware/capture/instruments.h"

namespace tiltmap {
namespace {

class SteadySweepTest : public ::testing::Test {
 protected:
  void make(int rows, int baud = 38400) {
    rows_ = rows;
    sweep_.reset();
    lines_.clear();
    sent_.clear();
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings_, 0.0, baud);
    // Where the tilt truly was at every beam of every line that was sent.
    auto& scanner = dynamic_cast<LmsEmulator&>(bench_->rig().scanner());
    scanner.onScan([this](const LmsEmulator::SentScan& scan) {
      Sent sent{scan.measurement.values, {}};
      ScannerGeometry geometry;
      for (int j = 0; j < 361; ++j)
        sent.tilt_rad.push_back(
            bench_->rig().tilt().angle(scan.measured_from + durationOf(beamDelay(geometry, {}, j))));
      sent_.push_back(std::move(sent));
    });
    SweepOptions sweep;
    sweep.steady = true;
    sweep.patience_s = 240.0;
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), sweep);
  }

  Result<SweepReport> run(const JobControl& job = {}) {
    if (Status status = sweep_->prepare({}); !status) return fail(status.error());
    geometry_ = sweep_->geometry(rows_, settings_.start_rad, settings_.step_rad);
    if (Status status = sweep_->check(geometry_); !status) return fail(status.error());
    std::vector<bool> taken(static_cast<std::size_t>(rows_), false);
    for (const auto& [row, line] : lines_) taken[static_cast<std::size_t>(row)] = true;
    return sweep_->run(
        geometry_, taken,
        [this](int row, ScanLine line) {
          EXPECT_FALSE(lines_.contains(row)) << "never twice";
          lines_[row] = std::move(line);
          std::promise<Status> promise;
          promise.set_value({});
          return promise.get_future();
        },
        job);
  }

  // Every stored line was sent, and each of its beams has the tilt it truly had.
  void expectTrueLines(double tolerance_deg) {
    double worst = 0.0;
    for (const auto& entry : lines_) {
      const int row = entry.first;
      const ScanLine& line = entry.second;
      const auto sent = std::ranges::find_if(sent_, [&](const Sent& one) {
        for (std::size_t j = 0; j < one.values.size(); ++j) {
          const auto value = lms2xx::decodeValue(one.values[j]);
          if (value.code != line.code[j]) return false;
          if (value.measured() &&
              std::abs(0.01 * value.distance - static_cast<double>(line.range_m[j])) > 1e-4)
            return false;
        }
        return true;
      });
      ASSERT_NE(sent, sent_.end()) << "row " << row << " was never sent";
      for (int j = 0; j < 361; ++j) {
        const double tilt = line.tilt_rad + turnTiltOf(line) * (beamTurns(geometry_, j) - 2.0);
        worst = std::max(worst, std::abs(tilt - sent->tilt_rad[static_cast<std::size_t>(j)]));
      }
      EXPECT_LT(worst / kDegree, tolerance_deg) << "row " << row << " of " << lines_.size() << ", sent as "
                                                << sent - sent_.begin() << " of " << sent_.size();
      // The middle of the line belongs to its row.
      EXPECT_NEAR(line.tilt_rad - turnTiltOf(line), geometry_.tiltOfRow(row), 0.52 * geometry_.tilt_step_rad);
      EXPECT_NE(turnTiltOf(line), 0.0);
    }
    EXPECT_LT(worst / kDegree, tolerance_deg);
    RecordProperty("worst_deg", std::to_string(worst / kDegree));
  }

  struct Sent {
    std::vector<std::uint16_t> values;
    std::vector<double> tilt_rad;
  };
  RigSettings settings_;
  int rows_ = 0;
  std::unique_ptr<EmulatedBench> bench_;
  std::unique_ptr<Sweep> sweep_;
  ScannerGeometry geometry_;
  std::map<int, ScanLine> lines_;
  std::vector<Sent> sent_;
};

// A motor of at most 120 counts/ms and 2 counts/ms2.
TEST_F(SteadySweepTest, AWholeScanTakesAtMost23SecondsAt38400Bd) {
  make(101);
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_EQ(report->taken, 101);
  EXPECT_EQ(report->recoveries, 0);
  EXPECT_TRUE(report->warnings.empty()) << report->warnings.front();
  EXPECT_LT(report->duration_s, 23.0);
  expectTrueLines(0.006);
  RecordProperty("seconds", std::to_string(report->duration_s));
  // The next stop begins where this one ended: below the first line.
  lines_.clear();
  ASSERT_TRUE(bench_->moveTo(1));
  const auto second = run();
  ASSERT_TRUE(second);
  EXPECT_LT(second->duration_s, 23.0);
  expectTrueLines(0.006);
}

TEST_F(SteadySweepTest, AWholeScanTakesAtMostSixAndAHalfSecondsAt500kBd) {
  make(101, 500000);
  for (int stop = 0; stop < 2; ++stop) {
    lines_.clear();
    ASSERT_TRUE(bench_->moveTo(stop));
    const auto report = run();
    ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
    EXPECT_EQ(report->taken, 101);
    EXPECT_LT(report->duration_s, 6.5);
    expectTrueLines(0.02);
    RecordProperty("seconds", std::to_string(report->duration_s));
  }
}

TEST_F(SteadySweepTest, LinesThatArriveDamagedAreTakenInAnotherPass) {
  make(25);
  ASSERT_TRUE(sweep_->prepare({}));
  ASSERT_TRUE(bench_->fault("flip-bit=0.0002"));
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(lines_.size(), 25U);
  expectTrueLines(0.006);
}

TEST_F(SteadySweepTest, WhatGoesWrongOnTheWayLosesNothing) {
  for (const char* fault :
       {"motor-stall", "follow-error", "lost-steps", "tilt-late-reply", "tilt-lost-acknowledge",
        "tilt-flipped-command-byte", "tilt-lost-byte", "power-cut=2", "tilt-power-cut", "unplug"}) {
    SCOPED_TRACE(fault);
    make(8);
    ASSERT_TRUE(sweep_->prepare({}));
    // In the middle of the move.
    class Later : public Actor {
     public:
      Later(Clock& clock, std::function<void()> then)
          : at_(clock.now() + durationOf(2.0)), then_(std::move(then)) {}
      Instant nextEvent() const override { return at_; }
      void act(Instant) override {
        at_ = kNever;
        then_();
      }

     private:
      Instant at_;
      std::function<void()> then_;
    };
    auto& clock = dynamic_cast<VirtualClock&>(bench_->clock());
    Later later(clock, [&] {
      if (std::string(fault) == "unplug")
        bench_->unplug();
      else
        EXPECT_TRUE(bench_->fault(fault));
    });
    clock.attach(later);
    const auto report = run();
    clock.detach(later);
    ASSERT_TRUE(report) << report.error().what << " / " << report.error().remedy;
    EXPECT_EQ(lines_.size(), 8U);
    expectTrueLines(0.06);
  }
}

TEST_F(SteadySweepTest, StoppingStopsTheTiltAndWhatIsMissingIsTakenLater) {
  make(30);
  ASSERT_TRUE(sweep_->prepare({}));
  std::stop_source source;
  JobControl job;
  job.stop = source.get_token();
  class Later : public Actor {
   public:
    Later(Instant at, std::stop_source& source) : at_(at), source_(source) {}
    Instant nextEvent() const override { return at_; }
    void act(Instant) override {
      at_ = kNever;
      source_.request_stop();
    }

   private:
    Instant at_;
    std::stop_source& source_;
  };
  auto& clock = dynamic_cast<VirtualClock&>(bench_->clock());
  Later later(clock.now() + durationOf(4.0), source);
  clock.attach(later);
  const auto report = run(job);
  clock.detach(later);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().what, kCancelled);
  clock.sleepFor(durationOf(0.2));
  const double there = bench_->rig().tilt().angle(clock.now());
  clock.sleepFor(durationOf(0.5));
  EXPECT_EQ(bench_->rig().tilt().angle(clock.now()), there);
  ASSERT_TRUE(run());
  EXPECT_EQ(lines_.size(), 30U);
  expectTrueLines(0.006);
}

TEST_F(SteadySweepTest, LinesTheTiltCannotPassAreRefusedBeforeItMoves) {
  settings_.start_rad = -44.0 * kDegree;
  make(10);
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().what.find("begins below the first line"), std::string::npos)
      << report.error().what;
  settings_.start_rad = -30.0 * kDegree;
  settings_.step_rad = -0.8 * kDegree;
  make(10);
  EXPECT_FALSE(run());
}

}  // namespace
}  // namespace tiltmap
