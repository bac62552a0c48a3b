// Which panels stand where in each perspective, as delivered.
#pragma once

#include <QString>
#include <array>
#include <vector>

namespace tiltmap::ui {

enum class Perspective { Capture, Inspect, Register, Relax };
inline constexpr std::array kPerspectives = {Perspective::Capture, Perspective::Inspect,
                                             Perspective::Register, Perspective::Relax};

QString perspectiveName(Perspective perspective);  // "Capture": title; lower case in settings
QString perspectiveHelp(Perspective perspective);

enum class DockSide { Left, Right, Top, Bottom, Tab };

struct DockPlace {
  QString panel;
  DockSide side = DockSide::Left;
  QString beside;      // a panel placed before; empty: the whole window
  double share = 0.0;  // of the width or height of what is divided; 0: half
};

// Panels that do not exist are left out, and what stands beside them goes to the window's side. The first
// fills the window.
std::vector<DockPlace> delivered(Perspective perspective);

}  // namespace tiltmap::ui
