#include "core/project/photographs.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/io/file_bytes.h"

namespace tiltmap {

namespace {

struct PictureKind {
  const char* media_type;
  const char* extension;
};

constexpr std::array kKinds = {PictureKind{"image/jpeg", ".jpg"},  PictureKind{"image/png", ".png"},
                               PictureKind{"image/webp", ".webp"}, PictureKind{"image/gif", ".gif"},
                               PictureKind{"image/tiff", ".tif"},  PictureKind{"image/bmp", ".bmp"},
                               PictureKind{"image/heif", ".heic"}};

bool beginsWith(std::string_view bytes, std::string_view with, std::size_t at = 0) {
  return bytes.size() >= at + with.size() && bytes.substr(at, with.size()) == with;
}

// The stop and its photograph of that number.
Result<std::pair<const ScanEntry*, const Photograph*>> foundPhotograph(const ProjectSnapshot& snapshot,
                                                                       std::int64_t id) {
  std::string known;
  for (const ScanEntry& scan : snapshot.scans())
    for (const Photograph& photograph : scan.photographs) {
      if (photograph.id == id) return std::pair(&scan, &photograph);
      known += (known.empty() ? "" : ", ") + std::to_string(photograph.id);
    }
  return fail("there is no photograph " + std::to_string(id), snapshot.path().string(),
              known.empty() ? "the project has none yet" : "choose one of: " + known);
}

}  // namespace

std::string pictureMediaType(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (beginsWith(bytes, "\xFF\xD8\xFF"sv)) return "image/jpeg";
  if (beginsWith(bytes, "\x89PNG\r\n\x1A\n"sv)) return "image/png";
  if (beginsWith(bytes, "RIFF"sv) && beginsWith(bytes, "WEBP"sv, 8)) return "image/webp";
  if (beginsWith(bytes, "GIF87a"sv) || beginsWith(bytes, "GIF89a"sv)) return "image/gif";
  if (beginsWith(bytes, "II*\0"sv) || beginsWith(bytes, "MM\0*"sv)) return "image/tiff";
  // Two letters alone begin many texts; the four bytes reserved in the header are zero.
  if (beginsWith(bytes, "BM"sv) && beginsWith(bytes, "\0\0\0\0"sv, 6)) return "image/bmp";
  if (beginsWith(bytes, "ftyp"sv, 4))
    for (const std::string_view brand : {"heic"sv, "heix"sv, "mif1"sv, "msf1"sv})
      if (beginsWith(bytes, brand, 8)) return "image/heif";
  return "";
}

std::string pictureExtension(std::string_view media_type) {
  for (const PictureKind& kind : kKinds)
    if (media_type == kind.media_type) return kind.extension;
  return "";
}

Result<NewPhotograph> photographFromFile(const std::filesystem::path& path, std::string caption, bool keep) {
  std::error_code error;
  if (const auto size = std::filesystem::file_size(path, error); !error && size > kLargestPicture)
    return fail("the picture is larger than 200 MB", path.string(), "attach a smaller one");
  auto bytes = fileBytes(path);
  if (!bytes) return fail(bytes.error());
  NewPhotograph photograph;
  photograph.caption = std::move(caption);
  photograph.media_type = pictureMediaType(*bytes);
  if (photograph.media_type.empty())
    return fail("this is not a picture", path.string(),
                "give a JPEG, PNG, WebP, GIF, TIFF, BMP or HEIC file");
  if (keep)
    photograph.bytes.assign(bytes->begin(), bytes->end());
  else
    photograph.path = std::filesystem::absolute(path).lexically_normal().string();
  return photograph;
}

ProjectEdit addPhotographEdit(const ScanEntry& scan, NewPhotograph photograph) {
  ProjectEdit edit;
  edit.title = "photograph of " + scan.name;
  edit.steps.emplace_back(AddPhotograph{scan.id, std::move(photograph)});
  return edit;
}

Result<ProjectEdit> removePhotographEdit(const ProjectSnapshot& snapshot, std::int64_t photograph) {
  const auto found = foundPhotograph(snapshot, photograph);
  if (!found) return fail(found.error());
  ProjectEdit edit;
  edit.title = "remove a photograph of " + found->first->name;
  edit.steps.emplace_back(RemovePhotograph{photograph});
  return edit;
}

Result<std::string> photographContents(const ProjectSnapshot& snapshot, std::int64_t photograph) {
  const auto found = foundPhotograph(snapshot, photograph);
  if (!found) return fail(found.error());
  if (!found->second->path.empty()) return fileBytes(found->second->path);
  return found->first->photographBytes(photograph).map([](const std::vector<unsigned char>& bytes) {
    return std::string(bytes.begin(), bytes.end());
  });
}

}  // namespace tiltmap
