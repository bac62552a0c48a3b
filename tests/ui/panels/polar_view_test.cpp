#include "ui/panels/polar_view.h"

#include <QMouseEvent>
#include <QTest>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/ui/support/pixels.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"

namespace tiltmap::test {
namespace {

using ui::BeamKind;
using ui::PolarView;

class PolarViewTest : public ::testing::Test {
 protected:
  PolarViewTest() : preferences(ui::qt(folder / "settings.ini")), theme(preferences), view(theme) {
    preferences.setTheme(ui::ThemeChoice::Light);
    view.resize(420, 300);
    view.show();
    (void)QTest::qWaitForWindowExposed(&view);
    QCoreApplication::processEvents();
  }
  // So many beams over the half circle in front, all of one range.
  void showLine(float range_m, int beams = 181) {
    azimuths.clear();
    for (int k = 0; k < beams; ++k) azimuths.push_back(k * 3.14159265358979 / (beams - 1));
    ranges.assign(azimuths.size(), range_m);
    codes.assign(azimuths.size(), cell_code::kMeasured);
    show();
  }
  void show() { view.setLine(ranges, azimuths, codes); }
  void moveTo(const QPointF& place) {
    QMouseEvent event(QEvent::MouseMove, place, Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QApplication::sendEvent(&view, &event);
  }
  QColor accent() { return theme.colours().accent; }

  TemporaryFolder folder;
  ui::Preferences preferences;
  ui::Theme theme;
  PolarView view;
  std::vector<float> ranges;
  std::vector<double> azimuths;
  std::vector<CellCode> codes;
};

TEST_F(PolarViewTest, WithoutALineItSaysSo) {
  const QImage empty = pictureOf(view);
  EXPECT_TRUE(view.isEmpty());
  EXPECT_GT(countNear(empty, view.rect().center(), 200, view.palette().color(QPalette::PlaceholderText)), 50);
  EXPECT_TRUE(view.readout().isEmpty());
  showLine(3.0F);
  EXPECT_NE(pictureOf(view), empty);
  view.clear();
  EXPECT_TRUE(view.isEmpty());
  EXPECT_EQ(pictureOf(view), empty);
}

TEST_F(PolarViewTest, ForwardIsUpAndRightIsRight) {
  showLine(4.0F, 3);
  ASSERT_EQ(view.outerRing(), 5.0);
  const QPointF middle = view.centre();
  const double four = 4.0 * view.scale();
  EXPECT_LT(QPointF(view.placeOf(0) - (middle + QPointF(four, 0))).manhattanLength(), 0.01);   // right
  EXPECT_LT(QPointF(view.placeOf(1) - (middle + QPointF(0, -four))).manhattanLength(), 0.01);  // forward
  EXPECT_LT(QPointF(view.placeOf(2) - (middle + QPointF(-four, 0))).manhattanLength(), 0.01);  // left
  const QImage picture = pictureOf(view);
  for (int beam = 0; beam < 3; ++beam) {
    EXPECT_TRUE(view.rect().contains(view.placeOf(beam).toPoint()));
    EXPECT_GT(countNear(picture, view.placeOf(beam), 3, accent()), 2) << beam;
  }
  // The scanner itself.
  EXPECT_GT(countNear(picture, middle, 6, view.palette().color(QPalette::Text)), 15);
}

TEST_F(PolarViewTest, AScannerThatLooksBehindHasItsWholeCircle) {
  showLine(4.0F);
  const double half = view.scale();
  for (double& a : azimuths) a = a * 1.5 - 45.0 * kDegree;
  show();
  EXPECT_LT(view.scale(), half);
  for (int beam = 0; beam < static_cast<int>(ranges.size()); ++beam)
    ASSERT_TRUE(view.rect().contains(view.placeOf(beam).toPoint())) << beam;
}

TEST_F(PolarViewTest, BeamsWithoutAnEchoAndDazzledOnesLookDifferent) {
  EXPECT_EQ(ui::beamKind(cell_code::kMeasured), BeamKind::Echo);
  EXPECT_EQ(ui::beamKind(cell_code::kReplaced), BeamKind::Echo);
  for (const CellCode code : {cell_code::kNoReturn, cell_code::kLmsFirst, cell_code::kLmsNoSignal})
    EXPECT_EQ(ui::beamKind(code), BeamKind::NoEcho) << code;
  for (const CellCode code : {cell_code::kLmsDazzled, cell_code::kLmsOverflow, CellCode(8185)})
    EXPECT_EQ(ui::beamKind(code), BeamKind::Trouble) << code;
  for (const CellCode code : {cell_code::kMissing, cell_code::kMasked, cell_code::kOutOfBounds})
    EXPECT_EQ(ui::beamKind(code), BeamKind::Left) << code;

  showLine(2.0F, 7);
  codes = {cell_code::kMeasured, cell_code::kLmsNoSignal, cell_code::kLmsDazzled, cell_code::kMasked,
           cell_code::kMeasured, cell_code::kLmsOverflow, cell_code::kMeasured};
  ranges = {2.0F, 0.0F, 0.0F, 0.0F, 2.0F, 0.0F, 2.0F};
  show();
  const QImage picture = pictureOf(view);
  const auto seen = [&](int beam, const QColor& colour) {
    return countNear(picture, view.placeOf(beam), 7, colour, 40);
  };
  EXPECT_GT(seen(0, accent()), 2);
  EXPECT_GT(seen(1, theme.colours().muted), 3);
  EXPECT_EQ(seen(1, theme.colours().error), 0);
  EXPECT_GT(seen(2, theme.colours().error), 5);
  EXPECT_GT(seen(5, theme.colours().error), 5);
  EXPECT_EQ(seen(3, theme.colours().error) + seen(3, accent()), 0) << "what is masked is not drawn";
  // All of them at the rim.
  for (const int beam : {1, 2, 3, 5})
    EXPECT_NEAR(
        std::hypot(view.placeOf(beam).x() - view.centre().x(), view.placeOf(beam).y() - view.centre().y()),
        5.0 * view.scale(), 0.01);
  EXPECT_NE(view.readout().indexOf("3 of 7 echoes"), -1) << view.readout().toStdString();
  EXPECT_NE(view.readout().indexOf("1 none"), -1);
  EXPECT_NE(view.readout().indexOf("2 dazzled"), -1);
  EXPECT_NE(view.readout().indexOf("1 left out"), -1);
}

TEST_F(PolarViewTest, TheRingGrowsAtOnceAndShrinksSlowly) {
  showLine(3.0F);
  EXPECT_EQ(view.outerRing(), 5.0);
  for (const auto& [range, ring] : {std::pair(7.0F, 10.0), std::pair(12.0F, 20.0), std::pair(35.0F, 40.0),
                                    std::pair(79.0F, 80.0), std::pair(200.0F, 80.0)}) {
    showLine(range);
    EXPECT_EQ(view.outerRing(), ring) << range;
  }
  for (int k = 1; k < PolarView::kSteadyLines; ++k) showLine(3.0F);
  EXPECT_EQ(view.outerRing(), 80.0);
  showLine(3.0F);
  EXPECT_EQ(view.outerRing(), 40.0);
  // One line that needs it keeps it.
  for (int k = 0; k < 40; ++k) showLine(3.0F);
  showLine(30.0F);
  for (int k = 0; k < 40; ++k) showLine(3.0F);
  EXPECT_EQ(view.outerRing(), 40.0);
  // Lines about the next ring do not make it jump.
  for (int k = 0; k < 200; ++k) showLine(k % 2 ? 19.9F : 20.1F);
  EXPECT_EQ(view.outerRing(), 40.0);
}

TEST_F(PolarViewTest, AFewFarBeamsAreArrowsAtTheRim) {
  showLine(4.0F);
  const QImage before = pictureOf(view);
  ranges[90] = 60.0F;
  show();
  EXPECT_EQ(view.outerRing(), 5.0) << "one beam of 181 does not make all others small";
  EXPECT_NEAR(view.centre().y() - view.placeOf(90).y(), 5.0 * view.scale(), 0.01);
  EXPECT_EQ(countNear(before, view.placeOf(90), 4, accent()), 0);
  EXPECT_GT(countNear(pictureOf(view), view.placeOf(90), 4, accent()), 8);
}

TEST_F(PolarViewTest, PointingReadsTheBeam) {
  showLine(4.0F);
  codes[45] = cell_code::kLmsDazzled;
  show();
  moveTo(view.placeOf(120));
  EXPECT_EQ(view.markedBeam(), 120);
  EXPECT_EQ(view.readout(), "Azimuth 120.0°: 4.00 m, measured");
  EXPECT_EQ(view.accessibleDescription(), view.readout());
  const QImage marked = pictureOf(view);
  EXPECT_GT(countNear(marked, 0.5 * (view.placeOf(120) + view.centre()), 3,
                      view.palette().color(QPalette::Text), 60),
            2);
  // Along the beam, not only at its end.
  moveTo(view.centre() + 0.3 * (view.placeOf(45) - view.centre()));
  EXPECT_EQ(view.markedBeam(), 45);
  EXPECT_EQ(view.readout(), "Azimuth 45.0°: dazzled (LMS 8190)");
  // Where no beam looks, and outside.
  moveTo(view.centre() + QPointF(0, 20));
  EXPECT_FALSE(view.markedBeam());
  moveTo(view.placeOf(10));
  ASSERT_TRUE(view.markedBeam());
  QEvent leave(QEvent::Leave);
  QApplication::sendEvent(&view, &leave);
  EXPECT_FALSE(view.markedBeam());
}

TEST_F(PolarViewTest, ArrowKeysGoFromBeamToBeam) {
  showLine(4.0F);
  EXPECT_EQ(view.focusPolicy(), Qt::StrongFocus);
  QTest::keyClick(&view, Qt::Key_Left);
  ASSERT_TRUE(view.markedBeam());
  const int first = *view.markedBeam();
  QTest::keyClick(&view, Qt::Key_Left);
  EXPECT_EQ(view.markedBeam(), first + 1) << "azimuth grows to the left";
  EXPECT_LT(view.placeOf(first + 1).x(), view.placeOf(first).x());
  QTest::keyClick(&view, Qt::Key_Right);
  QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_EQ(view.markedBeam(), first - 1);
  for (int k = 0; k < 200; ++k) QTest::keyClick(&view, Qt::Key_Right);
  EXPECT_EQ(view.markedBeam(), 0);
  // It stays from line to line, and goes where there is no such beam any more.
  show();
  EXPECT_EQ(view.markedBeam(), 0);
  QTest::keyClick(&view, Qt::Key_Escape);
  EXPECT_FALSE(view.markedBeam());
  for (int k = 0; k < 100; ++k) QTest::keyClick(&view, Qt::Key_Left);
  showLine(4.0F, 5);
  EXPECT_FALSE(view.markedBeam());
}

class PaintCounter : public QObject {
 public:
  int paints = 0;
  bool eventFilter(QObject*, QEvent* event) override {
    paints += event->type() == QEvent::Paint;
    return false;
  }
};

TEST_F(PolarViewTest, OnlyTheLatestLineIsPainted) {
  showLine(4.0F);
  QTest::qWait(20);
  PaintCounter counter;
  view.installEventFilter(&counter);
  for (int k = 0; k < 100; ++k) showLine(1.0F + 0.03F * static_cast<float>(k));
  EXPECT_EQ(counter.paints, 0);
  for (int k = 0; k < 50 && counter.paints == 0; ++k) QTest::qWait(5);
  EXPECT_EQ(counter.paints, 1);
  EXPECT_GT(countNear(pictureOf(view), view.placeOf(90), 3, accent()), 2);
}

TEST_F(PolarViewTest, OddLinesAreRefusedOrShown) {
  showLine(4.0F);
  ranges.pop_back();
  EXPECT_THROW(show(), std::invalid_argument);
  // One beam, no beam with an echo, no beam at all.
  view.setLine(std::vector{2.0F}, std::vector{0.5}, std::vector{cell_code::kMeasured});
  EXPECT_GT(countNear(pictureOf(view), view.placeOf(0), 3, accent()), 2);
  view.setLine(std::vector{0.0F}, std::vector{0.5}, std::vector{cell_code::kLmsNoSignal});
  EXPECT_GT(countNear(pictureOf(view), view.placeOf(0), 7, theme.colours().muted, 40), 3);
  view.setLine({}, {}, {});
  EXPECT_TRUE(view.isEmpty());
  (void)pictureOf(view);
  for (const QSize& size : {QSize(40, 20), QSize(1, 1), QSize(900, 160)}) {
    view.resize(size);
    showLine(4.0F);
    EXPECT_FALSE(pictureOf(view).isNull());
  }
}

TEST_F(PolarViewTest, FollowsTheTheme) {
  showLine(4.0F);
  for (const auto choice : {ui::ThemeChoice::Dark, ui::ThemeChoice::HighContrast, ui::ThemeChoice::Light}) {
    preferences.setTheme(choice);
    QCoreApplication::processEvents();
    const QImage picture = pictureOf(view);
    EXPECT_EQ(picture.pixelColor(3, 3), view.palette().color(QPalette::Base));
    EXPECT_GT(countNear(picture, view.placeOf(30), 3, accent()), 2);
  }
}

TEST_F(PolarViewTest, IsNamed) {
  EXPECT_FALSE(view.accessibleName().isEmpty());
  EXPECT_FALSE(view.toolTip().isEmpty());
}

}  // namespace
}  // namespace tiltmap::test
