// Which scans a command names.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace tiltmap {

// "3", "0-5", "0,2,7-9" to indices below count, in the order named, without repeats. Refuses, naming the
// part, what is no number or is not below count; `where` is the flag it came from.
Result<std::vector<int>> parseIndexList(const std::string& text, int count, const std::string& where);

// The same in ascending order; an empty text names all.
Result<std::vector<int>> parseIndexesOrAll(const std::string& text, int count, const std::string& where);

}  // namespace tiltmap
