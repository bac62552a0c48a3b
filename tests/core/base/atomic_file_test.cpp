#include "core/base/atomic_file.h"

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <stdlib.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "tiltmap-test-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::size_t fileCount() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static mode_t modeOf(const fs::path& path) {
    struct stat status {};
    ::stat(path.c_str(), &status);
    return status.st_mode & 07777;
  }

  fs::path folder_;
};

TEST_F(AtomicFile, WritesEveryByte) {
  std::string bytes;
  for (int k = 0; k < 300000; ++k) bytes += static_cast<char>(k % 256);
  ASSERT_TRUE(writeFileAtomically(folder_ / "map.bin", bytes));
  EXPECT_EQ(contents(folder_ / "map.bin"), bytes);
  EXPECT_EQ(fileCount(), 1U);
}

TEST_F(AtomicFile, ReplacesAndKeepsThePermissions) {
  const fs::path path = folder_ / "a";
  ASSERT_TRUE(writeFileAtomically(path, "a long first version"));
  ::chmod(path.c_str(), 0640);
  ASSERT_TRUE(writeFileAtomically(path, "second"));
  EXPECT_EQ(contents(path), "second");
  EXPECT_EQ(modeOf(path), 0640U);
  EXPECT_EQ(fileCount(), 1U);
}

TEST_F(AtomicFile, ANewFileGetsWhatTheUmaskLeaves) {
  const mode_t before = ::umask(0027);
  const Status written = writeFileAtomically(folder_ / "a", "x");
  ::umask(before);
  ASSERT_TRUE(written);
  EXPECT_EQ(modeOf(folder_ / "a"), 0640U);
}

TEST_F(AtomicFile, AnEmptyFileIsAFile) {
  ASSERT_TRUE(writeFileAtomically(folder_ / "empty", ""));
  EXPECT_TRUE(fs::exists(folder_ / "empty"));
  EXPECT_EQ(fs::file_size(folder_ / "empty"), 0U);
}

TEST_F(AtomicFile, AFailedWriterLeavesTheOldFileAndNothingElse) {
  const fs::path path = folder_ / "a";
  ASSERT_TRUE(writeFileAtomically(path, "old"));
  const Status refused = writeFileAtomically(path, [](std::ostream& stream) -> Status {
    stream << "half of the n";
    return fail("no more points", "scan 3", "wait");
  });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), (Error{"no more points", "scan 3", "wait"}));
  EXPECT_EQ(contents(path), "old");
  EXPECT_EQ(fileCount(), 1U);

  EXPECT_FALSE(writeFileAtomically(path, [](std::ostream& stream) -> Status {
    stream.setstate(std::ios::badbit);
    return {};
  }));
  EXPECT_THROW(
      (void)writeFileAtomically(path, [](std::ostream&) -> Status { throw std::runtime_error("x"); }),
      std::runtime_error);
  EXPECT_EQ(contents(path), "old");
  EXPECT_EQ(fileCount(), 1U);
}

TEST_F(AtomicFile, TheTargetIsUntouchedWhileItIsWritten) {
  const fs::path path = folder_ / "a";
  ASSERT_TRUE(writeFileAtomically(path, "old"));
  std::string seen_meanwhile;
  ASSERT_TRUE(replaceFileAtomically(path, [&](const fs::path& beside) -> Status {
    EXPECT_EQ(beside.parent_path(), folder_);
    std::ofstream(beside) << "new";
    seen_meanwhile = contents(path);
    return {};
  }));
  EXPECT_EQ(seen_meanwhile, "old");
  EXPECT_EQ(contents(path), "new");
}

TEST_F(AtomicFile, WritesThroughASymbolicLink) {
  fs::create_directory(folder_ / "far");
  ASSERT_TRUE(writeFileAtomically(folder_ / "far" / "target", "old"));
  fs::create_symlink("far/target", folder_ / "link");
  ASSERT_TRUE(writeFileAtomically(folder_ / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(contents(folder_ / "far" / "target"), "new");
  // A dangling one creates its target.
  fs::create_symlink("far/other", folder_ / "dangling");
  ASSERT_TRUE(writeFileAtomically(folder_ / "dangling", "made"));
  EXPECT_EQ(contents(folder_ / "far" / "other"), "made");
}

TEST_F(AtomicFile, APipeIsWrittenToAndStaysAPipe) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::fstream reader(pipe, std::ios::in | std::ios::out);  // both ends: opening does not wait
  ASSERT_TRUE(writeFileAtomically(pipe, "through\n"));
  std::string line;
  std::getline(reader, line);
  EXPECT_EQ(line, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST_F(AtomicFile, TakesAFileNameWithoutAFolderAndAVeryLongOne) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  const Status written = writeFileAtomically("plain", "here");
  fs::current_path(before);
  ASSERT_TRUE(written);
  EXPECT_EQ(contents(folder_ / "plain"), "here");
  ASSERT_TRUE(writeFileAtomically(folder_ / std::string(255, 'n'), "long"));
}

TEST_F(AtomicFile, SaysWhatIsWrongAndWhere) {
  const Status missing = writeFileAtomically(folder_ / "none" / "a", "x");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().where, (folder_ / "none" / "a").string());
  EXPECT_NE(missing.error().remedy.find("create the folder"), std::string::npos);

  const Status folder = writeFileAtomically(folder_, "x");
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().remedy.find("not of a folder"), std::string::npos);
  EXPECT_FALSE(writeFileAtomically("", "x"));
  EXPECT_FALSE(writeFileAtomically(folder_ / "", "x"));
}

TEST_F(AtomicFile, AReadOnlyFolderIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "the administrator may write everywhere";
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const Status refused = writeFileAtomically(folder_ / "a", "x");
  fs::permissions(folder_, fs::perms::owner_all);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().remedy.find("may write"), std::string::npos);
}

TEST_F(AtomicFile, AFullDiskIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full to stand for a full disk";
  const Status full = writeFileAtomically("/dev/full", std::string(100000, 'x'));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().where, "/dev/full");
  EXPECT_NE(full.error().remedy.find("free some space"), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
