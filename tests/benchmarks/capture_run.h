// How long the emulated instruments take for a scan, and the program for its part of it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// One scan of 101 lines at each rate on a virtual clock (wall: the instruments' time; CPU: drivers, emulators
// and the project together), line by line and with the tilt moving on, and some in real time over pseudo
// terminals; and where their points lie. Projects are made below `scratch`.
void addCaptureRows(Table& table, const std::filesystem::path& scratch,
                    const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
