#include "ui/look/theme.h"

#include <QApplication>
#include <QIcon>
#include <QStandardPaths>
#include <QToolTip>

#include "ui/look/style.h"

namespace tiltmap::ui {

namespace {

constexpr double kLargeFont = 1.2;

void setAll(QPalette& palette,
            const std::initializer_list<std::pair<QPalette::ColorRole, const char*>>& roles) {
  for (const auto& [role, colour] : roles) palette.setColor(role, QColor(colour));
}

}  // namespace

namespace {

QPalette highContrastPalette() {
  QPalette palette;
  setAll(palette, {{QPalette::Window, "#ffffff"},
                   {QPalette::WindowText, "#000000"},
                   {QPalette::Base, "#ffffff"},
                   {QPalette::AlternateBase, "#f0f0f0"},
                   {QPalette::Text, "#000000"},
                   {QPalette::Button, "#ffffff"},
                   {QPalette::ButtonText, "#000000"},
                   {QPalette::BrightText, "#ffffff"},
                   {QPalette::Light, "#ffffff"},
                   {QPalette::Midlight, "#d0d0d0"},
                   {QPalette::Mid, "#606060"},
                   {QPalette::Dark, "#202020"},
                   {QPalette::Shadow, "#000000"},
                   {QPalette::ToolTipBase, "#ffffff"},
                   {QPalette::ToolTipText, "#000000"},
                   {QPalette::Highlight, "#00337f"},
                   {QPalette::HighlightedText, "#ffffff"},
                   {QPalette::Link, "#00337f"},
                   {QPalette::LinkVisited, "#4a148c"},
                   {QPalette::PlaceholderText, "#404040"}});
  for (const auto role :
       {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::HighlightedText})
    palette.setColor(QPalette::Disabled, role, QColor("#6a6a6a"));
  palette.setColor(QPalette::Disabled, QPalette::Highlight, QColor("#d0d0d0"));
  return palette;
}

ThemeColours highContrastColours() {
  ThemeColours c;
  c.accent = "#00337f";
  c.muted = "#303030";
  c.good = "#004d00";
  c.warning = "#5c3700";
  c.error = "#8b0000";
  c.warning_ground = "#ffe9a8";
  c.error_ground = "#ffd9d6";
  c.note_ground = "#d6ecff";
  c.line = "#5a5a5a";
  c.view_top = "#ffffff";
  c.view_bottom = "#ffffff";
  c.view_text = "#000000";
  c.view_grid = "#707070";
  c.no_data = "#b0b0b0";
  return c;
}

}  // namespace

QPalette Theme::palette(Look look) {
  if (look == Look::HighContrast) return highContrastPalette();
  const bool dark = look == Look::Dark;
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

ThemeColours Theme::coloursOf(Look look) {
  if (look == Look::HighContrast) return highContrastColours();
  const bool dark = look == Look::Dark;
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
  ordinary_font_ = QApplication::font();
  apply();
  connect(&preferences, &Preferences::themeChanged, this, [this] {
    apply();
    Q_EMIT changed();
  });
}

void Theme::apply() {
  const ThemeChoice choice = preferences_.theme();
  const bool dark = choice == ThemeChoice::Dark || (choice == ThemeChoice::System && system_dark_);
  look_ = choice == ThemeChoice::HighContrast ? Look::HighContrast : dark ? Look::Dark : Look::Light;
  colours_ = coloursOf(look_);
  const bool large = look_ == Look::HighContrast;
  QFont font = ordinary_font_;
  if (large) font.setPointSizeF(font.pointSizeF() * kLargeFont);
  if (font != QApplication::font()) QApplication::setFont(font);
  if (!styled_ || large != large_) QApplication::setStyle(new Style(large));
  styled_ = true;
  large_ = large;
  QIcon::setThemeName(dark && !large ? "breeze-dark" : "breeze");
  QApplication::setPalette(palette(look_));
  QToolTip::setPalette(palette(look_));
}

}  // namespace tiltmap::ui
