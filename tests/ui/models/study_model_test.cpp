// What lies inside a registration, without widgets.
#include "ui/models/study_model.h"

#include "core/world/experiment.h"
#include "tests/ui/models/model_samples.h"

namespace tiltmap::test {
namespace {

class StudyModelTest : public WorkspaceTest {
 protected:
  void SetUp() override {
    must(workspace.session().create(ui::qt(folder / "s.tiltmap")));
    std::vector<Scan> scans;
    for (const SimulatedStop& stop : must(simulateExperiment(ExperimentId::Exp2Fixed, 1, 2, 2)))
      scans.push_back(stop.scan);
    must(workspace.session().apply(importEdit(std::move(scans))));
    stepper().setPace(0);
  }
  ui::StepperModel& stepper() { return workspace.stepper(); }
  ui::StudyModel& study() { return ui::StudyModel::of(stepper()); }
  void stepOnce() {
    const int before = stepper().count();
    stepper().step();
    ASSERT_TRUE(waitUntil([&] { return stepper().count() == before + 1; }));
  }
};

TEST_F(StudyModelTest, ThereIsOneForAStepper) {
  EXPECT_EQ(&study(), &study());
}

TEST_F(StudyModelTest, TheTreeIsSearchedFromThePickedPair) {
  stepper().parameters().setPreset("thesis");
  study().setTreeShown(true);
  EXPECT_TRUE(study().cells().empty());
  EXPECT_FALSE(study().treeSentence().isEmpty());
  stepOnce();
  study().setTreeDepth(2);
  EXPECT_EQ(study().cells().size(), 7U);
  EXPECT_FALSE(study().visit());
  stepper().pick(3);
  ASSERT_TRUE(study().visit());
  const TracedPair& pair = stepper().pairs()[3];
  const Eigen::Vector3d query = stepper().poseBefore() * pair.moving_point;
  EXPECT_LT((study().query() - query).norm(), 1e-12);
  const KdTree& tree = *stepper().attempt()->fixed->tree;
  EXPECT_EQ(study().visit()->nearest.index, tree.nearest(query).index);
  // The partner that the thesis' choice takes lies in the leaf of the nearest.
  const KdTree::Leaf leaf = study().visit()->leaves[study().visit()->holder].leaf;
  bool in_leaf = false;
  for (const std::uint32_t i : tree.order().subspan(leaf.first, leaf.count)) in_leaf |= i == pair.pair.fixed;
  EXPECT_TRUE(in_leaf);
  EXPECT_FALSE(study().treeSentence().contains("for comparison"));
  study().setTreeShown(false);
  EXPECT_FALSE(study().visit());
  EXPECT_TRUE(study().treeSentence().isEmpty());
}

TEST_F(StudyModelTest, SlicesStandBesideTheWholeScans) {
  study().matchSlices();
  ASSERT_TRUE(waitUntil([this] { return study().slices().has_value(); }));
  EXPECT_FALSE(study().comparison());
  EXPECT_TRUE(study().sliceSentence().contains("Run the whole scans"));
  stepper().run();
  ASSERT_TRUE(waitUntil([this] { return stepper().isEnded(); }));
  if (study().slices()->succeeded()) {
    const auto compared = study().comparison();
    ASSERT_TRUE(compared);
    const Pose whole = stepper().result()->fixed_from_moving;
    EXPECT_EQ(compared->shift_m, compareSlice(study().slices()->fixed_from_moving, whole).shift_m);
    EXPECT_NE(compared->height_m, 0.0);
  }
  stepper().start().nudge({0.1, 0.0, 0.0}, 0.0);
  EXPECT_FALSE(study().slices());  // of another start
}

}  // namespace
}  // namespace tiltmap::test
