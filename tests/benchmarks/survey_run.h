// Long surveys through the program: how time, memory and error grow with the stops, and what one more costs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// Simulated surveys of 100, 300 and 1000 stops: `tiltmap register`, `tiltmap relax`, then one stop more and
// `tiltmap relax` again, each a process on all cores: wall and CPU time, CPU time a stop and how often that
// of 100 stops, peak memory, and the root mean square error over the stops. False where 1000 stops take more
// than 20 s or 2 GB, a stop of theirs more than 1.5 times one of 100 stops, or one stop more over a tenth of
// all.
bool addSurveyRows(Table& table, const std::filesystem::path& program, const std::filesystem::path& scratch,
                   const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
