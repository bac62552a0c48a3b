// A relaxation that is watched: what is told, pause, cancel, and that watching changes no bit.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "core/project/job.h"
#include "core/project/operations/relax_operation.h"
#include "tests/support/program.h"
#include "tests/support/project_samples.h"

namespace tiltmap {
namespace {

class RelaxationFeedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = test::must(Project::create((folder_ / "p.tiltmap").string()));
    run(*operations().find("simulate"), {{"experiment", std::string("exp1")}, {"stops", 4LL}});
    run(*operations().find("register"), {});
  }
  void run(const Operation& operation, const ParameterValues& values, const std::string& preset = "default") {
    const auto job = test::must(Job::start(operation, project_->snapshot(), preset, values));
    job->wait();
    test::must(job->result());
    test::must(job->accept(*project_));
  }
  std::vector<Pose> relaxedBy(const Operation& operation, const std::string& preset) {
    run(operation, {}, preset);
    std::vector<Pose> poses = project_->snapshot()->filledPoses(Stage::Relaxed);
    test::must(project_->undo());
    return poses;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(RelaxationFeedTest, WatchingChangesNoBit) {
  for (const std::string preset : {"default", "thesis", "sequential"}) {
    const auto plain = relaxedBy(*operations().find("relax"), preset);
    auto feed = std::make_shared<RelaxationFeed>();
    const auto watched = relaxedBy(*makeRelaxOperation(feed), preset);
    EXPECT_EQ(plain, watched) << preset;
    const RelaxationNews news = feed->take();
    ASSERT_TRUE(news.began) << preset;
    EXPECT_EQ(news.began->scans.size(), 4U);
    ASSERT_FALSE(news.frames.empty()) << preset;
    EXPECT_EQ(news.frames.back().world_from_scan, plain) << preset;
    EXPECT_EQ(news.frames.back().state.step, static_cast<int>(news.frames.size()));
    EXPECT_TRUE(feed->take().empty()) << "what was taken is not told again";
  }
}

TEST_F(RelaxationFeedTest, TheThesisMethodTellsItsSetsAndTheScanThatIsAligned) {
  auto feed = std::make_shared<RelaxationFeed>();
  const auto operation = makeRelaxOperation(feed);
  const auto job = test::must(Job::start(*operation, project_->snapshot(), "thesis", {}));
  bool aligned = false, iterated = false;
  std::vector<RelaxationFrame> frames;
  const auto look = [&](const RelaxationNews& news) {
    for (const RelaxationFrame& frame : news.frames) frames.push_back(frame);
    if (!news.now || news.now->aligning < 0) return;
    aligned = true;
    iterated |= news.now->iteration > 0 && news.now->rms_m > 0.0 && news.now->pairs > 0;
    EXPECT_FALSE(news.now->onto.empty());
    EXPECT_EQ(std::ranges::count(news.now->onto, news.now->aligning), 0);
  };
  while (!job->waitFor(std::chrono::milliseconds(0))) look(feed->take());
  look(feed->take());
  EXPECT_TRUE(aligned);
  EXPECT_TRUE(iterated);
  ASSERT_FALSE(frames.empty());
  for (const RelaxationFrame& frame : frames)
    EXPECT_EQ(frame.state.active.size() + frame.state.waiting.size(), 4U)
        << "every scan is in one of the sets";
  EXPECT_TRUE(frames.back().state.waiting.empty());
  EXPECT_TRUE(frames.back().state.queue.empty());
}

TEST_F(RelaxationFeedTest, PausedItWaitsAndGoesOnToTheSameBits) {
  for (const std::string preset : {"default", "thesis"}) {
    const auto plain = relaxedBy(*operations().find("relax"), preset);
    auto feed = std::make_shared<RelaxationFeed>();
    const auto operation = makeRelaxOperation(feed);
    feed->pause();
    const auto job = test::must(Job::start(*operation, project_->snapshot(), preset, {}));
    while (!feed->isWaiting()) std::this_thread::yield();
    EXPECT_FALSE(job->waitFor(std::chrono::milliseconds(30))) << "it ended while it was paused";
    feed->resume();
    job->wait();
    EXPECT_FALSE(feed->isWaiting());
    const OperationResult result = test::must(job->result());
    test::must(job->accept(*project_));
    EXPECT_EQ(project_->snapshot()->filledPoses(Stage::Relaxed), plain) << preset;
    test::must(project_->undo());
  }
}

TEST_F(RelaxationFeedTest, CancelEndsAPauseAtOnce) {
  auto feed = std::make_shared<RelaxationFeed>();
  const auto operation = makeRelaxOperation(feed);
  feed->pause();
  const auto revision = project_->snapshot()->revision();
  const auto job = test::must(Job::start(*operation, project_->snapshot(), "thesis", {}));
  while (!feed->isWaiting()) std::this_thread::yield();
  job->cancel();
  job->wait();
  EXPECT_EQ(job->state(), JobState::Cancelled);
  EXPECT_EQ(project_->snapshot()->revision(), revision);
}

TEST_F(RelaxationFeedTest, TellsOnceUntilTheNewsIsTaken) {
  int told = 0;
  RelaxationFeed feed([&told] { ++told; });
  const std::stop_token never;
  feed.at({}, never);
  feed.at({}, never);
  EXPECT_EQ(told, 1);
  EXPECT_TRUE(feed.take().now);
  feed.stepped({}, never);
  EXPECT_EQ(told, 2);
  EXPECT_EQ(feed.take().frames.size(), 1U);
}

TEST_F(RelaxationFeedTest, PinnedScansOfTheProjectStay) {
  const auto moved = [&](std::size_t scan) {
    const SnapshotPtr snapshot = project_->snapshot();
    return difference(*snapshot->poses(Stage::Pairwise)[scan], *snapshot->poses(Stage::Relaxed)[scan])
        .translation_m;
  };
  const ScanId pinned = project_->snapshot()->scans()[2].id;
  test::must(project_->apply(pinsEdit(*project_->snapshot(), {pinned})));
  EXPECT_TRUE(project_->snapshot()->isPinned(pinned));
  for (const std::string preset : {"default", "thesis", "sequential"}) {
    run(*operations().find("relax"), {}, preset);
    EXPECT_EQ(moved(2), 0.0) << preset;
    EXPECT_GT(moved(3), 0.0) << preset;
  }
  auto feed = std::make_shared<RelaxationFeed>();
  run(*makeRelaxOperation(feed), {{"pin", std::string("3")}});
  EXPECT_EQ(moved(2), 0.0);
  EXPECT_EQ(moved(3), 0.0) << "the parameter's pins and the project's together";
  EXPECT_EQ(feed->take().began->pins, (std::vector<int>{0, 2, 3}));
}

}  // namespace
}  // namespace tiltmap
