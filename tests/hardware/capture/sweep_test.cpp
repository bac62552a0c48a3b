#include "hardware/capture/sweep.h"

#include <gtest/gtest.h>

#include "core/project/live_project.h"
#include "hardware/capture/memory_scanner.h"
#include "hardware/tilt/memory_unit.h"

namespace tiltmap {
namespace {

constexpr int kRows = 12, kColumns = 7;

// Hands a unit out again after it was let go, as a port would.
template <class Unit, class Base>
class Lent : public Base {
 public:
  explicit Lent(std::shared_ptr<Unit> unit) : unit_(std::move(unit)) {}
  std::shared_ptr<Unit> unit_;
};
class LentTilt : public Lent<MemoryTiltUnit, TiltUnit> {
 public:
  using Lent::Lent;
  const std::string& name() const override { return unit_->name(); }
  Status prepare(const JobControl& job) override { return unit_->prepare(job); }
  Status checkAngle(double angle) const override { return unit_->checkAngle(angle); }
  Status moveTo(double angle) override { return unit_->moveTo(angle); }
  Result<std::optional<TiltReading>> poll() override { return unit_->poll(); }
  void stop() override { unit_->stop(); }
  Status release() override { return unit_->release(); }
};
class LentScanner : public Lent<MemoryScanner, ScannerUnit> {
 public:
  using Lent::Lent;
  const std::string& name() const override { return unit_->name(); }
  Status prepare(const JobControl& job) override { return unit_->prepare(job); }
  int columns() const override { return unit_->columns(); }
  double azimuthStart() const override { return 0.0; }
  double azimuthStep() const override { return unit_->azimuthStep(); }
  Result<std::optional<ScannerEvent>> poll() override { return unit_->poll(); }
  Status release() override { return unit_->release(); }
};

class SweepTest : public ::testing::Test {
 protected:
  SweepTest()
      : tilt_(std::make_shared<MemoryTiltUnit>(clock_, TiltDrive{})),
        scanner_(std::make_shared<MemoryScanner>(clock_, kColumns,
                                                 [this](Instant from) { return lineAt(from); })) {
    Instruments instruments;
    instruments.clock = &clock_;
    instruments.open_scanner = [this]() -> Result<std::unique_ptr<ScannerUnit>> {
      ++opened_;
      return std::make_unique<LentScanner>(scanner_);
    };
    instruments.open_tilt = [this]() -> Result<std::unique_ptr<TiltUnit>> {
      return std::make_unique<LentTilt>(tilt_);
    };
    sweep_ = std::make_unique<Sweep>(instruments, SweepOptions{});
  }

  // What the scanner sees tells at which tilt it was seen: 1 m and the angle at either end of the measuring.
  LineTaken lineAt(Instant from) const {
    LineTaken line;
    line.range_m.assign(kColumns, static_cast<float>(2.0 + tilt_->angle(from)));
    line.range_m.back() = static_cast<float>(2.0 + tilt_->angle(from + MemoryScanner::kMeasuring));
    line.code.assign(kColumns, cell_code::kMeasured);
    return line;
  }

  Result<SweepReport> run(std::vector<bool> taken = std::vector<bool>(kRows, false),
                          const JobControl& job = {}) {
    if (Status status = sweep_->prepare({}); !status) return fail(status.error());
    geometry_ = sweep_->geometry(kRows, -0.1, 0.8 * 3.14159265358979 / 180.0);
    return sweep_->run(
        geometry_, std::move(taken),
        [this](int row, ScanLine line) {
          std::promise<Status> promise;
          if (after_) after_(row);
          if (full_disk_at_ == row) {
            promise.set_value(fail("the disk is full", "test", "make room"));
          } else {
            EXPECT_FALSE(lines_.contains(row)) << "never twice";
            order_.push_back(row);
            lines_[row] = std::move(line);
            promise.set_value({});
          }
          return promise.get_future();
        },
        job);
  }
  void expectLines(int count) const {
    EXPECT_EQ(lines_.size(), static_cast<std::size_t>(count));
    for (const auto& [row, line] : lines_) {
      EXPECT_NEAR(line.tilt_rad, geometry_.tiltOfRow(row), 2e-6);
      for (const float range : line.range_m)
        EXPECT_FLOAT_EQ(range, static_cast<float>(2.0 + line.tilt_rad))
            << "measured wholly where it says, row " << row;
    }
  }

  VirtualClock clock_;
  std::shared_ptr<MemoryTiltUnit> tilt_;
  std::shared_ptr<MemoryScanner> scanner_, gone_;
  std::unique_ptr<Sweep> sweep_;
  ScannerGeometry geometry_;
  std::map<int, ScanLine> lines_;
  std::vector<int> order_;
  std::function<void(int)> after_;
  int full_disk_at_ = -1, opened_ = 0;
};

TEST_F(SweepTest, TakesEveryLineWhereItStandsStill) {
  const auto report = run();
  ASSERT_TRUE(report) << report.error().what;
  expectLines(kRows);
  EXPECT_EQ(report->taken, kRows);
  EXPECT_EQ(report->spoiled, 0);
  EXPECT_EQ(report->recoveries, 0);
  EXPECT_TRUE(std::ranges::is_sorted(order_));
  for (int row = 1; row < kRows; ++row) EXPECT_GT(lines_[row].time_s, lines_[row - 1].time_s);
}

TEST_F(SweepTest, MovesWhileTheLineIsOnTheWire) {
  const auto report = run();
  ASSERT_TRUE(report);
  // One period a line, and about six for the way to the first.
  EXPECT_LT(report->duration_s, (kRows + 7) * 0.21312);
  EXPECT_EQ(tilt_->moves(), kRows);
}

TEST_F(SweepTest, ASlowerTiltCostsTimeAndNothingElse) {
  TiltDrive slow;
  slow.speed = 20.0;
  tilt_ = std::make_shared<MemoryTiltUnit>(clock_, slow);
  const auto report = run();
  ASSERT_TRUE(report);
  expectLines(kRows);
  EXPECT_GT(report->duration_s, kRows * 2 * 0.21312);
}

TEST_F(SweepTest, GoesOnWithWhatIsMissing) {
  std::vector<bool> taken(kRows, true);
  taken[3] = taken[8] = false;
  const auto report = run(taken);
  ASSERT_TRUE(report);
  EXPECT_EQ(order_, (std::vector<int>{3, 8}));
  EXPECT_EQ(report->taken, 2);
  order_.clear();
  const auto nothing = run(std::vector<bool>(kRows, true));
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->taken, 0);
  EXPECT_TRUE(order_.empty());
}

TEST_F(SweepTest, ASpoiledLineIsTakenAgain) {
  after_ = [this](int row) {
    if (row == 4) scanner_->spoil(1);
    if (row == 10) scanner_->spoil(2);
  };
  const auto report = run();
  ASSERT_TRUE(report);
  expectLines(kRows);
  EXPECT_GE(report->spoiled, 2);
  EXPECT_EQ(order_[5], 6);
  EXPECT_TRUE(std::ranges::find(order_, 5) > std::ranges::find(order_, 6)) << "at the end of the sweep";
}

TEST_F(SweepTest, AWireThatSpoilsEverythingIsTold) {
  scanner_->spoil(1000000);
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().what.find("damaged"), std::string::npos);
  EXPECT_NE(report.error().remedy.find("--resume"), std::string::npos);
  EXPECT_TRUE(lines_.empty());
}

TEST_F(SweepTest, AnInstrumentThatComesBackIsGoneOnWith) {
  int calls = 0;
  after_ = [&](int row) {
    if (row == 5) tilt_->setTrouble(Error{"the tilt is gone", "port", "plug it in"});
    ++calls;
  };
  // Plugged in again when the second try has failed.
  JobControl job;
  int tries = 0;
  job.report = [&](const Progress& progress) {
    if (progress.message.find("trying again") != std::string::npos && ++tries == 2)
      tilt_->setTrouble(std::nullopt);
  };
  const auto report = run(std::vector<bool>(kRows, false), job);
  ASSERT_TRUE(report) << report.error().what;
  expectLines(kRows);
  EXPECT_EQ(report->recoveries, 1);
  ASSERT_FALSE(report->warnings.empty());
  EXPECT_NE(report->warnings.front().find("the tilt is gone"), std::string::npos);
  EXPECT_GE(opened_, 3);
}

TEST_F(SweepTest, OneThatDoesNotComeBackEndsTheSweepWithWhatThereIs) {
  after_ = [this](int row) {
    if (row == 5) scanner_->setSilent(true);
  };
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().what.find("stopped sending"), std::string::npos);
  EXPECT_NE(report.error().remedy.find("--resume"), std::string::npos);
  expectLines(6);
  // And later, with nothing entered again:
  scanner_->setSilent(false);
  std::vector<bool> taken(kRows, false);
  for (const auto& line : lines_) taken[static_cast<std::size_t>(line.first)] = true;
  after_ = {};
  ASSERT_TRUE(run(taken));
  expectLines(kRows);
}

TEST_F(SweepTest, AFullDiskEndsItAtOnce) {
  full_disk_at_ = 5;
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().what, "the disk is full");
  EXPECT_GE(lines_.size(), 5U);
  EXPECT_FALSE(lines_.contains(5));
}

TEST_F(SweepTest, StopsWhenToldTo) {
  std::stop_source source;
  after_ = [&](int row) {
    if (row == 3) source.request_stop();
  };
  JobControl job;
  job.stop = source.get_token();
  const auto report = run(std::vector<bool>(kRows, false), job);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().what, kCancelled);
  expectLines(4);
}

TEST_F(SweepTest, AnotherScannerThanItBeganWithIsRefused) {
  after_ = [this](int row) {
    if (row != 5) return;
    scanner_->setTrouble(Error{"gone", "", ""});
    gone_ = std::exchange(scanner_, std::make_shared<MemoryScanner>(
                                        clock_, kColumns + 2, [this](Instant from) { return lineAt(from); }));
  };
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().what.find("values a line"), std::string::npos) << report.error().what;
  expectLines(6);
}

TEST_F(SweepTest, WrongUse) {
  EXPECT_THROW(Sweep({}, {}), std::invalid_argument);
  EXPECT_THROW((void)sweep_->geometry(5, 0.0, 0.1), std::logic_error);
  ASSERT_TRUE(sweep_->prepare({}));
  EXPECT_THROW((void)sweep_->run(sweep_->geometry(kRows, 0.0, 0.1), {}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
