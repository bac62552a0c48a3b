// Pins, the picture of the site, link quality, and a snapshot with proposed poses.
#include <fstream>

#include <gtest/gtest.h>

#include "core/products/png.h"
#include "core/project/link_quality.h"
#include "core/project/project.h"
#include "core/registration/pair_judgement.h"
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

TEST_F(SiteTest, ALinkIsAsGoodAsItsScansAndTheOtherLinksSay) {
  const auto poses = now().filledPoses(Stage::Odometry);
  const auto between = [&](std::size_t a, std::size_t b, Verdict verdict, double badness) {
    Link link = test::sampleLink(id(a), id(b));
    link.fixed_from_moving = poses[a].inverse() * poses[b];
    PairJudgement judged;
    judged.verdict = verdict;
    judged.badness = badness;
    judged.reason = "made " + verdictName(verdict);
    judged.strength = strengthOf(1e6 * Matrix6d::Identity(), link.fixed_from_moving);
    link.judgement = std::make_shared<const PairJudgement>(judged);
    return link;
  };
  Link good = between(0, 1, Verdict::Good, 0.4), doubtful = between(1, 2, Verdict::Doubtful, 1.5),
       bad = between(2, 3, Verdict::Bad, 4.0), failed = between(0, 3, Verdict::Bad, 3.0),
       disabled = between(0, 2, Verdict::Good, 0.2), none = between(1, 3, Verdict::Good, 0.0);
  failed.succeeded = false;
  disabled.state = LinkState::Disabled;
  none.judgement = nullptr;
  ProjectEdit edit{"links", {AddLinks{{good, doubtful, bad, failed, disabled, none}, true}}, nullptr, {}, {}};
  must(project_->apply(edit));
  auto judged = judgeLinks(now(), Stage::Odometry);
  ASSERT_EQ(judged.size(), 6U);
  EXPECT_EQ(judged[0].quality, LinkQuality::Good);
  EXPECT_EQ(judged[0].reason, "made good");
  EXPECT_EQ(judged[1].quality, LinkQuality::Doubtful);
  EXPECT_EQ(judged[2].quality, LinkQuality::Bad);
  EXPECT_EQ(judged[3].quality, LinkQuality::Failed);
  EXPECT_EQ(judged[4].quality, LinkQuality::Disabled);
  EXPECT_EQ(judged[5].quality, LinkQuality::NotJudged);
  for (const auto& [worse, better] : {std::pair{3, 2}, {2, 1}, {1, 5}, {5, 0}, {0, 4}})
    EXPECT_GT(judged[static_cast<std::size_t>(worse)].badness,
              judged[static_cast<std::size_t>(better)].badness);
  // One that its scans find good, but no other link does.
  Link wrong = between(0, 2, Verdict::Good, 0.3);
  wrong.fixed_from_moving = wrong.fixed_from_moving * Pose::planar(0.5, 0, 0);
  Link third = between(0, 3, Verdict::Good, 0.3), fourth = between(1, 3, Verdict::Good, 0.3),
       fifth = between(2, 3, Verdict::Good, 0.3);
  must(
      project_->apply(ProjectEdit{"more", {AddLinks{{wrong, third, fourth, fifth}, true}}, nullptr, {}, {}}));
  judged = judgeLinks(now(), Stage::Odometry);
  for (const LinkJudgement& one : judged) {
    const Link& link = *now().findLink(one.link);
    if (link.fixed != id(0) || link.moving != id(2) || link.state != LinkState::Active) continue;
    EXPECT_EQ(one.quality, LinkQuality::Bad) << one.reason;
    EXPECT_NE(one.reason.find("the other links put it 50 cm"), std::string::npos) << one.reason;
    EXPECT_NEAR(one.off.translation_m, 0.5, 1e-9);
    EXPECT_NE(linkText(one).find("Other links: put it 50 cm"), std::string::npos) << linkText(one);
    EXPECT_NE(linkText(one).find("Loop: of 3 links"), std::string::npos) << linkText(one);
  }
}

}  // namespace
}  // namespace tiltmap
