// The program with a window.
#pragma once

#include <stop_token>
#include <string>

#include "core/base/result.h"

namespace tiltmap::ui {

// Whether a window can be opened here; the error says why not. Quick, and before any QApplication: that one
// ends the program where there is no display.
Status displayThere();

// Before and after the QApplication is made, wherever one is made.
void prepareApplication();
void nameApplication();

// Opens the window (on the project, where one is named) and returns when the last window is closed: the exit
// code. A stop (a signal) closes all windows without asking, what runs is cancelled.
int runWindow(int& argc, char** argv, const std::string& project, const std::stop_token& stop);

}  // namespace tiltmap::ui
