// Files that are not projects, damaged ones, places that cannot be written, several processes at once.
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/project/project.h"
#include "tests/support/child_process.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class FileTrouble : public ::testing::Test {
 protected:
  // Refused for reading and for writing, with a full message, and the file's bytes untouched.
  void expectRefused(const fs::path& path, const std::string& message) {
    const std::string before = test::bytesOf(path);
    for (const Access access : {Access::ReadOnly, Access::ReadWrite}) {
      const auto project = Project::open(path, access);
      ASSERT_FALSE(project);
      EXPECT_THAT(project.error().what, HasSubstr(message));
      EXPECT_THAT(project.error().where, HasSubstr(path.filename().string()));
      EXPECT_FALSE(project.error().remedy.empty());
    }
    EXPECT_EQ(test::bytesOf(path), before);
  }
  fs::path makeProject(const std::string& name = "p.tiltmap") {
    const auto project = must(Project::create(folder_ / name));
    must(project->apply(importEdit(sampleScans(3, {20, 50, true, true, false}))));
    must(project->apply(sampleRegister(project->snapshot())));
    return project->path();
  }
  static void sql(const fs::path& path, const std::string& statements) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database);
    sqlite3_close(database);
  }
  TemporaryFolder folder_;
};

TEST_F(FileTrouble, NothingThere) {
  const auto project = Project::open(folder_ / "no.tiltmap", Access::ReadWrite);
  ASSERT_FALSE(project);
  EXPECT_THAT(project.error().what, HasSubstr("no such file"));
  EXPECT_THAT(project.error().remedy, HasSubstr("tiltmap new"));
  EXPECT_EQ(folder_.entries(), 0U) << "looking must not make files";
  EXPECT_THAT(Project::open(folder_.path(), Access::ReadOnly).error().what, HasSubstr("not a file"));
}

TEST_F(FileTrouble, ForeignContents) {
  expectRefused(folder_.write("empty.tiltmap", ""), "empty");
  expectRefused(folder_.write("text.tiltmap", "This is a letter, not a survey, and longer than 16 bytes."),
                "not a Tiltmap project");
  expectRefused(folder_.write("short.tiltmap", "SQL"), "not a Tiltmap project");
  expectRefused(folder_.write("magic.tiltmap", std::string("SQLite format 3\0", 16)), "within its header");
  std::string garbage;
  RandomStream random(3);
  for (int i = 0; i < 50000; ++i) garbage += static_cast<char>(random.below(256));
  expectRefused(folder_.write("garbage.tiltmap", garbage), "not a Tiltmap project");
  sql(folder_ / "foreign.tiltmap", "CREATE TABLE t(x); INSERT INTO t VALUES (1)");
  expectRefused(folder_ / "foreign.tiltmap", "another program");
}

TEST_F(FileTrouble, EmptyFileDoesNotCostItsLog) {
  const auto path = folder_.write("p.tiltmap", "");
  const auto log = folder_.write("p.tiltmap-wal", "the log of better days");
  EXPECT_FALSE(Project::open(path, Access::ReadWrite));
  EXPECT_EQ(test::bytesOf(log), "the log of better days");
  fs::remove(path);
  const auto made = Project::create(path);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().what, HasSubstr("log of an earlier project"));
}

TEST_F(FileTrouble, TruncatedAnywhere) {
  const std::string whole = test::bytesOf(makeProject());
  int refused = 0;
  for (const double part : {0.9999, 0.9, 0.5, 0.25, 0.05}) {
    const auto path = folder_.write(
        "cut.tiltmap", whole.substr(0, static_cast<std::size_t>(static_cast<double>(whole.size()) * part)));
    const std::string before = test::bytesOf(path);
    for (const Access access : {Access::ReadOnly, Access::ReadWrite}) {
      const auto project = Project::open(path, access);
      ASSERT_FALSE(project) << part;
      EXPECT_THAT(project.error().what, HasSubstr("damaged"));
      EXPECT_THAT(project.error().remedy, HasSubstr("copy"));
      ++refused;
    }
    EXPECT_EQ(test::bytesOf(path), before);
  }
  EXPECT_EQ(refused, 10);
}

TEST_F(FileTrouble, OverwrittenPagesAreFoundNotBelieved) {
  const std::string whole = test::bytesOf(makeProject());
  RandomStream random(7);
  int noticed = 0;
  for (int round = 0; round < 40; ++round) {
    std::string bytes = whole;
    // One page but the first.
    const std::size_t page = 1 + random.below(whole.size() / 16384 - 1);
    for (std::size_t i = 0; i < 16384; ++i) bytes[page * 16384 + i] = static_cast<char>(random.below(256));
    const auto path = folder_.write("bad.tiltmap", bytes);
    const auto project = Project::open(path, Access::ReadOnly);
    if (!project) {
      ++noticed;
      continue;
    }
    // Reading never ends the program; checking tells.
    for (const ScanEntry& scan : (*project)->snapshot()->scans()) (void)scan.image();
    if (!(*project)->verify()) ++noticed;
  }
  EXPECT_GE(noticed, 38) << "a page on the free list may be anything";
}

TEST_F(FileTrouble, DamagedRowsAreTold) {
  const auto damagedBy = [&](const std::string& statements) {
    const auto path = makeProject("d.tiltmap");
    sql(path, "PRAGMA foreign_keys = OFF;" + statements);
    std::string what;
    auto project = Project::open(path, Access::ReadOnly);
    if (!project) {
      what = project.error().what;
    } else if (const auto verdict = (*project)->verify(); !verdict) {
      what = verdict.error().what;
    }
    project = fail("closed", "", "");
    fs::remove(path);
    return what;
  };
  EXPECT_EQ(damagedBy("SELECT 1"), "");
  EXPECT_THAT(damagedBy("DELETE FROM pose WHERE stage = 'odometry'"), HasSubstr("no odometry"));
  EXPECT_THAT(damagedBy("UPDATE pose SET qx = 0, qy = 0, qz = 0, qw = 0"), HasSubstr("damaged"));
  EXPECT_THAT(damagedBy("DELETE FROM scan WHERE id = 1"), HasSubstr("missing"));
  EXPECT_THAT(damagedBy("DELETE FROM scan_line WHERE row = 3"), HasSubstr("lines are missing"));
  EXPECT_THAT(damagedBy("UPDATE scan_line SET range_m = zeroblob(10) WHERE row = 3"),
              HasSubstr("wrong length"));
  EXPECT_THAT(damagedBy("UPDATE scan_line SET row = 500 WHERE row = 3"), HasSubstr("line 500"));
  EXPECT_THAT(damagedBy("UPDATE scan_line SET code = zeroblob(100), range_m = zeroblob(200)"),
              HasSubstr("damaged"));
  EXPECT_THAT(damagedBy("UPDATE matrix SET rows = 1000000000"), HasSubstr("size is impossible"));
  EXPECT_THAT(damagedBy("UPDATE matrix SET rows = 100000000000"), HasSubstr("damaged"));
  EXPECT_THAT(damagedBy("UPDATE link SET information = zeroblob(3)"), HasSubstr("6 x 6"));
  EXPECT_THAT(damagedBy("DELETE FROM project"), HasSubstr("first table"));
  EXPECT_THAT(damagedBy("DROP TABLE link"), HasSubstr("no such table"));
}

TEST_F(FileTrouble, NewerVersionIsLeftAlone) {
  const auto path = makeProject();
  sql(path, "PRAGMA user_version = 999");
  expectRefused(path, "newer version");
}

TEST_F(FileTrouble, SecondWriterInAnotherProcess) {
  const auto path = makeProject();
  auto ours = must(Project::open(path, Access::ReadWrite));
  {
    ChildProcess child([&](const ChildProcess::Say& say) {
      const auto second = Project::open(path, Access::ReadWrite);
      say(second ? "opened" : second.error().what);
    });
    const std::string said = child.rest();
    EXPECT_THAT(said, HasSubstr("open for writing elsewhere: process " + std::to_string(::getpid())));
  }
  must(ours->apply(renameEdit(1, "still ours")));
  ours.reset();
  EXPECT_TRUE(Project::open(path, Access::ReadWrite));
}

TEST_F(FileTrouble, AKilledWriterHoldsNoLock) {
  const auto path = makeProject();
  {
    ChildProcess child([&](const ChildProcess::Say& say) {
      const auto project = must(Project::open(path, Access::ReadWrite));
      must(project->apply(renameEdit(1, "last words")));
      say("ready");
      for (;;) ::pause();
    });
    ASSERT_EQ(child.line(), "ready");
    EXPECT_FALSE(Project::open(path, Access::ReadWrite));
    // Read while the other one writes, and once it has been killed.
    EXPECT_EQ(must(Project::open(path, Access::ReadOnly))->snapshot()->scans()[0].name, "last words");
    child.kill();
  }
  const auto project = must(Project::open(path, Access::ReadWrite));
  EXPECT_EQ(project->snapshot()->scans()[0].name, "last words");
}

TEST_F(FileTrouble, ReadersWorkWhileAnotherProcessWrites) {
  const auto path = makeProject();
  ChildProcess child([&](const ChildProcess::Say& say) {
    const auto project = must(Project::open(path, Access::ReadWrite));
    for (std::uint64_t i = 0; i < 40; ++i) {
      must(project->apply(importEdit({sampleScan(i + 10, {20, 50, true, true, false})})));
      say("edit");
    }
  });
  std::size_t seen = 3;
  int done = 0;
  while (!child.line().empty()) {
    ++done;
    const auto reader = Project::open(path, Access::ReadOnly);
    ASSERT_TRUE(reader) << reader.error().what;
    const auto snapshot = (*reader)->snapshot();
    EXPECT_GE(snapshot->scans().size(), seen);
    EXPECT_GE(snapshot->scans().size(), static_cast<std::size_t>(done + 3)) << "accepted edits are seen";
    seen = snapshot->scans().size();
    ASSERT_TRUE(snapshot->scans().back().image());
  }
  EXPECT_EQ(done, 40);
}

// In a child without root's rights.
std::string withoutRootsRights(const std::function<std::string()>& body) {
  ChildProcess child([&](const ChildProcess::Say& say) {
    test::giveUpRootsRights();
    say(body());
  });
  return child.rest();
}

class ReadOnlyPlace : public FileTrouble {
 protected:
  void SetUp() override { path_ = makeProject(); }
  void TearDown() override { fs::permissions(folder_.path(), fs::perms::owner_all, fs::perm_options::add); }
  void close() const {
    fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read |
                                        fs::perms::group_exec | fs::perms::others_read |
                                        fs::perms::others_exec);
  }
  std::string openedAs(Access access) const {
    return withoutRootsRights([&]() -> std::string {
      const auto project = Project::open(path_, access);
      if (!project) return project.error().what + " -> " + project.error().remedy;
      for (const ScanEntry& scan : (*project)->snapshot()->scans())
        if (const auto image = scan.image(); !image) return image.error().what;
      return "read " + std::to_string((*project)->snapshot()->scans().size());
    });
  }
  fs::path path_;
};

TEST_F(ReadOnlyPlace, IsReadAndNotWritten) {
  close();
  const std::string before = test::bytesOf(path_);
  EXPECT_EQ(openedAs(Access::ReadOnly), "read 3\n");
  EXPECT_THAT(openedAs(Access::ReadWrite), HasSubstr("nothing can be written"));
  EXPECT_EQ(test::bytesOf(path_), before);
  EXPECT_EQ(folder_.entries(), 1U);
  const std::string created = withoutRootsRights([&] {
    const auto project = Project::create(folder_ / "new.tiltmap");
    return project ? std::string("created") : project.error().what;
  });
  EXPECT_THAT(created, HasSubstr("nothing can be written"));
}

TEST_F(ReadOnlyPlace, FileThatMayNotBeWritten) {
  // The folder may.
  fs::permissions(folder_.path(), fs::perms::all);
  fs::permissions(path_, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  EXPECT_EQ(openedAs(Access::ReadOnly), "read 3\n");
  EXPECT_THAT(openedAs(Access::ReadWrite), HasSubstr("cannot be written"));
  fs::permissions(path_, fs::perms::none);
  EXPECT_THAT(openedAs(Access::ReadOnly), HasSubstr("cannot be read"));
}

TEST_F(ReadOnlyPlace, ChangesStillInTheLogAreNotOverlooked) {
  // A writer killed before its log went into the file; file and log then copied to a medium.
  {
    ChildProcess child([&](const ChildProcess::Say& say) {
      const auto project = must(Project::open(path_, Access::ReadWrite));
      must(project->apply(importEdit({sampleScan(8)})));
      say("ready");
      for (;;) ::pause();
    });
    ASSERT_EQ(child.line(), "ready");
    child.kill();
  }
  fs::remove(path_.string() + "-shm");
  ASSERT_GT(fs::file_size(path_.string() + "-wal"), 0U);
  close();
  const std::string said = openedAs(Access::ReadOnly);
  EXPECT_THAT(said, HasSubstr("p.tiltmap-wal"));
  EXPECT_THAT(said, HasSubstr("copy both files"));
  // The way out that the message names.
  fs::permissions(folder_.path(), fs::perms::owner_all, fs::perm_options::add);
  fs::create_directory(folder_ / "copy");
  fs::copy(path_, folder_ / "copy/p.tiltmap");
  fs::copy(path_.string() + "-wal", folder_ / "copy/p.tiltmap-wal");
  EXPECT_EQ(must(Project::open(folder_ / "copy/p.tiltmap", Access::ReadOnly))->snapshot()->scans().size(),
            4U);
}

TEST_F(ReadOnlyPlace, ReadBesideALiveWriterOfSomebodyElse) {
  const auto writer = must(Project::open(path_, Access::ReadWrite));
  must(writer->apply(importEdit({sampleScan(8)})));
  close();
  EXPECT_EQ(openedAs(Access::ReadOnly), "read 4\n");
}

TEST_F(ReadOnlyPlace, WritingBehindAnUnlockedReaderIsNoticed) {
  close();
  if (!test::nobodyReaches(folder_.path()))
    GTEST_SKIP() << "needs root, and a way to " << folder_.path() << " that another user may go";
  int go[2];
  ASSERT_EQ(::pipe(go), 0);
  ChildProcess child([&](const ChildProcess::Say& say) {
    becomeNobody();
    const auto project = must(Project::open(path_, Access::ReadOnly));
    say("open");
    char c = 0;
    [[maybe_unused]] const ssize_t n = ::read(go[0], &c, 1);
    const auto image = project->snapshot()->scans()[0].image();
    say(image ? "loaded" : image.error().what);
    const auto refreshed = project->refresh();
    say(refreshed ? "refreshed" : refreshed.error().remedy);
  });
  ASSERT_EQ(child.line(), "open");
  {
    const auto writer = must(Project::open(path_, Access::ReadWrite));
    must(writer->apply(importEdit(sampleScans(2))));
  }
  ASSERT_EQ(::write(go[1], "x", 1), 1);
  EXPECT_THAT(child.line(), HasSubstr("written by another process"));
  EXPECT_THAT(child.line(), HasSubstr("open it again"));
  ::close(go[0]);
  ::close(go[1]);
}

TEST_F(FileTrouble, ASymbolicLinkIsTheSameProject) {
  const auto path = makeProject();
  fs::create_symlink(path, folder_ / "link.tiltmap");
  const auto writer = must(Project::open(folder_ / "link.tiltmap", Access::ReadWrite));
  EXPECT_FALSE(Project::open(path, Access::ReadWrite));
  EXPECT_EQ(writer->path(), fs::canonical(path));
  EXPECT_FALSE(Project::create(folder_ / "link.tiltmap"));
}

TEST_F(FileTrouble, AnInterruptedCreateLeavesTheNameFree) {
  folder_.write(".p.tiltmap.unfinished", "half a project");
  folder_.write("p.tiltmap-lock", "process 1 on nowhere");
  const auto path = makeProject();
  EXPECT_EQ(folder_.entries(), 1U);
  EXPECT_EQ(must(Project::open(path, Access::ReadOnly))->snapshot()->scans().size(), 3U);
}

}  // namespace
}  // namespace tiltmap
