#include "core/project/project_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <mutex>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "core/base/text.h"
#include "core/project/job_record.h"
#include "core/project/schema.h"

namespace tiltmap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kGivePath = "give the path of a .tiltmap file";

std::string systemText(int error) {
  return std::error_code(error, std::generic_category()).message();
}

fs::path sibling(const fs::path& path, const std::string& suffix) {
  fs::path name = path;
  name += suffix;
  return name;
}

fs::path folderOf(const fs::path& path) {
  return path.parent_path().empty() ? fs::path(".") : path.parent_path();
}

class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : value_(::open(path.c_str(), flags | O_CLOEXEC)) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int value() const { return value_; }

 private:
  int value_;
};

void syncToDisk(const fs::path& path, int flags) {
  const Descriptor descriptor(path, flags);
  if (descriptor.value() < 0 || ::fsync(descriptor.value()) != 0)
    throw StoreFailure("writing to the disk failed (" + systemText(errno) + ")", path.string(),
                       "check the disk");
}

// Files that this process has open through SQLite, by device and inode.
std::mutex& openFilesMutex() {
  static std::mutex mutex;
  return mutex;
}
std::map<std::pair<std::uint64_t, std::uint64_t>, int>& openFiles() {
  static std::map<std::pair<std::uint64_t, std::uint64_t>, int> files;
  return files;
}

std::string hostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data())
                                                          : std::string("this computer");
}

}  // namespace

WriterLock::WriterLock(const fs::path& project) : path_(sibling(project, "-lock")) {
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      const int error = errno;
      if (error == EACCES || error == EROFS || error == EPERM)
        throw StoreFailure("the project lies where nothing can be written (" + systemText(error) + ")",
                           project.string(),
                           "open it for reading, or copy it to a folder where you may write");
      if (error == ENOSPC || error == EDQUOT)
        throw StoreFailure("the disk is full", project.string(), "make room and repeat the command");
      throw StoreFailure("the project cannot be locked for writing (" + systemText(error) + ")",
                         path_.string(), "check the folder");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      std::array<char, 256> holder{};
      const ssize_t size = ::pread(descriptor_, holder.data(), holder.size(), 0);
      ::close(descriptor_);
      if (error != EWOULDBLOCK)
        throw StoreFailure("the project cannot be locked for writing (" + systemText(error) + ")",
                           path_.string(), "copy it to a local disk");
      const std::string text(holder.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
      throw StoreFailure("the project is open for writing elsewhere" + (text.empty() ? "" : ": " + text),
                         project.string(), "close it there, or open it for reading here");
    }
    // The holder before us takes the file away when it is done: what we have locked may no longer be the one
    // by that name.
    struct stat ours {};
    struct stat named {};
    if (::fstat(descriptor_, &ours) == 0 && ::stat(path_.c_str(), &named) == 0 &&
        ours.st_ino == named.st_ino && ours.st_dev == named.st_dev)
      break;
    ::close(descriptor_);
  }
  const std::string text =
      "process " + std::to_string(::getpid()) + " on " + hostName() + " since " + utcNow();
  // Information for people only; a full disk does not weaken the lock.
  if (::ftruncate(descriptor_, 0) == 0) [[maybe_unused]]
    const ssize_t written = ::pwrite(descriptor_, text.data(), text.size(), 0);
}

WriterLock::~WriterLock() {
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

OpenFileMark::OpenFileMark(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    throw StoreFailure("the project cannot be opened (" + systemText(errno) + ")", path.string(), kGivePath);
  device_ = static_cast<std::uint64_t>(status.st_dev);
  inode_ = static_cast<std::uint64_t>(status.st_ino);
  const std::lock_guard lock(openFilesMutex());
  ++openFiles()[{device_, inode_}];
}
OpenFileMark::~OpenFileMark() {
  const std::lock_guard lock(openFilesMutex());
  const auto found = openFiles().find({device_, inode_});
  if (found != openFiles().end() && --found->second == 0) openFiles().erase(found);
}

fs::path resolvedPath(const fs::path& path) {
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(path, error);
  return error ? path : resolved;
}

namespace {

std::uintmax_t logBytes(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(sibling(path, "-wal"), error);
  return error ? 0 : bytes;
}

struct Header {
  std::array<unsigned char, 100> bytes{};
  std::int64_t number(std::size_t at, std::size_t size) const {  // big-endian
    std::int64_t value = 0;
    for (std::size_t i = at; i < at + size; ++i) value = value << 8 | bytes[i];
    return value;
  }
};

// SQLite itself does not miss a part of the last page until it reads it.
void requireAllPages(const Header& header, const fs::path& path, std::int64_t size,
                     std::uintmax_t log_before) {
  const std::int64_t page = header.number(16, 2) == 1 ? 65536 : header.number(16, 2);
  const std::int64_t whole = page * header.number(28, 4);
  // With a log beside it, the file may be anything between two states, and the log completes it.
  if (size >= whole || log_before > 0 || logBytes(path) > 0) return;
  throw StoreFailure("the project file is damaged: " + std::to_string(whole - size) + " of its " +
                         std::to_string(whole) + " bytes are missing at the end",
                     path.string(),
                     "go back to a copy of it; keep this file, most of it can still be recovered");
}

}  // namespace

void requireProjectFile(const fs::path& path) {
  const std::uintmax_t log_before = logBytes(path);
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0)
    throw StoreFailure(
        errno == ENOENT ? "there is no such file" : "the file cannot be read (" + systemText(errno) + ")",
        path.string(), errno == ENOENT ? "check the path, or make a project with `tiltmap new`" : kGivePath);
  if (!S_ISREG(status.st_mode)) throw StoreFailure("this is not a file", path.string(), kGivePath);
  // Empty with a log beside it: SQLite would take the log away.
  if (status.st_size == 0)
    throw StoreFailure("the file is empty, not a Tiltmap project", path.string(),
                       "go back to a copy of the project; nothing has been written to this file");
  const std::lock_guard lock(openFilesMutex());
  if (openFiles().contains(
          {static_cast<std::uint64_t>(status.st_dev), static_cast<std::uint64_t>(status.st_ino)}))
    return;  // looked at when it was opened, and closing a descriptor of it here would drop SQLite's locks
  const Descriptor descriptor(path, O_RDONLY);
  if (descriptor.value() < 0)
    throw StoreFailure("the file cannot be read (" + systemText(errno) + ")", path.string(),
                       "check your permissions for the file");
  Header header;
  const ssize_t size = ::pread(descriptor.value(), header.bytes.data(), header.bytes.size(), 0);
  static constexpr char kMagic[16] = "SQLite format 3";
  if (size < 16 || std::memcmp(header.bytes.data(), kMagic, 16) != 0)
    throw StoreFailure("the file is not a Tiltmap project", path.string(), kGivePath);
  if (size < 100)
    throw StoreFailure("the file ends after " + std::to_string(size) + " bytes, within its header",
                       path.string(), "go back to a copy of the project");
  if (header.number(68, 4) != kApplicationId)
    throw StoreFailure("the file is an SQLite database of another program, not a Tiltmap project",
                       path.string(), kGivePath);
  requireAllPages(header, path, status.st_size, log_before);
}

ReadingConnection::ReadingConnection(const fs::path& path) : mark_(std::make_unique<OpenFileMark>(path)) {
  const bool writable = ::access(path.c_str(), W_OK) == 0 && ::access(folderOf(path).c_str(), W_OK) == 0;
  if (writable) {
    database_ = std::make_unique<Database>(path, Database::Mode::Read);
  } else if (logBytes(path) == 0) {
    immutable_ = true;
    database_ = std::make_unique<Database>(path, Database::Mode::Immutable);
    stamp_ = stamp();
  } else {
    // A log with changes: readable while its writer's shared memory file is there too.
    try {
      database_ = std::make_unique<Database>(path, Database::Mode::ReadOnly);
      database_->integer("SELECT count(*) FROM sqlite_schema");
    } catch (const StoreFailure&) {
      throw StoreFailure(
          "the project lies where nothing can be written, and its latest changes are still in " +
              sibling(path, "-wal").filename().string(),
          path.string(), "copy both files together to a folder where you may write, and open the copy");
    }
  }
}

ReadingConnection::Stamp ReadingConnection::stamp() const {
  struct stat status {};
  if (::stat(database_->path().c_str(), &status) != 0) return {};
  return {static_cast<std::int64_t>(status.st_size),
          static_cast<std::int64_t>(status.st_mtim.tv_sec) * 1'000'000'000 + status.st_mtim.tv_nsec};
}

void ReadingConnection::requireUnchanged() const {
  if (immutable_ && !(stamp() == stamp_))
    throw StoreFailure("the project was written by another process while it was open here as unchangeable",
                       database_->path().string(), "open it again");
}

NewProjectFile::NewProjectFile(const fs::path& path) : path_(path) {
  std::error_code error;
  if (fs::symlink_status(path, error).type() != fs::file_type::not_found)
    throw StoreFailure("there is something by that name already", path.string(),
                       "choose another name, or move the old one away; nothing has been overwritten");
  if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
    throw StoreFailure("this is not a name for a file", path.string(), kGivePath);
  if (!fs::is_directory(folderOf(path), error))
    throw StoreFailure("there is no such folder", folderOf(path).string(), "make the folder first");
  // A log of a project that was deleted by hand would be taken for this one's.
  for (const char* suffix : {"-wal", "-journal"})
    if (fs::exists(sibling(path, suffix), error))
      throw StoreFailure("a log of an earlier project by that name is still there",
                         sibling(path, suffix).string(), "choose another name, or move that file away");
  lock_ = std::make_unique<WriterLock>(path);
  // Under the lock nobody else works on this name, so an old one is what a killed process has left.
  std::string hidden = ".";
  hidden.append(path.filename().string()).append(".unfinished");
  working_ = folderOf(path) / hidden;
  removeWorking();
}

NewProjectFile::~NewProjectFile() {
  if (!working_.empty()) removeWorking();
}

void NewProjectFile::removeWorking() const {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) ::unlink(sibling(working_, suffix).c_str());
}

void NewProjectFile::publish() {
  syncToDisk(working_, O_RDWR);
  // Never over another file, even one that has come into being since we looked. File systems that cannot
  // rename that way can link.
  if (::renameat2(AT_FDCWD, working_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) != 0 &&
      (errno == EEXIST || ::link(working_.c_str(), path_.c_str()) != 0))
    throw StoreFailure(errno == EEXIST ? "there is something by that name already"
                                       : "the file could not be put in place (" + systemText(errno) + ")",
                       path_.string(), "choose another name; nothing has been overwritten");
  removeWorking();
  syncToDisk(folderOf(path_), O_RDONLY | O_DIRECTORY);
}

}  // namespace tiltmap
