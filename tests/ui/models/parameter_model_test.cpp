#include "ui/models/parameter_model.h"

#include "tests/ui/models/model_samples.h"
#include "ui/models/edits.h"

namespace tiltmap::test {

using namespace ui;

TEST(ParameterModel, BeginsWithTheDefaultsAndTakesAPreset) {
  const Operation& operation = *operations().find("register");
  ParameterModel model(operation);
  EXPECT_EQ(model.values(), must(operation.presetValues("default")));
  EXPECT_EQ(model.changedCount(), 0);
  model.setPreset("thesis");
  EXPECT_EQ(model.values(), must(operation.presetValues("thesis")));
  EXPECT_TRUE(model.changes().empty());
  model.setPreset("no such preset");
  EXPECT_EQ(model.preset(), "thesis");
}

TEST(ParameterModel, KeepsAWrongTextUntilItIsMended) {
  ParameterModel model(*operations().find("register"));
  const ParameterValues before = model.values();
  model.setValueText("threads", "many");
  EXPECT_TRUE(model.hasErrors());
  EXPECT_EQ(model.valueText("threads"), "many");
  EXPECT_EQ(model.values(), before);
  ASSERT_TRUE(model.error("threads"));
  EXPECT_FALSE(model.error("threads")->remedy.empty());
  model.setValueText("threads", "2");
  EXPECT_FALSE(model.hasErrors());
  EXPECT_EQ(std::get<long long>(model.changes().at("threads")), 2);
  model.setValueText("threads", "1000");
  EXPECT_TRUE(model.hasErrors()) << "out of range";
  model.reset("threads");
  EXPECT_EQ(model.values(), before);
  EXPECT_FALSE(model.hasErrors());
}

TEST(ParameterModel, RestoresWhatStillFits) {
  ParameterModel model(*operations().find("register"));
  model.restore({"thesis", {{"threads", 3LL}, {"gone-since", 1.0}, {"pairs", 5LL}}});
  EXPECT_EQ(model.preset(), "thesis");
  EXPECT_EQ(model.valueText("threads"), "3");
  EXPECT_EQ(model.changedCount(), 1);
  EXPECT_EQ(model.last().values.size(), 1U);
}

TEST(ParameterModel, DescribesEveryParameterOfEveryOperation) {
  for (const Operation* operation : operations().all())
    for (const ParameterInfo& info : operation->parameters()) {
      EXPECT_FALSE(parameterLabel(info).isEmpty());
      EXPECT_TRUE(parameterTip(info).contains("--" + qt(info.name)));
      if (info.minimum && !info.unit.empty()) {
        EXPECT_TRUE(parameterRange(info).endsWith(qt(info.unit)));
      }
    }
}

class EditsTest : public WorkspaceTest {};

TEST_F(EditsTest, ReorderMovesTogetherAndKnowsWhenNothingMoves) {
  makeProject(5);
  const auto ids = scanIds(snapshot());
  must(workspace.session().apply(reorderEdit(snapshot(), {ids[1], ids[3]}, 5)));
  EXPECT_EQ(scanIds(snapshot()), (std::vector<ScanId>{ids[0], ids[2], ids[4], ids[1], ids[3]}));
  EXPECT_TRUE(reorderEdit(snapshot(), {ids[0]}, 0).empty());
  EXPECT_TRUE(reorderEdit(snapshot(), {ids[0]}, 1).empty()) << "before its own neighbour is where it is";
}

TEST_F(EditsTest, LinksAreDisabledEnabledAndDeleted) {
  makeProject(3);
  must(workspace.session().apply(sampleRegister(workspace.snapshot())));
  const LinkId first = snapshot().links()[0].id, second = snapshot().links()[1].id;
  must(workspace.session().apply(linkStatesEdit(snapshot(), {first, second}, LinkState::Disabled)));
  EXPECT_FALSE(snapshot().findLink(first)->usable());
  EXPECT_TRUE(linkStatesEdit(snapshot(), {first}, LinkState::Disabled).empty());
  must(workspace.session().apply(deleteLinksEdit(snapshot(), {first})));
  EXPECT_EQ(snapshot().links().size(), 1U);
  must(workspace.session().undo());
  EXPECT_EQ(snapshot().links().size(), 2U);
}

}  // namespace tiltmap::test
