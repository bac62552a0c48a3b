// The demo: a simulated survey, made once and kept in the user's data folder.
#pragma once

#include <QString>

namespace tiltmap::ui {

class Workspace;

QString demoProjectPath();
// Opens it; makes it first (simulate and register, as jobs) where it is not there.
void openDemo(Workspace& workspace);

}  // namespace tiltmap::ui
