#include "ui/panels/sweep_matrix_view.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QTest>
#include <QToolTip>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/pixels.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"

namespace tiltmap::test {
namespace {

using ui::SweepMatrixView;
using ui::SweepRow;

class SweepMatrixTest : public ::testing::Test {
 protected:
  SweepMatrixTest() : preferences(ui::qt(folder / "settings.ini")), theme(preferences), view(theme) {
    preferences.setTheme(ui::ThemeChoice::Light);
    geometry.rows = 21;
    geometry.columns = 61;
    geometry.azimuth_step_rad = 3.0 * kDegree;
    geometry.tilt_step_rad = 2.0 * kDegree;
    view.resize(560, 240);
    view.show();
    (void)QTest::qWaitForWindowExposed(&view);
    QCoreApplication::processEvents();
  }
  void take(int row, float range_m) {
    const auto columns = static_cast<std::size_t>(geometry.columns);
    view.setRow(row, std::vector<float>(columns, range_m),
                std::vector<CellCode>(columns, cell_code::kMeasured));
  }
  QColor shown(int row, int column) {
    return pictureOf(view).pixelColor(view.placeOf({row, column}).toPoint());
  }
  QColor expected(double range_m) {
    const Rgb c = depthColour(range_m, view.range().first, view.range().second);
    return {c.r, c.g, c.b};
  }
  // Ground and lines of the hatch, and nothing else.
  bool isHatched(int row) {
    const QImage picture = pictureOf(view);
    const QRectF place = view.placeOfRow(row);
    int ground = 0, lines = 0, other = 0;
    for (int x = static_cast<int>(place.left()) + 3; x < static_cast<int>(place.right()) - 3; ++x) {
      const QColor c = picture.pixelColor(x, static_cast<int>(place.center().y()));
      if (isNear(c, view.palette().color(QPalette::Base), 2))
        ++ground;
      else if (isNear(c, theme.colours().muted, 2))
        ++lines;
      else
        ++other;
    }
    return ground > 20 && lines > 20 && other == 0;
  }
  QPointF besideRow(int row) {
    return {view.placeOfRow(row).right() + 6.0, view.placeOfRow(row).center().y()};
  }

  TemporaryFolder folder;
  ui::Preferences preferences;
  ui::Theme theme;
  SweepMatrixView view;
  ScannerGeometry geometry;
};

TEST_F(SweepMatrixTest, EmptyItSaysWhatWillBeThere) {
  const QImage empty = pictureOf(view);
  EXPECT_GT(countNear(empty, view.rect().center(), 250, view.palette().color(QPalette::PlaceholderText)), 50);
  EXPECT_EQ(view.rows(), 0);
  view.begin(geometry);
  EXPECT_NE(pictureOf(view), empty);
  take(3, 5.0F);
  view.clear();
  EXPECT_EQ(view.rows(), 0);
  EXPECT_EQ(view.taken(), 0);
  EXPECT_EQ(pictureOf(view), empty);
}

TEST_F(SweepMatrixTest, FillsRowByRow) {
  view.begin(geometry);
  EXPECT_EQ(view.rows(), 21);
  EXPECT_TRUE(isHatched(0));
  EXPECT_TRUE(isHatched(20));
  for (int row = 0; row < 5; ++row) take(row, 3.0F + static_cast<float>(row));
  EXPECT_EQ(view.taken(), 5);
  for (int row = 0; row < 5; ++row) {
    EXPECT_EQ(view.state(row), SweepRow::Taken);
    for (const int column : {0, 30, 60})
      EXPECT_TRUE(isNear(shown(row, column), expected(3.0 + row), 2)) << row << " " << column;
    EXPECT_FALSE(isHatched(row));
  }
  EXPECT_TRUE(isHatched(5));
  EXPECT_EQ(view.state(5), SweepRow::Waiting);
  // Tilt grows upwards, azimuth to the left.
  EXPECT_GT(view.placeOfRow(0).center().y(), view.placeOfRow(4).center().y());
  EXPECT_GT(view.placeOf({0, 0}).x(), view.placeOf({0, 60}).x());
}

TEST_F(SweepMatrixTest, CellsWithoutAPointAreGrey) {
  view.begin(geometry);
  std::vector<float> ranges(61, 4.0F);
  std::vector<CellCode> codes(61, cell_code::kMeasured);
  ranges[10] = 0.0F;
  codes[10] = cell_code::kLmsDazzled;
  view.setRow(2, ranges, codes);
  EXPECT_TRUE(isNear(shown(2, 10), theme.colours().no_data, 2));
  EXPECT_FALSE(isNear(shown(2, 11), theme.colours().no_data, 2));
  EXPECT_EQ(view.cellText({2, 10}), "Row 2 (tilt -26.0°), column 10 (azimuth 30.0°): dazzled (LMS 8190)");
  EXPECT_EQ(view.cellText({2, 11}), "Row 2 (tilt -26.0°), column 11 (azimuth 33.0°): 4.00 m");
  EXPECT_NE(view.cellText({3, 0}).indexOf("not taken yet"), -1);
}

TEST_F(SweepMatrixTest, TheRowBeingTakenIsMarked) {
  view.begin(geometry);
  const auto marked = [&](int row) {
    return isNear(shown(row, 30), theme.colours().accent, 2) &&
           isNear(shown(row, 5), theme.colours().accent, 2);
  };
  view.setCurrentRow(7);
  EXPECT_EQ(view.currentRow(), 7);
  EXPECT_TRUE(marked(7));
  const QRectF place = view.placeOfRow(7);
  EXPECT_GT(countNear(pictureOf(view), place.center() + QPointF(place.width() / 2 + 4, 0), 5,
                      theme.colours().accent),
            12)
      << "a hand beside it";
  take(7, 4.0F);
  view.setCurrentRow(8);
  EXPECT_FALSE(marked(7));
  EXPECT_TRUE(marked(8));
  view.setCurrentRow({});
  EXPECT_FALSE(marked(8));
  EXPECT_THROW(view.setCurrentRow(21), std::out_of_range);
  EXPECT_THROW(view.setCurrentRow(-1), std::out_of_range);
}

TEST_F(SweepMatrixTest, SpoiledAndRetakenRowsAreMarked) {
  view.begin(geometry);
  take(4, 3.0F);
  EXPECT_EQ(countNear(pictureOf(view), besideRow(6), 4, theme.colours().error, 40), 0);
  view.setSpoiled(6);
  EXPECT_EQ(view.state(6), SweepRow::Spoiled);
  EXPECT_GT(countNear(pictureOf(view), besideRow(6), 4, theme.colours().error, 40), 5);
  EXPECT_TRUE(isHatched(6));
  EXPECT_NE(view.cellText({6, 0}).indexOf("taken again"), -1);
  take(6, 3.5F);
  EXPECT_EQ(view.state(6), SweepRow::Retaken);
  EXPECT_EQ(countNear(pictureOf(view), besideRow(6), 4, theme.colours().error, 40), 0);
  EXPECT_GT(countNear(pictureOf(view), besideRow(6), 4.5, theme.colours().warning, 60), 5);
  EXPECT_TRUE(isNear(shown(6, 30), expected(3.5), 2));
  EXPECT_NE(view.cellText({6, 0}).indexOf("taken again"), -1);
  // What has been taken stays.
  view.setSpoiled(4);
  EXPECT_EQ(view.state(4), SweepRow::Taken);
  EXPECT_EQ(view.taken(), 2);
  take(6, 3.6F);
  EXPECT_EQ(view.taken(), 2);
}

TEST_F(SweepMatrixTest, ColoursAreSteadyWhileItFills) {
  view.begin(geometry);
  take(0, 3.0F);
  for (int row = 1; row < 10; ++row) take(row, 3.0F + 0.5F * static_cast<float>(row % 4));
  const auto range = view.range();
  int changes = 0;
  auto before = range;
  for (int row = 10; row < 20; ++row) {
    take(row, 3.0F + 0.5F * static_cast<float>(row % 4) + 0.01F * static_cast<float>(row));
    changes += view.range() != before;
    before = view.range();
  }
  EXPECT_LE(changes, 1);
  // A further scene is not cut off.
  take(20, 40.0F);
  EXPECT_GT(view.range().second, range.second);
}

TEST_F(SweepMatrixTest, FilledItLooksLikeTheDepthImage) {
  RandomStream random(5);
  RangeImageData data;
  data.rows = geometry.rows;
  data.columns = geometry.columns;
  data.range_m.resize(data.cells());
  data.code.assign(data.cells(), cell_code::kMeasured);
  for (float& range : data.range_m) range = static_cast<float>(random.uniform(1.0, 30.0));
  data.code[100] = cell_code::kLmsNoSignal;
  data.range_m[100] = 0.0F;
  for (int row = 0; row < data.rows; ++row) data.line_tilt_rad.push_back(geometry.tiltOfRow(row));
  view.begin(geometry);
  for (int row = 0; row < data.rows; ++row) {
    const auto first = static_cast<std::size_t>(row) * 61;
    view.setRow(row, std::span(data.range_m).subspan(first, 61), std::span(data.code).subspan(first, 61));
  }
  const auto image = RangeImage::make(data);
  ASSERT_TRUE(image) << image.error().what;
  const auto depth = depthImageOf(*image, geometry, DepthQuantity::Range);
  ASSERT_TRUE(depth);
  EXPECT_EQ(view.range(), std::pair(depth->low, depth->high));
  ui::DepthView other(theme);
  other.resize(view.size());
  other.setImage(std::make_shared<DepthImage>(*depth));
  other.show();
  const QImage ours = pictureOf(view), theirs = pictureOf(other);
  for (int row = 0; row < geometry.rows; ++row)
    for (int column = 1; column + 1 < geometry.columns; column += 3) {
      const QPoint place = view.placeOf({row, column}).toPoint();
      ASSERT_EQ(ours.pixelColor(place), theirs.pixelColor(place)) << row << " " << column;
    }
}

TEST_F(SweepMatrixTest, WithoutAnglesAxesAreNumbers) {
  view.begin(10, 30);
  ASSERT_NE(view.image(), nullptr);
  EXPECT_FALSE(view.image()->regular);
  view.setRow(0, std::vector<float>(30, 2.0F), std::vector<CellCode>(30, cell_code::kMeasured));
  EXPECT_LT(view.placeOfRow(0).center().y(), view.placeOfRow(9).center().y());
  EXPECT_EQ(view.cellText({0, 4}), "Row 0, column 4: 2.00 m");
  EXPECT_THROW(view.begin(0, 30), std::invalid_argument);
  EXPECT_THROW(view.begin(10, -1), std::invalid_argument);
}

TEST_F(SweepMatrixTest, WrongRowsAreRefused) {
  view.begin(geometry);
  EXPECT_THROW(take(21, 1.0F), std::out_of_range);
  EXPECT_THROW(take(-1, 1.0F), std::out_of_range);
  EXPECT_THROW(view.setRow(0, std::vector<float>(60), std::vector<CellCode>(61)), std::invalid_argument);
  EXPECT_THROW(view.setRow(0, std::vector<float>(61), std::vector<CellCode>(60)), std::invalid_argument);
  EXPECT_THROW(view.setSpoiled(21), std::out_of_range);
  EXPECT_EQ(view.taken(), 0);
}

TEST_F(SweepMatrixTest, PointingZoomingAndTheTooltip) {
  view.begin(geometry);
  for (int row = 0; row < 21; ++row) take(row, 3.0F + 0.1F * static_cast<float>(row));
  std::optional<ui::MatrixCell> hovered;
  QObject::connect(&view, &ui::DepthView::hovered, &view,
                   [&](std::optional<ui::MatrixCell> cell) { hovered = cell; });
  const QPointF place = view.placeOf({12, 40});
  QMouseEvent move(QEvent::MouseMove, place, Qt::NoButton, Qt::NoButton, Qt::NoModifier);
  QApplication::sendEvent(&view, &move);
  EXPECT_EQ(hovered, (ui::MatrixCell{12, 40}));
  QHelpEvent help(QEvent::ToolTip, place.toPoint(), view.mapToGlobal(place.toPoint()));
  QApplication::sendEvent(&view, &help);
  EXPECT_EQ(QToolTip::text(), view.cellText({12, 40}));
  for (int k = 0; k < 5; ++k) QTest::keyClick(&view, Qt::Key_Plus);
  EXPECT_GT(view.seen().zoom, 2.0);
  // Rows outside of what is seen have no place, and nothing is drawn over the axes.
  EXPECT_TRUE(view.placeOfRow(0).isEmpty());
  EXPECT_FALSE(view.placeOfRow(10).isEmpty());
  const QImage before = pictureOf(view);
  view.setCurrentRow(0);
  EXPECT_EQ(pictureOf(view), before);
  view.begin(geometry);
  EXPECT_EQ(view.seen().zoom, 1.0);
}

TEST_F(SweepMatrixTest, IsNamedAndFollowsTheTheme) {
  EXPECT_FALSE(view.accessibleName().isEmpty());
  EXPECT_FALSE(view.toolTip().isEmpty());
  EXPECT_EQ(view.focusPolicy(), Qt::StrongFocus);
  view.begin(geometry);
  preferences.setTheme(ui::ThemeChoice::Dark);
  QCoreApplication::processEvents();
  EXPECT_TRUE(isHatched(3)) << "in the colours of the dark theme";
  preferences.setTheme(ui::ThemeChoice::Light);
}

}  // namespace
}  // namespace tiltmap::test
