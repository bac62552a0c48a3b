// The drivers of both instruments against both emulators: sweeps at a stop of a simulated site.
#include <gtest/gtest.h>

#include "core/world/experiment.h"
#include "hardware/capture/instruments.h"
#include "tests/support/captured_lines.h"

namespace tiltmap {
namespace {

class RigCaptureTest : public ::testing::Test {
 protected:
  void make(int rows = 15, double speed = 0.0) {
    rows_ = rows;
    sweep_.reset();
    bench_ = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 3), settings_, speed);
    SweepOptions settings;
    settings.patience_s = 120.0 * std::max(1.0, speed);
    sweep_ = std::make_unique<Sweep>(bench_->instruments(), settings);
    lines_.clear();
  }

  Result<SweepReport> run(const std::vector<bool>& taken) {
    if (Status status = sweep_->prepare({}); !status) return fail(status.error());
    geometry_ = sweep_->geometry(rows_, settings_.start_rad, settings_.step_rad);
    return sweep_->run(geometry_, taken,
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
  Result<SweepReport> run() { return run(std::vector<bool>(static_cast<std::size_t>(rows_), false)); }

  void expectTrueLines() {
    for (const auto& [row, line] : lines_) {
      ASSERT_EQ(line.range_m.size(), 361U);
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

TEST_F(RigCaptureTest, AWholeScanIsTheSitesOwnAndTakesAtMost25Seconds) {
  make(101);
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_EQ(report->taken, 101);
  EXPECT_EQ(report->spoiled, 0);
  EXPECT_EQ(report->recoveries, 0);
  EXPECT_TRUE(report->warnings.empty()) << report->warnings.front();
  // Emulated time: a motor of 120 counts/ms, 2 counts/ms2 and 50 ms settling, 38400 Bd.
  EXPECT_LT(report->duration_s, 25.0);
  EXPECT_GT(report->duration_s, 100 * 0.1906) << "no faster than the wire";
  expectTrueLines();
  RecordProperty("seconds", std::to_string(report->duration_s));
}

TEST_F(RigCaptureTest, ASecondStopFollowsWithoutSearchingHome) {
  make(5);
  ASSERT_TRUE(run());
  expectTrueLines();
  lines_.clear();
  ASSERT_TRUE(bench_->moveTo(2));
  const auto report = run();
  ASSERT_TRUE(report);
  expectTrueLines();
  EXPECT_LT(report->duration_s, 3.0);
  EXPECT_FALSE(bench_->moveTo(5));
}

// A busy machine or an adapter that hands bytes over late: when a line began is known from the ones before.
TEST_F(RigCaptureTest, BytesInHeapsDoNotMakeTheTiltLeaveTooEarly) {
  make(30);
  after_ = [this](int row) {
    if (row == 2) {
      ASSERT_TRUE(bench_->fault("merge=0.05"));
    }
  };
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(report->taken, 30);
  EXPECT_LE(report->spoiled, 2);
  expectTrueLines();
}

// A scanner that falls silent for a moment and then tells in one heap what it measured meanwhile, as behind an
// adapter that stood still: the tilt has moved on since.
TEST_F(RigCaptureTest, WhatLaySomewhereForAWhileIsNotBelieved) {
  class Pauses : public Actor {
   public:
    Pauses(Clock& clock, EmulatedBench& bench) : bench_(bench), next_(clock.now() + durationOf(3.0)) {}
    Instant nextEvent() const override { return next_; }
    void act(Instant now) override {
      EXPECT_TRUE(bench_.fault(silent_ ? "none" : "silent"));
      silent_ = !silent_;
      next_ = now + durationOf(silent_ ? random_.uniform(0.2, 2.0) : random_.uniform(0.5, 3.0));
      ++count_;
    }
    int count() const { return count_; }

   private:
    EmulatedBench& bench_;
    RandomStream random_{7};
    Instant next_;
    bool silent_ = false;
    int count_ = 0;
  };
  make(101);
  auto& clock = dynamic_cast<VirtualClock&>(bench_->clock());
  Pauses pauses(clock, *bench_);
  clock.attach(pauses);
  const auto report = run();
  clock.detach(pauses);
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(report->taken, 101);
  EXPECT_GT(pauses.count(), 20);
  expectTrueLines();
}

TEST_F(RigCaptureTest, TheSameTwiceIsTheSame) {
  make(6);
  ASSERT_TRUE(run());
  const auto first = lines_;
  make(6);
  ASSERT_TRUE(run());
  ASSERT_EQ(first.size(), lines_.size());
  for (const auto& [row, line] : first) {
    EXPECT_EQ(line.range_m, lines_[row].range_m);
    EXPECT_EQ(line.tilt_rad, lines_[row].tilt_rad);
    EXPECT_EQ(line.time_s, lines_[row].time_s);
  }
}

// Every fault of either instrument in the middle of a scan: nothing lost, nothing wrong.
struct SweepFault {
  const char* name;
  const char* undo;  // what ends it, three stored lines or ten seconds later; empty: it ends by itself
  bool interrupts;   // the operator is told of it
};
std::ostream& operator<<(std::ostream& out, const SweepFault& fault) {
  return out << fault.name;
}
class RigFault : public RigCaptureTest, public ::testing::WithParamInterface<SweepFault> {};

TEST_P(RigFault, NothingIsLost) {
  const SweepFault& fault = GetParam();
  make();
  after_ = [&](int row) {
    if (row == 4) {
      EXPECT_TRUE(bench_->fault(fault.name).has_value());
    }
    if (row == 8 && *fault.undo) {
      EXPECT_TRUE(bench_->fault(fault.undo).has_value());
    }
  };
  // A fault that stops everything is ended by time.
  class Ender : public Actor {
   public:
    Ender(Clock& clock, EmulatedBench& bench, const char* undo)
        : bench_(bench), undo_(undo), at_(*undo ? clock.now() + durationOf(60.0) : kNever) {}
    Instant nextEvent() const override { return at_; }
    void act(Instant) override {
      at_ = kNever;
      EXPECT_TRUE(bench_.fault(undo_));
    }

   private:
    EmulatedBench& bench_;
    std::string undo_;
    Instant at_;
  };
  auto& clock = dynamic_cast<VirtualClock&>(bench_->clock());
  Ender ender(clock, *bench_, fault.undo);
  clock.attach(ender);
  const auto report = run();
  clock.detach(ender);
  ASSERT_TRUE(report) << report.error().what << " / " << report.error().remedy;
  EXPECT_EQ(lines_.size(), static_cast<std::size_t>(rows_));
  expectTrueLines();
  EXPECT_EQ(report->recoveries > 0, fault.interrupts);
  if (fault.interrupts) {
    ASSERT_FALSE(report->warnings.empty());
    EXPECT_NE(report->warnings.front().find("interrupted at line"), std::string::npos);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Faults, RigFault,
    ::testing::Values(
        SweepFault{"lose-byte=0.0003", "none", false}, SweepFault{"flip-bit=0.0003", "none", false},
        SweepFault{"duplicate-byte=0.0003", "none", false}, SweepFault{"insert-byte=0.0003", "none", false},
        SweepFault{"split=0.01", "none", false}, SweepFault{"cut-telegram=2", "", false},
        SweepFault{"power-cut=3", "", true}, SweepFault{"silent", "none", true},
        SweepFault{"motor-stall", "", true}, SweepFault{"follow-error", "", true},
        SweepFault{"lost-steps", "", false}, SweepFault{"tilt-late-reply", "", false},
        SweepFault{"tilt-lost-acknowledge", "", false}, SweepFault{"tilt-silence", "tilt-recover", true},
        SweepFault{"tilt-lost-byte", "", false}, SweepFault{"tilt-flipped-byte", "", false},
        SweepFault{"tilt-inserted-byte", "", false}, SweepFault{"tilt-lost-command-byte", "", false},
        SweepFault{"tilt-flipped-command-byte", "", false}, SweepFault{"tilt-power-cut", "", true}),
    [](const auto& test) {
      std::string name = test.param.name;
      std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
      return name;
    });

TEST_F(RigCaptureTest, PulledPlugsAreFoundAgain) {
  make();
  after_ = [&](int row) {
    if (row == 6) bench_->unplug();
  };
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(lines_.size(), static_cast<std::size_t>(rows_));
  EXPECT_EQ(report->recoveries, 1);
  expectTrueLines();
}

// The drivers through the real serial port class, the emulators on a thread of their own, a plug pulled: the
// port comes back under another name. Nothing here depends on how fast the machine is.
TEST_F(RigCaptureTest, OverPseudoTerminals) {
  make(4, 4.0);
  after_ = [&](int row) {
    if (row == 1) bench_->unplug();
  };
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what << ": " << report.error().where;
  EXPECT_EQ(lines_.size(), 4U);
  EXPECT_GE(report->recoveries, 1);
  expectTrueLines();
}

TEST_F(RigCaptureTest, ADirtyWindowIsTold) {
  make(4);
  ASSERT_TRUE(bench_->fault("dirty-window"));
  const auto report = run();
  ASSERT_TRUE(report);
  ASSERT_FALSE(report->warnings.empty());
  EXPECT_NE((report->warnings.front() + report->warnings.back()).find("window"), std::string::npos);
}

TEST_F(RigCaptureTest, DeadInstrumentsEndItWithAMessage) {
  make(12);
  after_ = [&](int row) {
    if (row == 5) {
      EXPECT_TRUE(bench_->fault("tilt-silence").has_value());
    }
  };
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().what.find("tilt controller does not answer"), std::string::npos)
      << report.error().what;
  EXPECT_NE(report.error().remedy.find("--resume"), std::string::npos);
  EXPECT_GE(lines_.size(), 6U);
  EXPECT_LE(lines_.size(), 7U) << "the one that was on the wire";
  expectTrueLines();
  // Later, with nothing entered again.
  ASSERT_TRUE(bench_->fault("tilt-recover"));
  after_ = {};
  std::vector<bool> taken(12, false);
  for (const auto& line : lines_) taken[static_cast<std::size_t>(line.first)] = true;
  ASSERT_TRUE(run(taken));
  EXPECT_EQ(lines_.size(), 12U);
  expectTrueLines();
}

TEST(RigNames, EveryFaultOfTheRigIsKnownToIt) {
  auto bench = *EmulatedBench::make(*Experiment::make(ExperimentId::Exp1, 1), {}, 0.0);
  for (const std::string& name : bench->rig().faultNames()) EXPECT_TRUE(bench->fault(name)) << name;
  const Status unknown = bench->fault("nonsense");
  ASSERT_FALSE(unknown);
}

}  // namespace
}  // namespace tiltmap
