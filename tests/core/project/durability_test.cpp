// Killed, cut off and filled up at every moment: the file opens again with every edit that had been accepted.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/project/project.h"
#include "tests/support/child_process.h"
#include "tests/support/fault_vfs.h"
#include "tests/support/project_samples.h"

namespace tiltmap {
namespace {

using namespace test;

constexpr int kWrites = 200;

// A killed process leaves what it has written to the system, on any file system; one in memory is quicker.
class QuickFolder {
 public:
  QuickFolder()
      : folder_(::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : std::filesystem::temp_directory_path()) {
    static int counter = 0;
    folder_ /= "tiltmap-test-" + std::to_string(::getpid()) + "-d" + std::to_string(counter++);
    std::filesystem::create_directory(folder_);
  }
  ~QuickFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  QuickFolder(const QuickFolder&) = delete;
  QuickFolder& operator=(const QuickFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

// The n-th edit of the script: imports, registrations, relaxations and what people do between them.
void makeEdit(Project& project, int n, const ImageOptions& size) {
  const SnapshotPtr snapshot = project.snapshot();
  const auto seed = static_cast<std::uint64_t>(n + 1);
  switch (n % 8) {
    case 0:
      must(project.apply(importEdit({sampleScan(seed, size), sampleScan(seed + 100, size)})));
      break;
    case 1:
      must(project.apply(sampleRegister(snapshot, seed)));
      break;
    case 2:
      must(project.apply(sampleRelax(snapshot, seed)));
      break;
    case 3:
      must(project.apply(renameEdit(snapshot->scans()[0].id, "name " + std::to_string(n))));
      break;
    case 4:
      must(project.undo());
      break;
    case 5:
      must(project.redo());
      break;
    case 6:
      must(project.apply(linkStateEdit(snapshot->links()[0].id, LinkState::Disabled)));
      break;
    case 7:
      must(project.apply(deleteEdit(*snapshot, {snapshot->scans()[1].id})));
      break;
    default:
      break;
  }
}

// The visible state after 0, 1, 2, ... edits, from an undisturbed run.
std::vector<std::string> undisturbed(int edits, const ImageOptions& size) {
  const QuickFolder folder;
  const auto project = must(Project::create(folder / "p.tiltmap"));
  std::vector<std::string> states = {visibleState(*project->snapshot())};
  for (int n = 0; n < edits; ++n) {
    makeEdit(*project, n, size);
    states.push_back(visibleState(*project->snapshot()));
  }
  return states;
}

// Says a line after create() and each edit.
void runScript(const std::filesystem::path& path, int edits, const ImageOptions& size,
               const ChildProcess::Say& say) {
  const auto project = must(Project::create(path));
  say("created");
  for (int n = 0; n < edits; ++n) {
    makeEdit(*project, n, size);
    say("edit");
  }
}

int linesOf(const std::string& text) {
  return static_cast<int>(std::ranges::count(text, '\n'));
}

std::string integrity(const std::filesystem::path& path) {
  sqlite3* database = nullptr;
  std::string verdict = "cannot be opened";
  if (sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK)
    sqlite3_exec(
        database, "PRAGMA integrity_check",
        [](void* out, int, char** values, char**) {
          *static_cast<std::string*>(out) = values[0];
          return 0;
        },
        &verdict, nullptr);
  sqlite3_close(database);
  return verdict;
}

// `said` lines: create() and said - 1 edits had returned. One more may be in the file, its apply() not yet
// returned.
void expectNothingLost(const std::filesystem::path& path, int said, const std::vector<std::string>& states) {
  if (said == 0 && !std::filesystem::exists(path)) {
    // Nothing had been promised, and the name is free for another try.
    ASSERT_TRUE(Project::create(path));
    return;
  }
  const std::size_t done = said == 0 ? 0 : static_cast<std::size_t>(said - 1);
  {
    const auto reader = Project::open(path, Access::ReadOnly);
    ASSERT_TRUE(reader) << reader.error().what;
    const std::string state = visibleState(*(*reader)->snapshot());
    const bool exact = state == states[done];
    const bool one_more = done + 1 < states.size() && state == states[done + 1];
    ASSERT_TRUE(exact || one_more) << "after " << done << " edits:\n"
                                   << state << "\nexpected:\n"
                                   << states[done];
  }
  ASSERT_EQ(integrity(path), "ok");
  // And life goes on.
  const auto writer = Project::open(path, Access::ReadWrite);
  ASSERT_TRUE(writer) << writer.error().what;
  ASSERT_TRUE((*writer)->apply(surveyEdit({"site", "", "", ""})));
  ASSERT_TRUE((*writer)->verify());
}

class KilledAtWrite : public ::testing::TestWithParam<Fault> {};

TEST_P(KilledAtWrite, HoldsEveryAcceptedEdit) {
  const ImageOptions size;
  const int edits = 24;
  const auto states = undisturbed(edits, size);
  int reached = 0;
  // Every single one for the plain kill; the costlier faults take every third, which is as many kinds.
  for (int at = 1; at <= kWrites; at += GetParam() == Fault::Kill ? 1 : 3) {
    SCOPED_TRACE("write " + std::to_string(at));
    const QuickFolder folder;
    const auto path = folder / "p.tiltmap";
    ChildProcess child([&](const ChildProcess::Say& say) {
      const FaultVfs vfs(GetParam(), at);
      runScript(path, edits, size, say);
    });
    const std::string said = child.rest();
    ASSERT_EQ(said.find("EXCEPTION"), std::string::npos) << said;
    ASSERT_FALSE(child.wait()) << "the script is too short: it ended before write " << at;
    reached = std::max(reached, linesOf(said));
    expectNothingLost(path, linesOf(said), states);
    if (::testing::Test::HasFatalFailure()) return;
  }
  // The writes lie in create, import, register and relax.
  EXPECT_GE(reached, 4);
}

INSTANTIATE_TEST_SUITE_P(Durability, KilledAtWrite,
                         ::testing::Values(Fault::Kill, Fault::TornKill, Fault::PowerCut),
                         [](const auto& tested) {
                           return tested.param == Fault::Kill       ? "Killed"
                                  : tested.param == Fault::TornKill ? "TornWrite"
                                                                    : "PowerCut";
                         });

TEST(Durability, KilledAtRandomMoments) {
  const ImageOptions size{101, 361, false, true, false};
  const int edits = 16;
  const auto states = undisturbed(edits, size);
  RandomStream random(20);
  for (int round = 0; round < 24; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const QuickFolder folder;
    const auto path = folder / "p.tiltmap";
    ChildProcess child([&](const ChildProcess::Say& say) { runScript(path, edits, size, say); });
    // Some lines first, so that the moments spread over the script however fast the machine is.
    int said = 0;
    for (std::uint64_t wanted = random.below(14); wanted > 0 && !child.line().empty(); --wanted) ++said;
    std::this_thread::sleep_for(std::chrono::microseconds(random.below(8000)));
    child.kill();
    const std::string rest = child.rest();
    ASSERT_EQ(rest.find("EXCEPTION"), std::string::npos) << rest;
    child.wait();
    expectNothingLost(path, said + linesOf(rest), states);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(Durability, FullDiskAtEachWriteLosesNothing) {
  const ImageOptions size;
  const int edits = 6;
  const auto states = undisturbed(edits, size);
  const QuickFolder folder;
  int refused = 0;
  for (int at = 1; at <= 120; at += 3) {
    SCOPED_TRACE("write " + std::to_string(at));
    const auto path = folder / ("p" + std::to_string(at) + ".tiltmap");
    std::size_t done = 0;
    std::optional<Error> error;
    {
      std::unique_ptr<Project> project;
      {
        const FaultVfs vfs(Fault::Full, at);
        auto made = Project::create(path);
        if (!made) {
          error = made.error();
          EXPECT_FALSE(std::filesystem::exists(path));
        } else {
          project = std::move(*made);
          for (int n = 0; n < edits && !error; ++n) {
            try {
              makeEdit(*project, n, size);
              ++done;
            } catch (const std::runtime_error& failure) {
              error = Error{failure.what(), "", ""};
            }
          }
          // The snapshot is that of the last accepted edit.
          EXPECT_EQ(visibleState(*project->snapshot()), states[done]);
          project.reset();
        }
      }
    }
    if (error) {
      ++refused;
      EXPECT_NE((error->what + error->remedy).find("disk is full"), std::string::npos) << error->what;
    }
    if (std::filesystem::exists(path)) expectNothingLost(path, static_cast<int>(done) + 1, states);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GE(refused, 20);
}

TEST(Durability, EditsGoOnWhenTheDiskHasRoomAgain) {
  const QuickFolder folder;
  const auto path = folder / "p.tiltmap";
  std::unique_ptr<Project> project;
  {
    const FaultVfs vfs(Fault::Full, 300);
    project = must(Project::create(path));
    Result<Change> change = project->apply(importEdit(sampleScans(2)));
    ASSERT_TRUE(change);
    for (int i = 0; i < 300 && change; ++i) change = project->apply(importEdit(sampleScans(2)));
    ASSERT_FALSE(change);
    EXPECT_EQ(change.error().what, "the disk is full");
    FaultVfs::writes() = -100000;  // room again
    const std::string before = visibleState(*project->snapshot());
    EXPECT_FALSE(before.empty());
    must(project->apply(renameEdit(project->snapshot()->scans()[0].id, "after")));
    EXPECT_TRUE(project->verify());
    project.reset();
  }
  EXPECT_EQ(must(Project::open(path, Access::ReadOnly))->snapshot()->scans()[0].name, "after");
}

}  // namespace
}  // namespace tiltmap
