// Calibrations of a window: computed, looked at, applied, taken back; without a widget.
#include "ui/models/calibration_model.h"

#include "core/project/operations/index_list.h"
#include "tests/support/body_scans.h"
#include "tests/ui/models/model_samples.h"
#include "tests/ui/support/held_operation.h"
#include "ui/models/calibration_table_model.h"

namespace tiltmap::test {

using namespace ui;
using testing_support::kBodyAndMargin;
using testing_support::kBodyCells;

class CalibrationModelTest : public WorkspaceTest {
 protected:
  CalibrationModelTest() : errors(workspace, "calibrate"), body(workspace, "body-mask") {}

  void runNow(const std::string& operation, const ParameterValues& values) {
    JobRequest request;
    request.operation = operations().find(operation);
    request.values = values;
    const int job = *workspace.start(request);
    ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(job)->over(); }));
    ASSERT_EQ(workspace.jobs().find(job)->phase, JobPhase::Accepted);
  }
  void openSurvey() {
    must(workspace.session().create(qt(folder / "survey.tiltmap")));
    runNow("simulate", {{"experiment", std::string("loop")},
                        {"seed", 3LL},
                        {"stops", 4LL},
                        {"plant", std::string("range-offset=0.03")}});
    runNow("register", {});
    for (const char* other : {"tilt-zero", "mounting", "lever-arm"})
      errors.parameters().setValue(other, false);
  }
  void openBody(int scans) {
    must(workspace.session().create(qt(folder / "body.tiltmap")));
    must(workspace.session().apply(importEdit(testing_support::scansWithBody(scans))));
  }
  bool comes(CalibrationModel& model, FindingState state) {
    return waitUntil([&] { return model.state() == state; });
  }
  double offset(std::size_t scan) { return snapshot().scans()[scan].geometry.range_offset_m; }
  std::size_t points(std::size_t scan) { return (*snapshot().scans()[scan].image())->validCells(); }
  const FindingRow* row(const CalibrationModel& model, const QString& quantity) {
    for (const FindingRow& each : model.rows())
      if (each.quantity == quantity) return &each;
    return nullptr;
  }

  CalibrationModel errors, body;
};

TEST_F(CalibrationModelTest, SaysWhatIsMissingBeforeItCanRun) {
  EXPECT_EQ(errors.state(), FindingState::Nothing);
  EXPECT_TRUE(errors.whyNotRun().contains("project")) << errors.whyNotRun().toStdString();
  makeProject(2);
  EXPECT_TRUE(errors.whyNotRun().contains("three overlapping scans")) << errors.whyNotRun().toStdString();
  errors.run();
  EXPECT_EQ(errors.state(), FindingState::Nothing) << "what cannot run does not begin";
  EXPECT_TRUE(body.whyNotRun().isEmpty());
  body.useScans("7");
  EXPECT_TRUE(body.whyNotRun().contains("7")) << body.whyNotRun().toStdString();
  body.useScans("");
  EXPECT_TRUE(body.whyNotRun().isEmpty());
  body.parameters().setValueText("within", "far");
  EXPECT_TRUE(body.whyNotRun().contains("not allowed")) << body.whyNotRun().toStdString();
}

TEST_F(CalibrationModelTest, AnEstimateIsAProposalWithItsUncertaintyUntilItIsApplied) {
  openSurvey();
  ASSERT_TRUE(errors.whyNotRun().isEmpty()) << errors.whyNotRun().toStdString();
  const auto revision = snapshot().revision();
  errors.run();
  EXPECT_NE(errors.state(), FindingState::Nothing);
  ASSERT_TRUE(comes(errors, FindingState::Proposal));
  EXPECT_EQ(snapshot().revision(), revision) << "nothing is stored yet";
  EXPECT_FALSE(errors.whyNotRun().isEmpty()) << "one at a time";
  ASSERT_EQ(errors.rows().size(), 8U);
  const FindingRow* range = row(errors, "Range offset");
  ASSERT_NE(range, nullptr);
  EXPECT_TRUE(range->told);
  EXPECT_EQ(range->unit, "mm");
  EXPECT_EQ(range->before, "0.0");
  EXPECT_NEAR(range->value.toDouble(), 30.0, 4.0);
  EXPECT_GT(range->deviation.toDouble(), 0.0);
  EXPECT_LT(range->deviation.toDouble(), 4.0);
  const FindingRow* held = row(errors, "Tilt zero");
  ASSERT_NE(held, nullptr);
  EXPECT_FALSE(held->told);
  EXPECT_EQ(held->value, "–");
  EXPECT_EQ(held->unit, "°");
  EXPECT_FALSE(held->reason.isEmpty());
  EXPECT_TRUE(errors.summary().contains("4 scans")) << errors.summary().toStdString();

  errors.apply();
  EXPECT_EQ(errors.state(), FindingState::Applied);
  for (std::size_t scan = 0; scan < 4; ++scan) EXPECT_NEAR(offset(scan), 0.03, 0.004);
  EXPECT_TRUE(errors.whyNotRun().isEmpty()) << "and again, from there";
  must(workspace.session().undo());
  EXPECT_EQ(errors.state(), FindingState::TakenBack);
  EXPECT_EQ(offset(0), 0.0);
  must(workspace.session().redo());
  EXPECT_EQ(errors.state(), FindingState::Applied);
}

TEST_F(CalibrationModelTest, DiscardLeavesNoTrace) {
  openSurvey();
  const std::string before = visibleState(snapshot());
  errors.run();
  ASSERT_TRUE(comes(errors, FindingState::Proposal));
  errors.discard();
  EXPECT_EQ(errors.state(), FindingState::Discarded);
  EXPECT_EQ(visibleState(snapshot()), before);
  EXPECT_FALSE(errors.rows().empty()) << "what was found can be read on";
  must(workspace.session().create(qt(folder / "other.tiltmap")));
  EXPECT_EQ(errors.state(), FindingState::Nothing) << "it was another survey's";
  EXPECT_TRUE(errors.rows().empty());
}

TEST_F(CalibrationModelTest, TheBodyIsLeftOutOnceItIsAppliedAndThenThereIsNoneToFind) {
  openBody(3);
  body.run();
  ASSERT_TRUE(comes(body, FindingState::Proposal));
  EXPECT_EQ(points(1), 120U);
  EXPECT_EQ(row(body, "Cells that show the machine")->value, QString::number(kBodyCells));
  EXPECT_EQ(row(body, "Masked, with the margin")->value, QString::number(kBodyAndMargin));
  EXPECT_EQ(row(body, "Furthest of them")->unit, "m");
  EXPECT_TRUE(row(body, "Minimum range that keeps it out")->told);
  body.apply();
  EXPECT_EQ(body.state(), FindingState::Applied);
  for (std::size_t scan = 0; scan < 3; ++scan) EXPECT_EQ(points(scan), 120U - kBodyAndMargin);
  body.run();
  ASSERT_TRUE(comes(body, FindingState::NothingToApply));
  EXPECT_TRUE(body.sentence().contains("masked already")) << body.sentence().toStdString();
  must(workspace.session().undo());
  EXPECT_EQ(points(1), 120U);
}

TEST_F(CalibrationModelTest, OnlyTheScansChosenAreUsed) {
  openBody(5);
  EXPECT_FALSE(body.canUseSelected());
  workspace.selection().setScans({id(4), id(1), id(2)});
  ASSERT_TRUE(body.canUseSelected());
  body.useSelected();
  EXPECT_EQ(body.scansText(), "1-2,4");
  EXPECT_EQ(must(parseIndexesOrAll("1-2,4", 5, "")), (std::vector<int>{1, 2, 4}));
  body.run();
  ASSERT_TRUE(comes(body, FindingState::Proposal));
  EXPECT_TRUE(body.summary().contains("3 scans")) << body.summary().toStdString();
  body.apply();
  EXPECT_EQ(points(0), 120U);
  EXPECT_EQ(points(1), 120U - kBodyAndMargin);
  EXPECT_EQ(points(3), 120U);
}

TEST_F(CalibrationModelTest, WhoeverStartsItTheProposalIsSeenHere) {
  openBody(3);
  JobRequest request;
  request.operation = operations().find("body-mask");
  request.values = {{"apply", true}};
  request.ask = true;
  ASSERT_TRUE(workspace.start(request));
  ASSERT_TRUE(comes(body, FindingState::Proposal));
  EXPECT_EQ(errors.state(), FindingState::Nothing) << "another operation's";
  body.discard();
  // Without an asker it is stored at once.
  runNow("body-mask", {{"apply", true}});
  EXPECT_EQ(body.state(), FindingState::Applied);
}

TEST_F(CalibrationModelTest, CancelledWhileItWaitsNothingHasChanged) {
  openBody(3);
  HeldOperation held;
  JobRequest first;
  first.operation = &held;
  const int before = *workspace.start(first);
  body.run();
  EXPECT_EQ(body.state(), FindingState::Running) << "queued behind the other";
  body.cancel();
  EXPECT_EQ(body.state(), FindingState::Cancelled);
  held.released = true;
  ASSERT_TRUE(waitUntil([&] { return workspace.jobs().find(before)->over(); }));
  EXPECT_EQ(points(1), 120U);
}

TEST_F(CalibrationModelTest, TheTableIsWhatWasFoundInTheUnitsOfTheUser) {
  openBody(3);
  CalibrationTableModel table(body);
  EXPECT_EQ(table.rowCount(), 0);
  body.run();
  ASSERT_TRUE(comes(body, FindingState::Proposal));
  ASSERT_EQ(table.rowCount(), 4);
  const auto text = [&](int at, CalibrationTableModel::Column column) {
    return table.data(table.index(at, column)).toString();
  };
  EXPECT_EQ(text(0, CalibrationTableModel::Found), QString::number(kBodyCells));
  EXPECT_EQ(text(2, CalibrationTableModel::Unit), "m");
  const double metres = text(2, CalibrationTableModel::Found).toDouble();
  EXPECT_NEAR(metres, 0.4, 0.01);
  preferences.setLengthUnit(LengthUnit::Foot);
  EXPECT_EQ(text(2, CalibrationTableModel::Unit), "ft");
  EXPECT_NEAR(text(2, CalibrationTableModel::Found).toDouble(), metres / 0.3048, 0.02);
  preferences.setLengthUnit(LengthUnit::Metre);
  for (int column = 0; column < table.columnCount(); ++column) {
    EXPECT_FALSE(table.headerData(column, Qt::Horizontal).toString().isEmpty());
    EXPECT_FALSE(table.headerData(column, Qt::Horizontal, Qt::ToolTipRole).toString().isEmpty());
  }
}

}  // namespace tiltmap::test
