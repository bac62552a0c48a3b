#include "core/io/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace tiltmap {

Result<std::string> fileBytes(const std::filesystem::path& path, const JobControl& control) {
  const std::string file = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found)
    return fail("there is no such file", file, "check the name and the folder");
  if (std::filesystem::is_directory(status))
    return fail("this is a folder, not a file", file, "name the files inside it");
  if (!std::filesystem::is_regular_file(status))
    return fail("this is not a regular file", file, "copy the data to a file on a disk first");

  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!stream)
    return fail(std::string("the file cannot be opened: ") + std::strerror(errno), file,
                "check that you may read it");
  // In pieces up to the real end: the size that the folder tells is only a hint for the first allocation.
  constexpr std::size_t kPiece = std::size_t{4} << 20;
  std::string bytes;
  const auto size = std::filesystem::file_size(path, error);
  if (!error) bytes.reserve(static_cast<std::size_t>(std::min<std::uintmax_t>(size, std::size_t{1} << 32)));
  for (;;) {
    if (control.stopRequested()) return fail(kCancelled, file, "start again when you like");
    const std::size_t before = bytes.size();
    bytes.resize(before + kPiece);
    const std::size_t got = std::fread(bytes.data() + before, 1, kPiece, stream.get());
    bytes.resize(before + got);
    if (got < kPiece) break;
  }
  if (std::ferror(stream.get()))
    return fail("the file cannot be read to its end", file, "check the disk or the connection to it");
  if (bytes.empty()) return fail("the file is empty", file, "export or copy it again");
  return bytes;
}

}  // namespace tiltmap
