// The shipped program as its users meet it: a process on a project file.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// Makes a project in a folder of its own below `scratch`, simulates exp2fixed into it, and times `tiltmap
// register` (and `tiltmap relax`, where the program has it) on a fresh copy each round, with the error of
// each stage as `tiltmap evaluate` tells it. A note instead of rows where the program lacks a command.
void addProgramRows(Table& table, const std::filesystem::path& program, const std::filesystem::path& scratch,
                    int rounds, const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
