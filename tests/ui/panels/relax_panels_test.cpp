// Relaxation runner, site map and links, driven by mouse and keyboard.
#include <QComboBox>
#include <QMenu>
#include <QMouseEvent>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QTabWidget>
#include <QToolButton>
#include <QWheelEvent>

#include <gtest/gtest.h>

#include "core/products/png.h"
#include "tests/ui/support/picture_baseline.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/relaxation_table_model.h"
#include "ui/panels/links_panel.h"
#include "ui/panels/movement_plot.h"
#include "ui/panels/relaxation_panel.h"
#include "ui/panels/site_map_panel.h"
#include "ui/panels/site_map_view.h"
#include "ui/panels/table_view.h"

namespace tiltmap::test {
namespace {

using namespace ui;

class RelaxPanelsTest : public WindowTest {
 protected:
  void SetUp() override {
    must(workspace().session().create(qt(folder / "survey.tiltmap")));
    runNow("simulate", {{"experiment", std::string("exp1")}, {"stops", 4LL}});
    runNow("register", {});
    window->setPerspective(Perspective::Relax);
    settle();
    relax = qobject_cast<RelaxationPanel*>(window->docks().panel("relax"));
    map = qobject_cast<SiteMapPanel*>(window->docks().panel("sitemap"));
    links = qobject_cast<LinksPanel*>(window->docks().panel("links"));
    ASSERT_TRUE(relax && map && links);
    window->showPanel("links");
    settle();
  }
  void runNow(const std::string& operation, const ParameterValues& values) {
    JobRequest request;
    request.operation = operations().find(operation);
    request.values = values;
    ASSERT_TRUE(workspace().start(request));
    ASSERT_TRUE(waitForJobs());
  }
  bool proposed() {
    const bool came = waitUntil([&] { return workspace().relaxation().isProposal(); });
    settle();
    return came;
  }
  // However busy the machine is: held within that step, and all of it shown.
  void runUntilHeld(int step = 1) {
    workspace().relaxation().holdNextAt(step);
    QTest::mouseClick(find("relax-run"), Qt::LeftButton);
    workspace().relaxation().holdNextAt(0);
    ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isHolding(); }));
    QElapsedTimer clock;
    clock.start();
    waitUntil([&] { return clock.elapsed() > 600; });
  }
  LinkId link(std::size_t k) { return snapshot().links()[k].id; }
  void clickLink(LinkId id) { clickIndex(links->view(), links->indexOf(id)); }
  void choose(const QString& combo, const QString& text) {
    auto* box = find<QComboBox>(combo);
    box->setCurrentText(text);
    settle();
  }
  void clickMap(const QPointF& world, Qt::KeyboardModifiers keys = {}) {
    QTest::mouseClick(&map->view(), Qt::LeftButton, keys, map->view().seen().pixelOf(world).toPoint());
    settle();
  }

  RelaxationPanel* relax = nullptr;
  SiteMapPanel* map = nullptr;
  LinksPanel* links = nullptr;
};

TEST_F(RelaxPanelsTest, RunComparesAndAccepts) {
  EXPECT_FALSE(find("relax-decision")->isVisible());
  EXPECT_FALSE(find("relax-pause")->isEnabled());
  EXPECT_FALSE(find("relax-cancel")->isEnabled());
  click("relax-run");
  ASSERT_TRUE(proposed());
  EXPECT_TRUE(find("relax-decision")->isVisible());
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_TRUE(find<QLabel>("relax-decision-text")->text().contains("nothing is stored yet"));
  const QPointF after = map->model().stops()[3].place_m;
  click("relax-before");
  EXPECT_NE(map->model().stops()[3].place_m, after) << "the map shows where the scans were";
  EXPECT_TRUE(find<QToolButton>("relax-before")->isChecked());
  click("relax-after");
  EXPECT_EQ(map->model().stops()[3].place_m, after);
  click("relax-accept");
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_FALSE(find("relax-decision")->isVisible());
  EXPECT_TRUE(find<QLabel>("relax-state")->text().contains("stored"));
  EXPECT_EQ(map->model().stops()[3].place_m, after) << "what was shown is what was stored";
  EXPECT_FALSE(find<QPlainTextEdit>("relax-log")->toPlainText().isEmpty());
}

TEST_F(RelaxPanelsTest, DiscardKeepsNothing) {
  const std::string before = visibleState(snapshot());
  click("relax-run");
  ASSERT_TRUE(proposed());
  click("relax-discard");
  EXPECT_EQ(visibleState(snapshot()), before);
  EXPECT_TRUE(find<QLabel>("relax-state")->text().contains("as it was"));
}

TEST_F(RelaxPanelsTest, PauseHoldsGoOnGoesOnAndCancelEnds) {
  choose("relax-preset", "thesis");
  runUntilHeld();
  ASSERT_TRUE(waitUntil([&] { return find<QLabel>("relax-state")->text().contains("paused"); }));
  EXPECT_EQ(find<QToolButton>("relax-pause")->text(), "Go on");
  QTest::mouseClick(find("relax-pause"), Qt::LeftButton);
  EXPECT_FALSE(workspace().relaxation().isPaused());
  QTest::mouseClick(find("relax-pause"), Qt::LeftButton);
  EXPECT_TRUE(workspace().relaxation().isPaused() || !workspace().relaxation().isRunning());
  if (!workspace().relaxation().isProposal()) workspace().relaxation().cancel();
  workspace().jobs().cancelAll();
  ASSERT_TRUE(waitForJobs());
  settle();
  EXPECT_FALSE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_FALSE(find("relax-cancel")->isEnabled());
}

TEST_F(RelaxPanelsTest, JobsWaitAndSurviveAChangeOfPanel) {
  choose("relax-preset", "thesis");
  click("relax-run");
  EXPECT_EQ(find<QPushButton>("relax-run")->text(), "Queue");
  click("relax-run");
  EXPECT_EQ(workspace().jobs().queued(), 1);
  window->setPerspective(Perspective::Inspect);
  settle();
  ASSERT_TRUE(proposed());
  window->setPerspective(Perspective::Relax);
  settle();
  EXPECT_TRUE(find("relax-decision")->isVisible());
  EXPECT_GT(workspace().relaxation().step(), 0);
  find<QTabWidget>("relax-tabs")->setCurrentIndex(2);
  settle();
  auto* jobs = find<TableView>("relax-jobs");
  const int last = jobs->model()->rowCount() - 1;
  EXPECT_FALSE(find("relax-job-cancel")->isEnabled());
  clickIndex(jobs, jobs->model()->index(last, 0));
  click("relax-job-cancel");
  EXPECT_EQ(workspace().jobs().queued(), 0);
  click("relax-accept");
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
  EXPECT_FALSE(workspace().jobs().busy());
}

TEST_F(RelaxPanelsTest, APinIsACheckThatUndoTakesBack) {
  const QModelIndex pin = relax->model().index(2, RelaxationTableModel::Pin);
  relax->table()->scrollTo(pin);
  const QRect cell = relax->table()->visualRect(pin);
  QTest::mouseClick(relax->table()->viewport(), Qt::LeftButton, {},
                    QPoint(cell.left() + 12, cell.center().y()));
  settle();
  ASSERT_TRUE(snapshot().isPinned(id(2)));
  EXPECT_TRUE(map->model().stops()[2].pinned);
  press(QKeySequence("Ctrl+Z"));
  EXPECT_FALSE(snapshot().isPinned(id(2)));
  press(QKeySequence("Ctrl+Shift+Z"));
  EXPECT_TRUE(snapshot().isPinned(id(2)));
}

TEST_F(RelaxPanelsTest, AClickOnALineOfThePlotSelectsItsScan) {
  click("relax-run");
  ASSERT_TRUE(proposed());
  find<QTabWidget>("relax-tabs")->setCurrentIndex(1);
  settle();
  MovementPlot& plot = relax->plot();
  QPoint place;
  int scan = -1;
  for (int x = 0; x < plot.width() && scan < 1; x += 3)
    for (int y = 0; y < plot.height() && scan < 1; y += 3)
      if (const int near = plot.scanNear(QPointF(x, y)); near >= 1) {
        scan = near;
        place = QPoint(x, y);
      }
  ASSERT_GE(scan, 1) << "no line was drawn";
  QTest::mouseClick(&plot, Qt::LeftButton, {}, place);
  EXPECT_EQ(workspace().selection().currentScan(), id(static_cast<std::size_t>(scan)));
}

TEST_F(RelaxPanelsTest, WrongOrderClicksDoNoHarm) {
  const auto revision = snapshot().revision();
  for (const char* name : {"relax-pause", "relax-cancel", "links-state", "links-delete", "links-what-if"})
    EXPECT_FALSE(find(name)->isEnabled()) << name;
  choose("relax-preset", "thesis");
  runUntilHeld();
  EXPECT_FALSE(find("links-add")->isEnabled()) << "the project must not change under the work";
  EXPECT_FALSE(isEnabled("edit.undo"));
  click("relax-run");
  click("relax-cancel");
  ASSERT_TRUE(waitUntil([&] { return workspace().jobs().queued() == 0; }));
  ASSERT_TRUE(proposed());
  click("relax-before");
  window->setPerspective(Perspective::Capture);
  window->setPerspective(Perspective::Relax);
  settle();
  click("relax-discard");
  EXPECT_EQ(snapshot().revision(), revision);
  workspace().session().close();
  settle();
  EXPECT_TRUE(relax->model().rowCount() == 0 && links->model().rowCount() == 0);
}

TEST_F(RelaxPanelsTest, LinksAreDisabledEnabledAndDeletedWithUndo) {
  clickLink(link(1));
  EXPECT_EQ(workspace().selection().links(), std::vector<LinkId>{link(1)});
  EXPECT_TRUE(map->model().links()[1].selected) << "the map follows";
  click("links-state");
  EXPECT_EQ(snapshot().links()[1].state, LinkState::Disabled);
  EXPECT_EQ(find<QToolButton>("links-state")->text(), "Enable");
  click("links-state");
  EXPECT_EQ(snapshot().links()[1].state, LinkState::Active);
  click("links-delete");
  EXPECT_EQ(snapshot().links().size(), 2U);
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(snapshot().links().size(), 3U);
}

TEST_F(RelaxPanelsTest, LinksAreAddedAndRegisteredAgain) {
  workspace().selection().setScans({id(0), id(2)});
  click("links-add");
  EXPECT_EQ(find<QComboBox>("links-add-fixed")->currentIndex(), 0);
  EXPECT_EQ(find<QComboBox>("links-add-moving")->currentIndex(), 2);
  click("links-add-placed");
  ASSERT_TRUE(waitForJobs());
  ASSERT_EQ(snapshot().links().size(), 4U);
  EXPECT_EQ(snapshot().links().back().origin, LinkOrigin::ByHand);
  settle();
  click("links-add-register");
  ASSERT_TRUE(waitForJobs());
  ASSERT_EQ(snapshot().links().size(), 5U);
  EXPECT_EQ(snapshot().links().back().origin, LinkOrigin::Automatic);
  find<QComboBox>("links-add-moving")->setCurrentIndex(0);
  settle();
  EXPECT_FALSE(find("links-add-register")->isEnabled()) << "a scan with itself";
  const LinkId old = link(0);
  clickLink(old);
  click("links-again");
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().findLink(old), nullptr) << "the new one took its place";
  EXPECT_EQ(snapshot().links().size(), 5U);
}

TEST_F(RelaxPanelsTest, WhatIfIsAskedAnsweredAndCommitted) {
  workspace().selection().setScans({id(0), id(2)});
  click("links-add");
  click("links-add-register");
  ASSERT_TRUE(waitForJobs());
  settle();
  const LinkId asked = snapshot().links().back().id;
  clickLink(asked);
  const auto revision = snapshot().revision();
  click("links-what-if");
  EXPECT_TRUE(find("links-said")->isVisible());
  EXPECT_TRUE(find<QLabel>("links-said-text")->text().contains("the others put scan 2"));
  EXPECT_FALSE(links->view()->isColumnHidden(LinkTableModel::Without));
  EXPECT_EQ(snapshot().revision(), revision);
  click("links-said-back");
  EXPECT_FALSE(find("links-said")->isVisible());
  EXPECT_EQ(snapshot().revision(), revision);
  clickLink(asked);
  click("links-what-if");
  click("links-said-disable");
  EXPECT_EQ(snapshot().findLink(asked)->state, LinkState::Disabled);
  EXPECT_FALSE(find("links-said")->isVisible());
}

TEST_F(RelaxPanelsTest, ShowBothHidesTheOthers) {
  clickLink(link(0));
  click("links-show");
  EXPECT_TRUE(workspace().display().isVisible(id(0)));
  EXPECT_TRUE(workspace().display().isVisible(id(1)));
  EXPECT_FALSE(workspace().display().isVisible(id(3)));
}

TEST_F(RelaxPanelsTest, TheMapSelectsZoomsAndShifts) {
  SiteMapView& view = map->view();
  const auto& stops = map->model().stops();
  clickMap(stops[2].place_m);
  EXPECT_EQ(workspace().selection().currentScan(), id(2));
  clickMap(stops[3].place_m, Qt::ControlModifier);
  EXPECT_EQ(workspace().selection().scans().size(), 2U);
  clickMap((stops[1].place_m + stops[2].place_m) / 2);
  EXPECT_EQ(workspace().selection().links(), std::vector<LinkId>{link(1)});
  const double before = view.seen().px_per_m;
  QWheelEvent wheel(QPointF(50, 50), view.mapToGlobal(QPoint(50, 50)), {}, QPoint(0, 240), Qt::NoButton,
                    Qt::NoModifier, Qt::NoScrollPhase, false);
  QApplication::sendEvent(&view, &wheel);
  EXPECT_GT(view.seen().px_per_m, 1.4 * before);
  const QPointF centre = view.seen().centre_m;
  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_GT(view.seen().centre_m.x(), centre.x());
  QTest::keyClick(&view, Qt::Key_Minus);
  QTest::keyClick(&view, Qt::Key_F);
  EXPECT_NEAR(view.seen().px_per_m, before, 1e-9);
  QTest::keyClick(&view, Qt::Key_PageUp);
  EXPECT_EQ(workspace().selection().currentScan(), id(2));
  QTest::keyClick(&view, Qt::Key_PageDown);
  EXPECT_EQ(workspace().selection().currentScan(), id(3));
}

TEST_F(RelaxPanelsTest, APictureIsPlacedByFourClicks) {
  const auto file = folder / "aerial.png";
  must(writePng(file, RgbImage(60, 40, Rgb{20, 90, 30})));
  map->addPicture(qt(file));
  settle();
  ASSERT_TRUE(map->view().isPlacing());
  EXPECT_TRUE(find<QLabel>("sitemap-banner")->text().startsWith("1 of 4"));
  QTest::keyClick(&map->view(), Qt::Key_Escape);
  EXPECT_FALSE(map->view().isPlacing());
  find<QAction>("sitemap-picture-place")->trigger();
  settle();
  const auto placed = *map->model().placement();
  const QPointF a = map->model().stops()[0].place_m, b = map->model().stops()[2].place_m;
  // What lies beside the stops now belongs onto them.
  const QPointF off(0.8, -0.5);
  clickMap(a + off);
  clickMap(a);
  clickMap(b + off);
  EXPECT_TRUE(find<QLabel>("sitemap-banner")->text().startsWith("4 of 4"));
  clickMap(b);
  EXPECT_FALSE(map->view().isPlacing());
  const Eigen::Vector2d before = placed.pictureOf({a.x() + off.x(), a.y() + off.y()});
  const Eigen::Vector2d after = map->model().placement()->worldOf(before);
  EXPECT_NEAR(after.x(), a.x(), 0.1);
  EXPECT_NEAR(after.y(), a.y(), 0.1);
  find<QAction>("sitemap-picture-remove")->trigger();
  EXPECT_FALSE(snapshot().sitePicture());
  press(QKeySequence("Ctrl+Z"));
  EXPECT_TRUE(snapshot().sitePicture());
}

// A picture of the panel alone, in the size and theme of the baseline.
TEST_F(RelaxPanelsTest, PanelsLookAsTheyDid) {
  preferences.setTheme(ThemeChoice::Dark);
  click("relax-run");
  ASSERT_TRUE(proposed());
  click("relax-accept");
  workspace().selection().clear();
  const PanelContext context{workspace(), window->actions(), theme};
  const auto look = [&](QWidget* panel, QSize size, const char* name) {
    panel->setAutoFillBackground(true);
    panel->resize(size);
    panel->show();
    settle();
    EXPECT_TRUE(looksLike(panel->grab().toImage(), name));
    delete panel;
  };
  look(new SiteMapPanel(context), {480, 320}, "sitemap");
  look(new RelaxationPanel(context), {480, 320}, "relax");
  look(new LinksPanel(context), {720, 240}, "links");
}

TEST_F(RelaxPanelsTest, PanelsLookAsTheyDidWhileItRuns) {
  preferences.setTheme(ThemeChoice::Dark);
  choose("relax-preset", "thesis");
  runUntilHeld(2);
  const PanelContext context{workspace(), window->actions(), theme};
  const auto look = [&](QWidget* panel, QSize size, const char* name) {
    panel->setAutoFillBackground(true);
    panel->resize(size);
    panel->show();
    settle();
    EXPECT_TRUE(looksLike(panel->grab().toImage(), name));
    delete panel;
  };
  look(new SiteMapPanel(context), {480, 320}, "sitemap-held");
  look(new RelaxationPanel(context), {480, 320}, "relax-held");
  click("relax-step");
  ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isHolding(); }));
  click("relax-pause");
  ASSERT_TRUE(proposed());
  look(new RelaxationPanel(context), {480, 320}, "relax-proposal");
  click("relax-discard");
}

TEST_F(RelaxPanelsTest, AProposalIsComparedInTheView) {
  auto* compare = find<QToolButton>("view3d-compare");
  click("relax-run");
  ASSERT_TRUE(proposed());
  click("relax-wipe");
  EXPECT_TRUE(compare->isChecked());
  EXPECT_EQ(find<QComboBox>("compare-before")->currentData().toString(), "pairwise");
  EXPECT_EQ(find<QComboBox>("compare-how")->currentData().toString(), "wipe");
  EXPECT_TRUE(find<QToolButton>("relax-wipe")->isChecked());
  EXPECT_FALSE(find<QToolButton>("relax-after")->isChecked());
  click("relax-blink");
  EXPECT_EQ(find<QComboBox>("compare-how")->currentData().toString(), "blink");
  click("relax-before");
  EXPECT_FALSE(compare->isChecked()) << "one at a time again";
  click("relax-wipe");
  click("relax-after");
  EXPECT_FALSE(compare->isChecked());
  click("relax-wipe");
  // Ended in the view itself: the decision says so.
  QTest::mouseClick(compare, Qt::LeftButton);
  settle();
  EXPECT_FALSE(find<QToolButton>("relax-wipe")->isChecked());
  EXPECT_TRUE(find<QToolButton>("relax-after")->isChecked());
  click("relax-wipe");
  click("relax-accept");
  EXPECT_FALSE(compare->isChecked());
  EXPECT_TRUE(snapshot().hasStage(Stage::Relaxed));
}

}  // namespace
}  // namespace tiltmap::test
