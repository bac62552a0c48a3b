// Closures that contradict the other links are left out of what a relaxation computes from.
#include "core/project/operations/link_consistency.h"

#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

class LinkConsistencyTest : public ::testing::Test {
 protected:
  LinkConsistencyTest() {
    must(project_->apply(importEdit(sampleScans(6))));
    for (int i = 0; i < 6; ++i) poses_.push_back(Pose::planar(0.2 * i, 4.0 * i, 0.1 * i));
    for (int i = 1; i < 6; ++i) links_.push_back(link(i - 1, i));
  }
  Link link(int fixed, int moving, const Pose& off = {}) {
    const auto& scans = project_->snapshot()->scans();
    Link made =
        sampleLink(scans[static_cast<std::size_t>(fixed)].id, scans[static_cast<std::size_t>(moving)].id);
    made.fixed_from_moving =
        off * poses_[static_cast<std::size_t>(fixed)].inverse() * poses_[static_cast<std::size_t>(moving)];
    return made;
  }
  ConsistentLinks checked() { return must(consistentLinks(*project_->snapshot(), links_, poses_, {})); }
  double changed(const std::vector<Pose>& poses) {
    double most = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i)
      most = std::max(most, difference(poses[i], poses_[i]).translation_m);
    return most;
  }
  TemporaryFolder folder_;
  std::unique_ptr<Project> project_ = must(Project::create(folder_ / "p.tiltmap"));
  std::vector<Pose> poses_;
  std::vector<Link> links_;
};

TEST_F(LinkConsistencyTest, NeighboursAloneAreLeftAsTheyAre) {
  const ConsistentLinks found = checked();
  EXPECT_EQ(found.world_from_scan, poses_);
  EXPECT_EQ(found.links.size(), links_.size());
  EXPECT_TRUE(found.warnings.empty());
}

TEST_F(LinkConsistencyTest, AFalseClosureIsLeftOutAndNamed) {
  links_.insert(links_.begin() + 2, link(1, 5, Pose::planar(1.0, 0.0, 0.0)));
  links_.push_back(link(0, 4));
  const ConsistentLinks found = checked();
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("scans 1 and 5 contradicts the others by 1"), std::string::npos)
      << found.warnings[0];
  ASSERT_EQ(found.links.size(), links_.size() - 1);
  for (const Link& kept : found.links)
    EXPECT_FALSE(kept.fixed == links_[2].fixed && kept.moving == links_[2].moving);
  EXPECT_LT(changed(found.world_from_scan), 1e-6);
}

TEST_F(LinkConsistencyTest, ARightClosurePullsTheStarts) {
  links_.push_back(link(0, 5, Pose::planar(0.01, 0.0, 0.0)));
  const ConsistentLinks found = checked();
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_EQ(found.links.size(), links_.size());
  EXPECT_GT(changed(found.world_from_scan), 0.001);
  EXPECT_LT(changed(found.world_from_scan), 0.01);
}

TEST_F(LinkConsistencyTest, AFalseClosureSetByHandIsLeftOutAndNamedAsSuch) {
  links_.push_back(link(0, 5, Pose::planar(3.0, 0.0, 0.0)));
  links_.back().origin = LinkOrigin::ByHand;
  links_.back().information.reset();
  const ConsistentLinks found = checked();
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("link by hand of scans 0 and 5 contradicts the others by 3"),
            std::string::npos)
      << found.warnings[0];
  EXPECT_EQ(found.links.size(), links_.size() - 1);
  EXPECT_LT(changed(found.world_from_scan), 1e-6);
}

TEST_F(LinkConsistencyTest, ARightClosureSetByHandStays) {
  links_.push_back(link(0, 5, Pose::planar(0.02, 0.0, 0.0)));
  links_.back().origin = LinkOrigin::ByHand;
  links_.back().information.reset();
  const ConsistentLinks found = checked();
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_EQ(found.links.size(), links_.size());
}

TEST_F(LinkConsistencyTest, NeighboursSetByHandAreBeyondDoubt) {
  links_[3] = link(3, 4, Pose::planar(1.0, 0.0, 0.0));
  links_[3].origin = LinkOrigin::ByHand;
  const ConsistentLinks found = checked();
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_EQ(found.links.size(), links_.size());
}

TEST_F(LinkConsistencyTest, DisabledFailedAndEarlierFoundLinksSayNothing) {
  for (int k = 0; k < 3; ++k) links_.push_back(link(0, 3 + k % 2, Pose::planar(2.0, 0.0, 0.0)));
  links_[5].state = LinkState::Disabled;
  links_[6].succeeded = false;
  links_[7].stop_reason = "relaxed";
  const ConsistentLinks found = checked();
  EXPECT_EQ(found.world_from_scan, poses_);
  EXPECT_EQ(found.links.size(), links_.size());
}

}  // namespace
}  // namespace tiltmap
