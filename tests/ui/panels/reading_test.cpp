// Points are read aside: the window goes on, whatever becomes of the project meanwhile.
#include <QLabel>
#include <QTimer>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "tests/ui/support/window_fixture.h"
#include "ui/panels/view3d_panel.h"
#include "ui/scene/point_reader.h"
#include "ui/window/command_palette.h"

namespace tiltmap::test {
namespace {

using ui::PointReader;
using ui::PointsWanted;
using ui::ScanPoints;

// Reads when it is told to; ends early when the reader goes.
class HeldReading {
 public:
  PointReader::Read read() {
    return [this](const PointsWanted& wanted, const std::stop_token& stop) -> Result<ScanPoints> {
      {
        std::unique_lock lock(mutex_);
        threads_.insert(std::this_thread::get_id());
        ++begun_;
        changed_.wait(lock, stop, [this] { return open_; });
      }
      if (unreadable_ == wanted.scan.name) return fail("the page is torn", "", "look for a copy");
      return ui::readPoints(wanted, stop);
    };
  }
  void letGo() {
    {
      const std::lock_guard lock(mutex_);
      open_ = true;
    }
    changed_.notify_all();
  }
  void hold() {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  int begun() {
    const std::lock_guard lock(mutex_);
    return begun_;
  }
  bool onlyOnOtherThreads() {
    const std::lock_guard lock(mutex_);
    return !threads_.empty() && !threads_.contains(std::this_thread::get_id());
  }
  std::string unreadable_;

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool open_ = false;
  int begun_ = 0;
  std::set<std::thread::id> threads_;
};

class PointReaderTest : public WorkspaceTest {
 protected:
  std::vector<PointsWanted> wanted() {
    std::vector<PointsWanted> all;
    for (const ScanEntry& scan : snapshot().scans()) all.push_back({scan, false, false});
    return all;
  }
  HeldReading held;
};

TEST_F(PointReaderTest, ReadsAsideAndHandsOverEveryScanOnce) {
  makeProject(5);
  PointReader reader(nullptr, held.read(), 2);
  std::vector<ScanPoints> got;
  QObject::connect(&reader, &PointReader::arrived, [&] {
    for (ScanPoints& scan : reader.take()) got.push_back(std::move(scan));
  });
  reader.want(wanted());
  reader.want(wanted());  // again, as after an edit
  ASSERT_TRUE(waitUntil([&] { return held.begun() == 2; }));
  EXPECT_TRUE(reader.isReading());
  EXPECT_EQ(reader.total(), 5);
  bool handled = false;
  QTimer::singleShot(0, [&] { handled = true; });
  ASSERT_TRUE(waitUntil([&] { return handled; }));
  EXPECT_TRUE(got.empty());
  held.letGo();
  ASSERT_TRUE(waitUntil([&] { return !reader.isReading(); }));
  EXPECT_TRUE(held.onlyOnOtherThreads());
  EXPECT_EQ(held.begun(), 5);
  ASSERT_EQ(got.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto found = std::ranges::find(got, id(i), &ScanPoints::scan);
    ASSERT_NE(found, got.end());
    EXPECT_EQ(found->xyz, must(ui::scanPointsOf(snapshot().scans()[i], false)).xyz);
  }
}

TEST_F(PointReaderTest, WhatIsForgottenIsNotHandedOver) {
  makeProject(3);
  PointReader reader(nullptr, held.read(), 1);
  int arrivals = 0;
  QObject::connect(&reader, &PointReader::arrived,
                   [&] { arrivals += static_cast<int>(reader.take().size()); });
  reader.want(wanted());
  ASSERT_TRUE(waitUntil([&] { return held.begun() == 1; }));
  reader.forget();
  EXPECT_FALSE(reader.isReading());
  // Another project whose scans have the same numbers.
  const auto again = wanted();
  reader.want({again[0]});
  held.letGo();
  ASSERT_TRUE(waitUntil([&] { return !reader.isReading(); }));
  EXPECT_EQ(arrivals, 1);
  EXPECT_EQ(held.begun(), 2) << "read anew, and no other scan";
}

TEST_F(PointReaderTest, WhatCannotBeReadIsToldOnce) {
  makeProject(2);
  held.unreadable_ = nameOf(1);
  held.letGo();
  PointReader reader(nullptr, held.read(), 2);
  std::vector<std::string> troubles;
  QObject::connect(&reader, &PointReader::failed,
                   [&](const PointReader::Trouble& trouble) { troubles.push_back(trouble.scan); });
  reader.want(wanted());
  ASSERT_TRUE(waitUntil([&] { return !reader.isReading(); }));
  EXPECT_EQ(troubles, std::vector<std::string>{nameOf(1)});
  ASSERT_EQ(reader.take().size(), 1U);
  reader.want({wanted()[1]});
  EXPECT_FALSE(reader.isReading());
}

TEST_F(PointReaderTest, GoesInTheMiddle) {
  makeProject(3);
  auto reader = std::make_unique<PointReader>(nullptr, held.read(), 2);
  reader->want(wanted());
  ASSERT_TRUE(waitUntil([&] { return held.begun() == 2; }));
  reader.reset();  // held for ever, did it not ask them to stop
  EXPECT_EQ(held.begun(), 2);
}

class ReadingTest : public WindowTest {
 protected:
  void SetUp() override {
    space = qobject_cast<ui::View3dPanel*>(window->docks().panel("view3d"));
    ASSERT_NE(space, nullptr);
    space->reader().setRead(held.read());
  }
  void TearDown() override { held.letGo(); }
  QString fileOf(const std::string& name, int scans) {
    auto project = must(Project::create(folder / name));
    must(project->apply(importEdit(sampleScans(scans))));
    return ui::qt(folder / name);
  }
  std::size_t pointsOfProject() {
    std::size_t points = 0;
    for (const ScanEntry& scan : snapshot().scans()) points += scan.valid_cells;
    return points;
  }
  HeldReading held;
  ui::View3dPanel* space = nullptr;
};

TEST_F(ReadingTest, TheWindowIsUsedWhileAProjectsScansAreRead) {
  must(workspace().session().open(fileOf("large.tiltmap", 6)));
  ASSERT_TRUE(waitUntil([&] { return held.begun() > 0; }));
  EXPECT_TRUE(space->isReading());
  EXPECT_EQ(space->scene().pointsDrawn(), 0U);
  // It says so, and does what it is told meanwhile.
  auto* label = find<QLabel>("view3d-computing");
  ASSERT_TRUE(waitUntil([&] { return label->text().startsWith("Reading scans: 0 of 6"); }));
  QTest::keySequence(window.data(), QKeySequence("Ctrl+K"));
  ASSERT_TRUE(waitUntil([&] { return find<ui::CommandPalette>("command-palette")->isVisible(); }));
  find<ui::CommandPalette>("command-palette")->hide();
  must(workspace().session().apply(renameEdit(id(0), "gate")));
  EXPECT_EQ(nameOf(0), "gate");
  EXPECT_TRUE(space->isReading());
  held.letGo();
  ASSERT_TRUE(waitUntil([&] { return !space->isReading(); }));
  EXPECT_TRUE(held.onlyOnOtherThreads());
  EXPECT_EQ(space->scene().pointsDrawn(), pointsOfProject());
  EXPECT_TRUE(label->isHidden());
}

TEST_F(ReadingTest, AProjectClosedOrChangedInTheMiddleLeavesNothing) {
  const QString large = fileOf("large.tiltmap", 6), small = fileOf("small.tiltmap", 1);
  must(workspace().session().open(large));
  ASSERT_TRUE(waitUntil([&] { return held.begun() > 0; }));
  workspace().session().close();
  EXPECT_FALSE(space->isReading());
  must(workspace().session().open(large));
  must(workspace().session().open(small));
  held.letGo();
  ASSERT_TRUE(waitUntil([&] { return !space->isReading(); }));
  settle();
  EXPECT_EQ(space->scene().pointsDrawn(), pointsOfProject());
  EXPECT_EQ(snapshot().scans().size(), 1U);
}

TEST_F(ReadingTest, TheWindowClosesInTheMiddle) {
  must(workspace().session().open(fileOf("large.tiltmap", 6)));
  ASSERT_TRUE(waitUntil([&] { return held.begun() > 0; }));
  window->close();
  QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  EXPECT_TRUE(window.isNull());
}

TEST_F(ReadingTest, AScanThatCannotBeReadIsToldAndTheOthersAreDrawn) {
  held.unreadable_ = "stop 2";
  held.letGo();
  must(workspace().session().open(fileOf("torn.tiltmap", 3)));
  ASSERT_TRUE(waitUntil([&] { return !space->isReading(); }));
  ASSERT_TRUE(workspace().messages().latest());
  EXPECT_NE(workspace().messages().latest()->text.indexOf("cannot be drawn"), -1);
  EXPECT_EQ(space->scene().pointsDrawn(),
            snapshot().scans()[0].valid_cells + snapshot().scans()[2].valid_cells);
}

}  // namespace
}  // namespace tiltmap::test
