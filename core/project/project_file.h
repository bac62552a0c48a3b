// The file a project lives in: telling it from others, locking it for one writer, putting a new one in its
// place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/project/database.h"

namespace tiltmap {

// Held by the one writer of a project over all processes. It is an flock on NAME.tiltmap-lock, which the
// kernel lets go when the process dies, however it dies. Not a lock on the project itself: closing a second
// descriptor of a file drops the locks that SQLite holds on it in this process.
class WriterLock {
 public:
  // Throws StoreFailure that names the holder when another has it, or when the folder cannot be written.
  explicit WriterLock(const std::filesystem::path& project);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

// Refuses, by its first bytes and without SQLite touching it, what is not a project: nothing there, a folder,
// an empty or foreign file.
void requireProjectFile(const std::filesystem::path& path);
// Symbolic links resolved, so that a project has one name; as given where there is nothing yet.
std::filesystem::path resolvedPath(const std::filesystem::path& path);

// Remembers that this process has the project's file open, so that requireProjectFile leaves it alone
// meanwhile.
class OpenFileMark {
 public:
  explicit OpenFileMark(const std::filesystem::path& path);
  ~OpenFileMark();
  OpenFileMark(const OpenFileMark&) = delete;
  OpenFileMark& operator=(const OpenFileMark&) = delete;

 private:
  std::uint64_t device_ = 0;
  std::uint64_t inode_ = 0;
};

// A connection for reading, in the gentlest way that works: beside a writer, from a folder that cannot be
// written, from a read-only medium.
class ReadingConnection {
 public:
  explicit ReadingConnection(const std::filesystem::path& path);
  const Database& database() const { return *database_; }
  // A medium that cannot be written is read without locks. Throws when somebody else did write there
  // meanwhile.
  void requireUnchanged() const;

 private:
  struct Stamp {
    std::int64_t size = 0;
    std::int64_t modified_ns = 0;
    bool operator==(const Stamp&) const = default;
  };
  Stamp stamp() const;
  std::unique_ptr<OpenFileMark> mark_;
  std::unique_ptr<Database> database_;
  bool immutable_ = false;
  Stamp stamp_;
};

// A new file, first made under a hidden name beside its own and seen under its own only when complete.
class NewProjectFile {
 public:
  // Refuses a path where something is already or a folder that cannot be written.
  explicit NewProjectFile(const std::filesystem::path& path);
  ~NewProjectFile();  // takes away what was not published
  NewProjectFile(const NewProjectFile&) = delete;
  NewProjectFile& operator=(const NewProjectFile&) = delete;

  const std::filesystem::path& workingPath() const { return working_; }
  // Durable and under its own name; all connections to the working path closed before.
  void publish();
  std::unique_ptr<WriterLock> takeLock() { return std::move(lock_); }

 private:
  void removeWorking() const;
  std::filesystem::path path_;
  std::filesystem::path working_;
  std::unique_ptr<WriterLock> lock_;
};

}  // namespace tiltmap
