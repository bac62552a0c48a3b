#include "core/project/photographs.h"

#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;
using namespace std::string_view_literals;

TEST(PictureMediaType, IsSeenByTheFirstBytes) {
  EXPECT_EQ(pictureMediaType("\xFF\xD8\xFF\xE1 Exif"sv), "image/jpeg");
  EXPECT_EQ(pictureMediaType("\x89PNG\r\n\x1A\n rest"sv), "image/png");
  EXPECT_EQ(pictureMediaType("RIFF\x10\0\0\0WEBPVP8 "sv), "image/webp");
  EXPECT_EQ(pictureMediaType("GIF89a"sv), "image/gif");
  EXPECT_EQ(pictureMediaType("II*\0\x08\0\0\0"sv), "image/tiff");
  EXPECT_EQ(pictureMediaType("MM\0*\0\0\0\x08"sv), "image/tiff");
  EXPECT_EQ(pictureMediaType("BM\x36\x03\0\0\0\0\0\0\x36"sv), "image/bmp");
  EXPECT_EQ(pictureMediaType("\0\0\0\x18"
                             "ftypheic"sv),
            "image/heif");
  for (const std::string_view text :
       {""sv, "\xFF\xD8"sv, "BMW drives by"sv, "RIFF....WAVE"sv, "II"sv, "%PDF-1.4"sv})
    EXPECT_EQ(pictureMediaType(text), "") << text;
  EXPECT_EQ(pictureExtension("image/jpeg"), ".jpg");
  EXPECT_EQ(pictureExtension("text/plain"), "");
}

class Photographs : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = must(Project::create(folder_ / "p.tiltmap"));
    must(project_->apply(importEdit(sampleScans(2))));
    file_ = folder_.write("a.png", png_);
  }
  const ScanEntry& stop(std::size_t i) { return project_->snapshot()->scans()[i]; }
  const std::string png_ = "\x89PNG\r\n\x1A\n pixels";
  TemporaryFolder folder_;
  std::filesystem::path file_;
  std::unique_ptr<Project> project_;
};

TEST_F(Photographs, KeptOnesSurviveTheirFile) {
  must(project_->apply(addPhotographEdit(stop(1), must(photographFromFile(file_, "a wall", true)))));
  std::filesystem::remove(file_);
  const auto snapshot = project_->snapshot();
  const Photograph photograph = snapshot->scans()[1].photographs.at(0);
  EXPECT_EQ(photograph.caption, "a wall");
  EXPECT_EQ(photograph.media_type, "image/png");
  EXPECT_EQ(must(photographContents(*snapshot, photograph.id)), png_);
  must(project_->apply(must(removePhotographEdit(*snapshot, photograph.id))));
  EXPECT_TRUE(stop(1).photographs.empty());
  must(project_->undo());
  EXPECT_EQ(must(photographContents(*project_->snapshot(), photograph.id)), png_);
}

TEST_F(Photographs, OutsideOnesAreReadFromTheirFile) {
  must(project_->apply(addPhotographEdit(stop(0), must(photographFromFile(file_, "", false)))));
  const auto snapshot = project_->snapshot();
  const Photograph photograph = snapshot->scans()[0].photographs.at(0);
  EXPECT_EQ(photograph.path, file_.string());
  EXPECT_EQ(photograph.bytes, 0U);
  EXPECT_EQ(must(photographContents(*snapshot, photograph.id)), png_);
  std::filesystem::remove(file_);
  const auto gone = photographContents(*snapshot, photograph.id);
  ASSERT_FALSE(gone);
  EXPECT_NE(gone.error().where.find("a.png"), std::string::npos);
}

TEST_F(Photographs, WhatIsNoPictureIsRefused) {
  for (const char* name : {"empty.jpg", "text.jpg"}) {
    const auto path = folder_.write(name, name[0] == 'e' ? "" : "not a picture at all");
    const auto refused = photographFromFile(path, "", true);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().where.find(name), std::string::npos);
    EXPECT_FALSE(refused.error().remedy.empty());
  }
  EXPECT_FALSE(photographFromFile(folder_.path(), "", true));
  EXPECT_FALSE(photographFromFile(folder_ / "none.jpg", "", true));
  const auto large = folder_.write("large.jpg", "\xFF\xD8\xFF");
  std::filesystem::resize_file(large, kLargestPicture + 1);  // a hole: takes no room
  EXPECT_FALSE(photographFromFile(large, "", true));
  const auto unknown = removePhotographEdit(*project_->snapshot(), 5);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().what.find('5'), std::string::npos);
}

}  // namespace
}  // namespace tiltmap
