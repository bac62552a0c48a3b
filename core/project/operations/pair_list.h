// Which pairs of scans a command names.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"

namespace tiltmap {

// Scan indices: fixed and moving.
using IndexPair = std::pair<int, int>;

// "0:1,1:2" to pairs of indices below scan_count; empty text: every scan with the one before it. Refuses,
// naming the part: what is not FIXED:MOVING, an index that is not there, a scan with itself, a pair named
// twice.
Result<std::vector<IndexPair>> parsePairList(const std::string& text, int scan_count);

}  // namespace tiltmap
