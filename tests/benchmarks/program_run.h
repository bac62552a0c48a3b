// The shipped program as its users meet it: a process on a project file.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// Simulates exp2fixed, the loop and a survey of 100 stops, each into a project below `scratch` (which is
// emptied first), and times `tiltmap register` and `tiltmap relax` on a fresh copy each round, with the error
// of each stage (odometry, pairwise, relaxed) as `tiltmap evaluate` tells it. A note instead of rows where
// the program lacks a command.
void addProgramRows(Table& table, const std::filesystem::path& program, const std::filesystem::path& scratch,
                    int rounds, const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
