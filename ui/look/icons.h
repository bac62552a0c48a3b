// Icons by name: our own drawings first, the installed theme's else.
#pragma once

#include <QIcon>

namespace tiltmap::ui {

// Own icons take the text colour of the palette when they are painted, at the resolution of the screen they
// are painted on; the theme's come in a light and a dark kind, which Theme chooses.
QIcon icon(const QString& name);

}  // namespace tiltmap::ui
