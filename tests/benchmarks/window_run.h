// The window as its users meet it: frames while moving, the start of the program, memory.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// Runs the window's benchmark program on a virtual display (software OpenGL) below `scratch`: the map of 10
// million points turned with the mouse, plain, coloured and shaded; the program started and a project of 14
// scans, made by `tiltmap`, opened; stops captured with emulated instruments. False where a limit does not
// hold: 20 frames a second with 50,000 points, 1 s to the usable window and 1 s more to the drawn project,
// 400 MB with 14 scans, 0.5 s from a stop's last line to its verdict, 50 ms that an event
// waits while an instrument is silent.
bool addWindowRows(Table& table, const std::filesystem::path& benchmark, const std::filesystem::path& program,
                   const std::filesystem::path& scratch, const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
