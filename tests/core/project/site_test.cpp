// Pins, the picture of the site, link quality, and a snapshot with proposed poses.
#include <fstream>

#include <gtest/gtest.h>

#include "core/products/png.h"
#include "core/project/link_quality.h"
#include "core/project/project.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::must;

class SiteTest : public ::testing::Test {
 protected:
  SiteTest() {
    project_ = must(Project::create(folder_ / "p.tiltmap"));
    must(project_->apply(importEdit(test::sampleScans(4))));
  }
  const ProjectSnapshot& now() { return *project_->snapshot(); }
  ScanId id(std::size_t i) { return now().scans()[i].id; }
  std::filesystem::path picture() {
    const auto file = folder_ / "aerial.png";
    RgbImage image(40, 30, Rgb{10, 120, 30});
    image.at(5, 6) = Rgb{250, 0, 0};
    must(writePng(file, image));
    return file;
  }
  static SitePicturePoints points() { return {{{{0, 0}, {0, 10}}, {{40, 0}, {20, 10}}}}; }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
};

TEST_F(SiteTest, PinsAreKeptUndoneAndReopened) {
  must(project_->apply(pinsEdit(now(), {id(3), id(1)})));
  EXPECT_EQ(now().pins(), (std::vector<ScanId>{id(1), id(3)}));
  const Change change = must(project_->undo());
  EXPECT_TRUE(change.survey_changed);
  EXPECT_TRUE(now().pins().empty());
  must(project_->redo());
  const ScanId gone = id(1);
  must(project_->apply(deleteEdit(now(), {gone})));
  EXPECT_EQ(now().pins().size(), 1U) << "a scan that is gone is not pinned";
  must(project_->undo());
  EXPECT_TRUE(now().isPinned(gone));
  SurveyInfo survey = now().survey();
  survey.site = "yard";
  must(project_->apply(surveyEdit(survey)));
  EXPECT_EQ(now().pins().size(), 2U) << "other entries of the survey leave the pins alone";
  project_.reset();
  project_ = must(Project::open(folder_ / "p.tiltmap", Access::ReadWrite));
  EXPECT_EQ(now().pins().size(), 2U);
  EXPECT_FALSE(project_->apply(ProjectEdit{"pin", {SetPins{{987}}}, nullptr, {}, {}}));
}

TEST_F(SiteTest, TwoPointsPlaceAPicture) {
  const auto placed = must(SitePicturePlacement::make(points()));
  EXPECT_NEAR(placed.metresPerPixel(), 0.5, 1e-12);
  EXPECT_LT((placed.worldOf({0, 0}) - Eigen::Vector2d(0, 10)).norm(), 1e-9);
  EXPECT_LT((placed.worldOf({40, 20}) - Eigen::Vector2d(20, 0)).norm(), 1e-9) << "down is towards -y";
  EXPECT_LT((placed.pictureOf(placed.worldOf({13, 7})) - Eigen::Vector2d(13, 7)).norm(), 1e-9);
  // Turned by a quarter: what is to the right in the picture is ahead in the world.
  const auto turned = must(SitePicturePlacement::make({{{{0, 0}, {0, 0}}, {{10, 0}, {0, 10}}}}));
  EXPECT_LT((turned.worldOf({0, 10}) - Eigen::Vector2d(10, 0)).norm(), 1e-9);
  EXPECT_FALSE(SitePicturePlacement::make({{{{5, 5}, {0, 0}}, {{5, 5}, {1, 1}}}}));
  EXPECT_FALSE(SitePicturePlacement::make({{{{5, 5}, {1, 1}}, {{9, 5}, {1, 1}}}}));
  EXPECT_FALSE(SitePicturePlacement::make({{{{5, 5}, {std::nan(""), 1}}, {{9, 5}, {1, 1}}}}));
}

TEST_F(SiteTest, ThePictureOfTheSiteIsStoredUndoneAndSurvivesCompaction) {
  EXPECT_FALSE(now().sitePictureBytes());
  must(project_->apply(must(sitePictureEdit(picture(), points()))));
  ASSERT_TRUE(now().sitePicture());
  EXPECT_EQ(now().sitePicture()->name, "aerial.png");
  EXPECT_EQ(now().sitePicture()->media_type, "image/png");
  std::ifstream file(picture(), std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(must(now().sitePictureBytes()), bytes);
  SitePicturePoints other = points();
  other[1].world_m = {30, 10};
  const Change placed = must(project_->apply(must(placeSitePictureEdit(now(), other))));
  EXPECT_TRUE(placed.survey_changed);
  EXPECT_EQ(now().sitePicture()->points[1].world_m, Eigen::Vector2d(30, 10));
  must(project_->undo());
  EXPECT_EQ(now().sitePicture()->points[1].world_m, Eigen::Vector2d(20, 10));
  must(project_->compact());
  EXPECT_EQ(must(now().sitePictureBytes()), bytes);
  must(project_->verify());
  must(project_->apply(must(removeSitePictureEdit(now()))));
  EXPECT_FALSE(now().sitePicture());
  EXPECT_FALSE(removeSitePictureEdit(now()));
  EXPECT_FALSE(placeSitePictureEdit(now(), points()));
  must(project_->undo());
  EXPECT_EQ(must(now().sitePictureBytes()), bytes);
  EXPECT_FALSE(sitePictureEdit(folder_ / "p.tiltmap", points())) << "no picture";
}

TEST_F(SiteTest, ProposedPosesAreInASnapshotOfTheirOwn) {
  const SnapshotPtr before = project_->snapshot();
  const SnapshotPtr proposed =
      before->withPoses(Stage::Relaxed, {{id(2), test::samplePose(77)}, {999, Pose()}});
  EXPECT_FALSE(before->hasStage(Stage::Relaxed));
  ASSERT_TRUE(proposed->hasStage(Stage::Relaxed));
  EXPECT_EQ(*proposed->poses(Stage::Relaxed)[2], test::samplePose(77));
  EXPECT_TRUE(proposed->scans()[2].image()) << "with the same matrices";
}

TEST_F(SiteTest, LinksAreJudgedByStatedLimits) {
  const auto poses = now().filledPoses(Stage::Odometry);
  const auto between = [&](std::size_t a, std::size_t b) {
    Link link = test::sampleLink(id(a), id(b));
    link.fixed_from_moving = poses[a].inverse() * poses[b];
    return link;
  };
  Link good = between(0, 1), small = between(1, 2), off = between(2, 3), failed = between(0, 3),
       disabled = between(0, 2);
  small.overlap = 0.2;
  off.fixed_from_moving = Pose::planar(0.5, 0, 0) * off.fixed_from_moving;
  failed.succeeded = false;
  disabled.state = LinkState::Disabled;
  ProjectEdit edit{"links", {AddLinks{{good, small, off, failed, disabled}, true}}, nullptr, {}, {}};
  must(project_->apply(edit));
  const auto judged = judgeLinks(now(), Stage::Odometry);
  ASSERT_EQ(judged.size(), 5U);
  EXPECT_EQ(judged[0].quality, LinkQuality::Good);
  EXPECT_EQ(judged[1].quality, LinkQuality::Fair);
  EXPECT_NE(judged[1].reason.find("20 %"), std::string::npos);
  EXPECT_EQ(judged[2].quality, LinkQuality::Doubtful);
  EXPECT_NEAR(judged[2].off.translation_m, 0.5, 1e-9);
  EXPECT_EQ(judged[3].quality, LinkQuality::Failed);
  EXPECT_EQ(judged[4].quality, LinkQuality::Disabled);
  EXPECT_GT(judged[3].badness, judged[2].badness);
  EXPECT_GT(judged[2].badness, judged[1].badness);
  EXPECT_GT(judged[1].badness, judged[0].badness);
  EXPECT_GT(judged[0].badness, judged[4].badness);
}

}  // namespace
}  // namespace tiltmap
