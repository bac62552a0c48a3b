// Light and dark, and the few colours that the palette has no role for.
#pragma once

#include <QColor>
#include <QFont>
#include <QObject>
#include <QPalette>

#include "ui/models/preferences.h"

namespace tiltmap::ui {

struct ThemeColours {
  QColor accent;  // on the window's ground: marks, the current tab
  QColor muted;   // text of second rank, still 4.5 : 1
  QColor good;    // never alone: always with a word or sign
  QColor warning;
  QColor error;
  QColor warning_ground;  // behind text of the ordinary colour
  QColor error_ground;
  QColor note_ground;
  QColor line;      // hairlines between areas
  QColor view_top;  // the 3D view's gradient
  QColor view_bottom;
  QColor view_text;  // on that gradient
  QColor view_grid;
  QColor no_data;  // cells without a point
};

enum class Look { Light, Dark, HighContrast };

// Applies itself to the application: style, palette, icon theme. Follows the preference, and where that says
// so the system's palette at the start of the program.
class Theme : public QObject {
  Q_OBJECT

 public:
  explicit Theme(Preferences& preferences, QObject* parent = nullptr);

  Look look() const { return look_; }
  bool isDark() const { return look_ == Look::Dark; }
  const ThemeColours& colours() const { return colours_; }
  static QPalette palette(Look look);
  static ThemeColours coloursOf(Look look);

 Q_SIGNALS:
  void changed();

 private:
  void apply();

  Preferences& preferences_;
  bool system_dark_ = false;
  Look look_ = Look::Light;
  bool styled_ = false, large_ = false;
  QFont ordinary_font_;  // as the desktop has it
  ThemeColours colours_;
};

}  // namespace tiltmap::ui
