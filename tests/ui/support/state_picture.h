// Pictures of the window to be looked at: written where TILTMAP_PICTURES names a folder, in each look.
#pragma once

#include <cstdlib>

#include "tests/ui/support/window_fixture.h"

namespace tiltmap::test {

// "NAME-dark.png" and so on; the light look is on afterwards. Qt's scale goes into the name where it is
// not 1.
inline void takePictures(QWidget& window, ui::Preferences& preferences, const char* name,
                         const std::function<void()>& settle) {
  const char* where = std::getenv("TILTMAP_PICTURES");
  if (!where) return;
  const double ratio = window.devicePixelRatioF();
  const QString scale = ratio == 1.0 ? QString() : QString("@%1x").arg(ratio);
  for (const auto& [look, word] : {std::pair{ui::ThemeChoice::Dark, "dark"},
                                   {ui::ThemeChoice::HighContrast, "contrast"},
                                   {ui::ThemeChoice::Light, "light"}}) {
    preferences.setTheme(look);
    settle();
    EXPECT_TRUE(window.grab().save(QString("%1/%2-%3%4.png").arg(where, name, word, scale)));
  }
}

}  // namespace tiltmap::test
