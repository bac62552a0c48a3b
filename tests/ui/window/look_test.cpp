// Light and dark, sizes, names for those who cannot see.
#include <QAbstractButton>
#include <QAbstractItemView>
#include <QComboBox>
#include <QLineEdit>
#include <QTableWidget>
#include <cmath>
#include <map>

#include "tests/ui/support/window_fixture.h"
#include "ui/look/icons.h"

namespace tiltmap::test {

using namespace ui;

class LookTest : public WindowTest {};

double luminance(const QColor& colour) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(colour.redF()) + 0.7152 * linear(colour.greenF()) + 0.0722 * linear(colour.blueF());
}

double contrast(const QColor& a, const QColor& b) {
  const double x = luminance(a), y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

TEST(Theme, TextCanBeRead) {
  for (const Look look : {Look::Light, Look::Dark, Look::HighContrast}) {
    const int dark = static_cast<int>(look);
    const double least = look == Look::HighContrast ? 7.0 : 4.5;
    const QPalette p = Theme::palette(look);
    const ThemeColours c = Theme::coloursOf(look);
    using Role = QPalette::ColorRole;
    const std::pair<Role, Role> pairs[] = {
        {QPalette::WindowText, QPalette::Window},         {QPalette::Text, QPalette::Base},
        {QPalette::Text, QPalette::AlternateBase},        {QPalette::ButtonText, QPalette::Button},
        {QPalette::HighlightedText, QPalette::Highlight}, {QPalette::ToolTipText, QPalette::ToolTipBase},
        {QPalette::PlaceholderText, QPalette::Base},      {QPalette::Link, QPalette::Base}};
    for (const auto& [text, ground] : pairs)
      EXPECT_GE(contrast(p.color(text), p.color(ground)), least) << dark << " " << text << " on " << ground;
    for (const QColor& text : {c.muted, c.good, c.warning, c.error})
      EXPECT_GE(contrast(text, p.color(QPalette::Window)), least) << dark << " " << text.name().toStdString();
    for (const QColor& ground : {c.error_ground, c.warning_ground, c.note_ground})
      EXPECT_GE(contrast(p.color(QPalette::WindowText), ground), least)
          << dark << " " << ground.name().toStdString();
    EXPECT_GE(contrast(c.view_text, c.view_top), least);
    EXPECT_GE(contrast(c.view_text, c.view_bottom), least);
  }
}

TEST_F(LookTest, PreferencesChangeTheThemeAtOnce) {
  makeProject(2);
  preferences.setTheme(ThemeChoice::Light);
  ASSERT_TRUE(trigger("edit.preferences"));
  auto* dialog = find("preferences");
  EXPECT_FALSE(dialog->property("modal").toBool());
  const auto corner = [&] {
    return window->grab().toImage().pixelColor(4, window->height() - 4).lightness();
  };
  EXPECT_GT(corner(), 200);
  auto* theme_box = find<QComboBox>("theme", dialog);
  theme_box->setFocus();
  QTest::keyClick(theme_box, Qt::Key_Down);
  settle();
  EXPECT_EQ(preferences.theme(), ThemeChoice::Dark);
  EXPECT_LT(corner(), 80);
  auto* unit = find<QComboBox>("length-unit", dialog);
  unit->setFocus();
  QTest::keyClick(unit, Qt::Key_Down);
  EXPECT_EQ(preferences.lengthUnit(), LengthUnit::Millimetre);
  preferences.setTheme(ThemeChoice::Light);
}

// Colours that make up at least such a share of a picture.
std::map<QRgb, double> coloursOf(const QImage& picture, double least) {
  std::map<QRgb, double> shares;
  const double one = 1.0 / (picture.width() * picture.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) shares[picture.pixel(x, y)] += one;
  std::erase_if(shares, [&](const auto& entry) { return entry.second < least; });
  return shares;
}

// A look that is chosen while the window is open has the colours of one that was there from the beginning.
TEST_F(LookTest, NoPanelKeepsColoursOfTheLookBefore) {
  preferences.setTheme(ThemeChoice::Light);
  makeProject(3, true);
  const QString path = workspace().session().path();
  // By perspective and panel. Three-dimensional pictures are never the same twice.
  const auto pictures = [&] {
    std::map<QString, QImage> made;
    for (const Perspective perspective : kPerspectives) {
      window->setPerspective(perspective);
      settle();
      for (const PanelInfo& panel : panels()) {
        QWidget* widget = window->docks().panel(panel.id);
        if (!widget->isVisible() || panel.id == "view3d" || panel.id == "stepper-view") continue;
        made[perspectiveName(perspective) + "/" + panel.id] = widget->grab().toImage();
      }
    }
    return made;
  };
  (void)pictures();  // everything has been seen in the look before
  for (const ThemeChoice look : {ThemeChoice::Dark, ThemeChoice::Light}) {
    preferences.setTheme(look);
    settle();
    const auto changed = pictures();
    window->closeNow();
    delete window.data();
    window = openWindow();
    must(workspace().session().open(path));
    settle();
    const auto fresh = pictures();
    EXPECT_GT(changed.size(), 12U);
    for (const auto& [name, picture] : changed) {
      const auto found = fresh.find(name);
      ASSERT_NE(found, fresh.end()) << name.toStdString();
      const auto wanted = coloursOf(found->second, 0.0002);
      for (const auto& [colour, share] : coloursOf(picture, 0.004))
        EXPECT_TRUE(wanted.contains(colour))
            << name.toStdString() << " keeps " << QColor(colour).name().toStdString() << " on "
            << 100.0 * share << " % of it in the " << (look == ThemeChoice::Dark ? "dark" : "light")
            << " look";
    }
  }
}

TEST_F(LookTest, OwnIconsTakeTheColourOfThePalette) {
  for (const char* name : {"tilt-unit", "range-matrix", "step-back", "relax", "register-pair"}) {
    const QImage image = icon(name).pixmap(64, 64).toImage();
    ASSERT_FALSE(image.isNull()) << name;
    int painted = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        if (image.pixelColor(x, y).alpha() > 200) {
          ++painted;
          EXPECT_LT(std::abs(image.pixelColor(x, y).lightness() -
                             QApplication::palette().color(QPalette::ButtonText).lightness()),
                    20);
        }
    EXPECT_GT(painted, 100) << name;
  }
}

TEST_F(LookTest, EveryPanelFitsAnOutdoorLaptop) {
  makeProject(3, true);
  for (const Perspective perspective : kPerspectives) {
    window->setPerspective(perspective);
    window->resize(1366, 768);
    settle();
    EXPECT_LE(window->minimumSizeHint().width(), 1366) << perspectiveName(perspective).toStdString();
    EXPECT_LE(window->minimumSizeHint().height(), 768) << perspectiveName(perspective).toStdString();
    EXPECT_EQ(window->size(), QSize(1366, 768));
    for (const PanelInfo& panel : panels()) {
      const QWidget* widget = window->docks().panel(panel.id);
      if (!widget->isVisible()) continue;
      EXPECT_GE(widget->width(), 150) << panel.id.toStdString();
      EXPECT_GE(widget->height(), 80) << panel.id.toStdString();
    }
  }
}

TEST_F(LookTest, EveryControlHasATipAndAName) {
  makeProject(2, true);
  ASSERT_TRUE(trigger("edit.preferences"));
  ASSERT_TRUE(trigger("help.about"));
  for (const QWidget* widget : window->findChildren<QWidget*>()) {
    const QString name = widget->objectName();
    // Parts that Qt and the docking system make themselves.
    if (name.isEmpty() || name.startsWith("qt_") || name.startsWith("dockArea") || name.startsWith("tab") ||
        name == "tabsMenuButton" || name == "ScrollLeftButton" || name == "ScrollRightButton")
      continue;
    const auto* button = qobject_cast<const QAbstractButton*>(widget);
    const bool field = qobject_cast<const QLineEdit*>(widget) || qobject_cast<const QComboBox*>(widget);
    if (button || field) {
      EXPECT_FALSE(widget->toolTip().isEmpty()) << name.toStdString();
    }
    if (qobject_cast<const QAbstractItemView*>(widget) ||
        (field && !qobject_cast<const QComboBox*>(widget))) {
      EXPECT_FALSE(widget->accessibleName().isEmpty()) << name.toStdString();
    }
  }
}

TEST_F(LookTest, AboutNamesTheLibrariesAndTheirLicences) {
  ASSERT_TRUE(trigger("help.about"));
  auto* table = find<QTableWidget>("libraries");
  ASSERT_GT(table->rowCount(), 8);
  for (int row = 0; row < table->rowCount(); ++row) EXPECT_FALSE(table->item(row, 2)->text().isEmpty());
}

}  // namespace tiltmap::test
