#include "core/base/atomic_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <streambuf>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace tiltmap {

namespace {

namespace fs = std::filesystem;

std::string remedyFor(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space on the disk, or choose a folder on another one";
    case EACCES:
    case EPERM:
      return "choose a folder that you may write to";
    case EROFS:
      return "the disk can only be read: choose another folder";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or correct the path";
    case EISDIR:
      return "give the name of a file, not of a folder";
    default:
      return "check the disk, or choose another folder";
  }
}

tl::unexpected<Error> failedWith(int error, const std::string& what, const fs::path& path) {
  return fail(what + ": " + std::generic_category().message(error), path.string(), remedyFor(error));
}

// Removes the file unless told to keep it.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (kept_) return;
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  const fs::path& path() const { return path_; }
  void keep() { kept_ = true; }

 private:
  fs::path path_;
  bool kept_ = false;
};

// A new file in `folder` that nobody else has, with the permissions the umask leaves (mkstemp would hide it
// from everybody else, also after the rename). Hidden and short: a target's name may already be as long as
// allowed.
int createBeside(const fs::path& folder, fs::path& created) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 1000; ++attempt) {
    created = folder / (".tiltmap-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
    const int file = ::open(created.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0 || errno != EEXIST) return file;
  }
  return -1;
}

Status synchronise(const fs::path& path, const fs::path& named) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return failedWith(errno, "the file could not be written", named);
  const int outcome = ::fsync(file);
  const int error = errno;
  ::close(file);
  if (outcome != 0) return failedWith(error, "the file could not be brought to the disk", named);
  return {};
}

// A file that remembers why it could not be written, which std::ofstream does not.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(const fs::path& path) : file_(::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC)) {
    if (file_ < 0) error_ = errno;
    setp(buffer_.data(), buffer_.data() + buffer_.size());
  }
  FileBuffer(const FileBuffer&) = delete;
  FileBuffer& operator=(const FileBuffer&) = delete;
  ~FileBuffer() override {
    if (file_ >= 0) ::close(file_);
  }
  // 0, or the first error there was.
  int close() {
    sync();
    if (file_ >= 0 && ::close(file_) != 0 && error_ == 0) error_ = errno;
    file_ = -1;
    return error_;
  }

 protected:
  int_type overflow(int_type next) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
    return traits_type::not_eof(next);
  }
  int sync() override {
    for (const char* at = pbase(); at < pptr() && error_ == 0;) {
      const ssize_t written = ::write(file_, at, static_cast<std::size_t>(pptr() - at));
      if (written >= 0)
        at += written;
      else if (errno != EINTR)
        error_ = errno;
    }
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    return error_ == 0 ? 0 : -1;
  }

 private:
  std::array<char, 65536> buffer_{};
  int file_;
  int error_ = 0;
};

// The file that a chain of symbolic links ends at: the link is to stay a link.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  fs::path at = path;
  for (int hops = 0; hops < 40 && fs::is_symlink(at, error) && !error; ++hops) {
    const fs::path target = fs::read_symlink(at, error);
    if (error) return path;
    at = target.is_absolute() ? target : at.parent_path() / target;
  }
  return at;
}

}  // namespace

Status replaceFileAtomically(const fs::path& path, const std::function<Status(const fs::path&)>& write) {
  if (!path.has_filename()) return failedWith(EISDIR, "the file could not be written", path);
  const fs::path target = resolved(path);
  struct stat old {};
  const bool exists = ::stat(target.c_str(), &old) == 0;
  if (exists && S_ISDIR(old.st_mode)) return failedWith(EISDIR, "the file could not be written", path);
  // A device or a pipe is written to; renaming over it would destroy it.
  if (exists && !S_ISREG(old.st_mode)) return write(target);
  if (exists && ::access(target.c_str(), W_OK) != 0)
    return failedWith(errno, "the file could not be replaced", path);

  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  fs::path created;
  const int file = createBeside(folder, created);
  if (file < 0) return failedWith(errno, "the file could not be written", path);
  TemporaryFile temporary{created};
  if (exists) ::fchmod(file, old.st_mode & 07777);
  ::close(file);

  if (Status written = write(temporary.path()); !written) return written;
  if (Status synchronised = synchronise(temporary.path(), path); !synchronised) return synchronised;
  if (::rename(temporary.path().c_str(), target.c_str()) != 0)
    return failedWith(errno, "the file could not be put in its place", path);
  temporary.keep();
  // The new name is on the disk only when the folder is. Where that fails, a power cut leaves the old file or
  // the new one, whole in either case.
  (void)synchronise(folder, path);
  return {};
}

Status writeFileAtomically(const fs::path& path, const std::function<Status(std::ostream&)>& write) {
  return replaceFileAtomically(path, [&](const fs::path& beside) -> Status {
    FileBuffer buffer(beside);
    std::ostream stream(&buffer);
    if (Status written = write(stream); !written) return written;
    if (const int error = buffer.close(); error != 0)
      return failedWith(error, "the file could not be written in full", path);
    if (!stream) return failedWith(EIO, "the file could not be written in full", path);
    return {};
  });
}

Status writeFileAtomically(const fs::path& path, std::string_view bytes) {
  return writeFileAtomically(path, [bytes](std::ostream& stream) -> Status {
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return {};
  });
}

}  // namespace tiltmap
