#include "ui/look/theme.h"

#include <QApplication>
#include <QIcon>
#include <QStandardPaths>
#include <QToolTip>

#include "ui/look/style.h"

namespace tiltmap::ui {

namespace {

void setAll(QPalette& palette,
            const std::initializer_list<std::pair<QPalette::ColorRole, const char*>>& roles) {
  for (const auto& [role, colour] : roles) palette.setColor(role, QColor(colour));
}

}  // namespace

QPalette Theme::palette(bool dark) {
  QPalette palette;
  if (dark) {
    setAll(palette, {{QPalette::Window, "#23272b"},
                     {QPalette::WindowText, "#e4e8eb"},
                     {QPalette::Base, "#1a1d20"},
                     {QPalette::AlternateBase, "#202428"},
                     {QPalette::Text, "#e4e8eb"},
                     {QPalette::Button, "#2f353a"},
                     {QPalette::ButtonText, "#e4e8eb"},
                     {QPalette::BrightText, "#ffffff"},
                     {QPalette::Light, "#454c53"},
                     {QPalette::Midlight, "#3a4147"},
                     {QPalette::Mid, "#363c42"},
                     {QPalette::Dark, "#15181a"},
                     {QPalette::Shadow, "#0c0e0f"},
                     {QPalette::ToolTipBase, "#343b41"},
                     {QPalette::ToolTipText, "#eef1f3"},
                     {QPalette::Highlight, "#14788a"},
                     {QPalette::HighlightedText, "#ffffff"},
                     {QPalette::Link, "#5ec8d8"},
                     {QPalette::LinkVisited, "#b39ddb"},
                     {QPalette::PlaceholderText, "#98a1a9"}});
  } else {
    setAll(palette, {{QPalette::Window, "#f2f4f5"},
                     {QPalette::WindowText, "#1c2227"},
                     {QPalette::Base, "#ffffff"},
                     {QPalette::AlternateBase, "#f6f8f9"},
                     {QPalette::Text, "#1c2227"},
                     {QPalette::Button, "#e9ecee"},
                     {QPalette::ButtonText, "#1c2227"},
                     {QPalette::BrightText, "#ffffff"},
                     {QPalette::Light, "#ffffff"},
                     {QPalette::Midlight, "#e3e7ea"},
                     {QPalette::Mid, "#c3c9ce"},
                     {QPalette::Dark, "#98a1a8"},
                     {QPalette::Shadow, "#767f87"},
                     {QPalette::ToolTipBase, "#fdfefe"},
                     {QPalette::ToolTipText, "#1c2227"},
                     {QPalette::Highlight, "#0e7285"},
                     {QPalette::HighlightedText, "#ffffff"},
                     {QPalette::Link, "#0b6577"},
                     {QPalette::LinkVisited, "#5e35b1"},
                     {QPalette::PlaceholderText, "#69737b"}});
  }
  const QColor faint(dark ? "#7f888f" : "#8c959c");
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    palette.setColor(QPalette::Disabled, role, faint);
  palette.setColor(QPalette::Disabled, QPalette::Highlight, QColor(dark ? "#3a4147" : "#c3c9ce"));
  palette.setColor(QPalette::Disabled, QPalette::HighlightedText, faint);
  return palette;
}

ThemeColours Theme::coloursOf(bool dark) {
  ThemeColours c;
  c.accent = dark ? "#35b3c6" : "#0e7285";
  c.muted = dark ? "#a7b0b7" : "#566068";
  c.good = dark ? "#7bc47f" : "#2e7d32";
  c.warning = dark ? "#f0b24a" : "#8a5a00";
  c.error = dark ? "#ff8a80" : "#b3261e";
  c.warning_ground = dark ? "#453a20" : "#fdf1d6";
  c.error_ground = dark ? "#4b2a2a" : "#fde7e5";
  c.note_ground = dark ? "#1f3a40" : "#e0f1f4";
  c.line = dark ? "#3a4147" : "#d3d9dd";
  c.view_top = dark ? "#2d3339" : "#fbfcfd";
  c.view_bottom = dark ? "#14171a" : "#dfe5e9";
  c.view_text = dark ? "#dde3e7" : "#1c2227";
  c.view_grid = dark ? "#4b545c" : "#b4bdc4";
  c.no_data = dark ? "#4a4f54" : "#bfc4c8";
  return c;
}

namespace {

// Where no desktop is known (a plain X server, no display at all), Qt looks for no icons in the usual places.
void findIcons() {
  QStringList paths = QIcon::themeSearchPaths();
  for (const QString& folder : QStandardPaths::standardLocations(QStandardPaths::GenericDataLocation))
    if (const QString icons = folder + "/icons"; !paths.contains(icons)) paths << icons;
  QIcon::setThemeSearchPaths(paths);
}

}  // namespace

Theme::Theme(Preferences& preferences, QObject* parent) : QObject(parent), preferences_(preferences) {
  findIcons();
  const QPalette system = QApplication::palette();
  system_dark_ = system.color(QPalette::Window).lightness() < system.color(QPalette::WindowText).lightness();
  QApplication::setStyle(new Style);
  apply();
  connect(&preferences, &Preferences::themeChanged, this, [this] {
    apply();
    Q_EMIT changed();
  });
}

void Theme::apply() {
  const ThemeChoice choice = preferences_.theme();
  dark_ = choice == ThemeChoice::Dark || (choice == ThemeChoice::System && system_dark_);
  colours_ = coloursOf(dark_);
  QIcon::setThemeName(dark_ ? "breeze-dark" : "breeze");
  QApplication::setPalette(palette(dark_));
  QToolTip::setPalette(palette(dark_));
}

}  // namespace tiltmap::ui
