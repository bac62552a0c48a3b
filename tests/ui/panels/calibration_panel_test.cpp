// The calibration panel, driven by mouse and keyboard.
#include "ui/panels/calibration_panel.h"

#include <QAbstractItemModel>
#include <QLineEdit>
#include <QPushButton>
#include <QTabWidget>
#include <QToolButton>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/body_scans.h"
#include "tests/ui/support/widget_rules.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/calibration_model.h"
#include "ui/models/calibration_table_model.h"
#include "ui/panels/table_view.h"
#include "ui/window/operation_dialog.h"

namespace tiltmap::test {
namespace {

using namespace ui;
using testing_support::kBodyAndMargin;

class CalibrationPanelTest : public WindowTest {
 protected:
  void SetUp() override {
    must(workspace().session().create(qt(folder / "survey.tiltmap")));
    window->setPerspective(Perspective::Capture);
    window->showPanel("calibration");
    settle();
    panel = qobject_cast<CalibrationPanel*>(window->docks().panel("calibration"));
    ASSERT_NE(panel, nullptr);
  }
  void runNow(const std::string& operation, const ParameterValues& values) {
    JobRequest request;
    request.operation = operations().find(operation);
    request.values = values;
    ASSERT_TRUE(workspace().start(request));
    ASSERT_TRUE(waitForJobs());
    settle();
  }
  void addSurvey() {
    runNow("simulate", {{"experiment", std::string("loop")},
                        {"seed", 3LL},
                        {"stops", 4LL},
                        {"plant", std::string("range-offset=0.03")}});
    runNow("register", {});
  }
  void addBody(int scans) {
    must(workspace().session().apply(importEdit(testing_support::scansWithBody(scans))));
    settle();
  }
  bool comes(CalibrationPage& page, FindingState state) {
    const bool came = waitUntil([&] { return page.model().state() == state; });
    settle();
    return came;
  }
  QString sentence(const QString& operation) { return find<QLabel>(operation + "-sentence")->text(); }
  bool isEnabled(const QString& name) { return find(name)->isEnabled(); }
  std::size_t points(std::size_t scan) { return (*snapshot().scans()[scan].image())->validCells(); }
  QString cell(CalibrationPage& page, int row, CalibrationTableModel::Column column) {
    return page.table()->model()->index(row, column).data().toString();
  }
  void expectNothingCutOff() {
    EXPECT_EQ(window->size(), QSize(1366, 768));
    for (const std::string& text : cutOff(*panel)) ADD_FAILURE() << "cut off: " << text;
  }
  // To be looked at, where TILTMAP_PICTURES names a folder.
  void take(const char* name) {
    const char* where = std::getenv("TILTMAP_PICTURES");
    if (!where) return;
    for (const bool dark : {true, false}) {
      preferences.setTheme(dark ? ThemeChoice::Dark : ThemeChoice::Light);
      settle();
      const QString file = QString("%1/%2-%3.png").arg(where, name, dark ? "dark" : "light");
      EXPECT_TRUE(window->grab().save(file));
    }
  }

  CalibrationPanel* panel = nullptr;
};

TEST_F(CalibrationPanelTest, ErrorsOfTheScannerAreFoundByMouseAndTakenBack) {
  EXPECT_FALSE(isEnabled("calibrate-run"));
  EXPECT_FALSE(isEnabled("calibrate-apply"));
  EXPECT_TRUE(sentence("calibrate").contains("three overlapping scans"))
      << sentence("calibrate").toStdString();
  take("calibration-nothing");
  addSurvey();
  window->setPerspective(Perspective::Capture);
  window->showPanel("calibration");
  settle();
  ASSERT_TRUE(isEnabled("calibrate-run")) << sentence("calibrate").toStdString();
  take("calibration-before");
  click("calibrate-run");
  ASSERT_TRUE(comes(panel->errors(), FindingState::Proposal));
  EXPECT_TRUE(sentence("calibrate").contains("proposal")) << sentence("calibrate").toStdString();
  EXPECT_EQ(panel->errors().table()->model()->rowCount(), 8);
  take("calibration-proposal");
  expectNothingCutOff();
  EXPECT_FALSE(isEnabled("calibrate-run"));
  click("calibrate-discard");
  EXPECT_EQ(snapshot().scans()[0].geometry.range_offset_m, 0.0);
  EXPECT_TRUE(sentence("calibrate").contains("as it was"));

  // The same with the form: the range offset alone.
  click("calibrate-parameters");
  for (const char* other : {"tilt-zero", "mounting", "lever-arm"})
    panel->errors().model().parameters().setValue(other, false);
  take("calibration-parameters");
  expectNothingCutOff();
  click("calibrate-run");
  EXPECT_TRUE(panel->errors().table()->isVisible()) << "the table has its place again";
  ASSERT_TRUE(comes(panel->errors(), FindingState::Proposal));
  EXPECT_EQ(cell(panel->errors(), 7, CalibrationTableModel::Quantity), "Range offset");
  EXPECT_NEAR(cell(panel->errors(), 7, CalibrationTableModel::Found).toDouble(), 30.0, 4.0);
  EXPECT_GT(cell(panel->errors(), 7, CalibrationTableModel::Deviation).toDouble(), 0.0);
  click("calibrate-apply");
  EXPECT_NEAR(snapshot().scans()[0].geometry.range_offset_m, 0.03, 0.004);
  EXPECT_TRUE(sentence("calibrate").contains("Applied"));
  take("calibration-applied");
  press(QKeySequence::Undo);
  EXPECT_EQ(snapshot().scans()[0].geometry.range_offset_m, 0.0);
  EXPECT_FALSE(sentence("calibrate").contains("Applied"));
}

TEST_F(CalibrationPanelTest, TheBodyIsFoundByKeyboard) {
  addBody(4);
  find<QTabWidget>("calibration-tabs")->setCurrentIndex(1);
  settle();
  auto* scans = find<QLineEdit>("body-mask-scans");
  scans->setFocus();
  QTest::keyClicks(scans, "9");
  settle();
  EXPECT_FALSE(isEnabled("body-mask-run"));
  EXPECT_TRUE(sentence("body-mask").contains("9")) << sentence("body-mask").toStdString();
  QTest::keyClick(scans, Qt::Key_Backspace);
  QTest::keyClicks(scans, "0-2");
  settle();
  QTest::keyClick(scans, Qt::Key_Return);
  ASSERT_TRUE(comes(panel->body(), FindingState::Proposal));
  EXPECT_FALSE(scans->isEnabled());
  EXPECT_EQ(cell(panel->body(), 1, CalibrationTableModel::Found), QString::number(kBodyAndMargin));
  take("body-proposal");
  expectNothingCutOff();
  find("body-mask-apply")->setFocus();
  QTest::keyClick(find("body-mask-apply"), Qt::Key_Space);
  settle();
  EXPECT_EQ(points(0), 120U - kBodyAndMargin);
  EXPECT_EQ(points(3), 120U) << "was not named";
  EXPECT_TRUE(sentence("body-mask").contains("Applied"));
  press(QKeySequence::Undo);
  EXPECT_EQ(points(0), 120U);
}

TEST_F(CalibrationPanelTest, TheSelectedScansAreTaken) {
  addBody(4);
  panel->showPage("body-mask");
  settle();
  EXPECT_FALSE(isEnabled("body-mask-selected"));
  workspace().selection().setScans({id(1), id(2)});
  settle();
  click("body-mask-selected");
  EXPECT_EQ(find<QLineEdit>("body-mask-scans")->text(), "1-2");
  EXPECT_EQ(panel->body().model().scansText(), "1-2");
}

TEST_F(CalibrationPanelTest, WhatTheDialogProposesIsDecidedHere) {
  addBody(3);
  window->setPerspective(Perspective::Inspect);
  window->showOperation("body-mask");
  settle();
  OperationDialog* dialog = window->operationDialog("body-mask");
  ASSERT_NE(dialog, nullptr);
  click("run", dialog);
  ASSERT_TRUE(comes(panel->body(), FindingState::Proposal));
  EXPECT_TRUE(window->docks().isShown("calibration"));
  EXPECT_EQ(find<QTabWidget>("calibration-tabs")->currentIndex(), 1);
  EXPECT_EQ(points(1), 120U);
  click("body-mask-apply");
  EXPECT_EQ(points(1), 120U - kBodyAndMargin);
}

TEST_F(CalibrationPanelTest, NothingIsCutOffInEitherLook) {
  addBody(3);
  for (const ThemeChoice look : {ThemeChoice::Light, ThemeChoice::Dark, ThemeChoice::HighContrast}) {
    preferences.setTheme(look);
    for (const char* page : {"calibrate", "body-mask"}) {
      panel->showPage(page);
      settle();
      expectNothingCutOff();
    }
  }
  preferences.setTheme(ThemeChoice::Light);
}

}  // namespace
}  // namespace tiltmap::test
