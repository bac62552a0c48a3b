// Residuals in the background.
#include "ui/models/residuals.h"

#include <cmath>

#include "core/products/residuals.h"
#include "tests/support/room_scene.h"
#include "tests/ui/models/model_samples.h"

namespace tiltmap::test {
namespace {

class ResidualsModelTest : public WorkspaceTest {
 protected:
  void SetUp() override {
    must(workspace.session().create(ui::qt(folder / "rooms.tiltmap")));
    std::vector<Scan> scans;
    for (int i = 0; i < 3; ++i) {
      const Pose truth = Pose::planar(0.3 * i, 0.2 * i, 0.1 * i);
      scans.push_back(test_support::sceneScan(test_support::roomScene(), truth, 0.005,
                                              static_cast<std::uint64_t>(i + 1)));
      scans.back().odometry =
          i == 0 ? truth : truth.moved((Vector6d() << 0, 0, 0, 0.05, 0.02, 0.04).finished());
    }
    must(workspace.session().apply(importEdit(std::move(scans))));
  }
  ui::ResidualsPtr waited(std::size_t scan, Stage stage) {
    EXPECT_TRUE(waitUntil([&] { return workspace.residuals().of(id(scan), stage) != nullptr; }));
    return workspace.residuals().of(id(scan), stage);
  }
};

TEST_F(ResidualsModelTest, ComeLaterAndAreThoseOfTheCore) {
  int changes = 0;
  QObject::connect(&workspace.residuals(), &ui::Residuals::changed, [&changes] { ++changes; });
  EXPECT_EQ(workspace.residuals().of(id(1), Stage::Odometry), nullptr);
  EXPECT_EQ(workspace.residuals().wanted(), 1);
  const auto values = waited(1, Stage::Odometry);
  ASSERT_NE(values, nullptr);
  EXPECT_GT(changes, 0);
  const auto expected = must(ProjectResiduals(workspace.snapshot(), Stage::Odometry).of(1));
  ASSERT_EQ(values->size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_TRUE((*values)[i] == expected[i] || (std::isnan((*values)[i]) && std::isnan(expected[i])));
  EXPECT_TRUE(waitUntil([&] { return !workspace.residuals().isComputing(); }));
  EXPECT_EQ(workspace.residuals().wanted(), 0);
}

TEST_F(ResidualsModelTest, AreComputedAnewOnlyWhereSomethingChanged) {
  const auto before = waited(1, Stage::Odometry);
  must(workspace.session().apply(renameEdit(id(0), "renamed")));
  EXPECT_EQ(workspace.residuals().of(id(1), Stage::Odometry), before);  // the very same
  must(workspace.session().apply(
      posesEdit(Stage::Truth, {{id(0), Pose()}, {id(1), Pose::planar(0.3, 0.2, 0.1)}})));
  EXPECT_EQ(workspace.residuals().of(id(1), Stage::Odometry), before);
  const auto after = waited(1, Stage::Truth);
  ASSERT_NE(after, nullptr);
  EXPECT_LT(summaryOf(*after).median_m, summaryOf(*before).median_m);
}

TEST_F(ResidualsModelTest, AllScansAtOnceAndNothingWithoutAProject) {
  EXPECT_TRUE(workspace.residuals().ofAll(Stage::Odometry).empty());
  EXPECT_EQ(workspace.residuals().wanted(), 3);
  EXPECT_TRUE(waitUntil([&] { return workspace.residuals().ofAll(Stage::Odometry).size() == 3; }));
  EXPECT_EQ(workspace.residuals().of(999, Stage::Odometry), nullptr);
  // Closing in the middle of the work stops it.
  must(workspace.session().apply(posesEdit(Stage::Truth, {{id(0), Pose::planar(1, 1, 1)}})));
  (void)workspace.residuals().ofAll(Stage::Truth);
  QCoreApplication::processEvents();
  workspace.session().close();
  EXPECT_FALSE(workspace.residuals().isComputing());
  EXPECT_TRUE(workspace.residuals().ofAll(Stage::Odometry).empty());
}

}  // namespace
}  // namespace tiltmap::test
