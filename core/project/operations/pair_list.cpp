#include "core/project/operations/pair_list.h"

#include <algorithm>

#include "core/base/text.h"

namespace tiltmap {

Result<std::vector<IndexPair>> parsePairList(const std::string& text, int scan_count) {
  std::vector<IndexPair> pairs;
  if (trimmed(text).empty()) {
    for (int moving = 1; moving < scan_count; ++moving) pairs.emplace_back(moving - 1, moving);
    return pairs;
  }
  for (const std::string_view part : splitAt(text, ',')) {
    const auto refuse = [&](const std::string& what) {
      return fail("\"" + std::string(part) + "\" " + what, "--pairs " + text,
                  "name pairs as FIXED:MOVING, such as 0:1,1:2, with scans from 0 to " +
                      std::to_string(scan_count - 1));
    };
    const auto ends = splitAt(trimmed(part), ':');
    if (ends.size() != 2) return refuse("is not a pair of scans");
    const auto fixed = parseInteger(ends[0]), moving = parseInteger(ends[1]);
    if (!fixed || !moving) return refuse("is not a pair of scan numbers");
    if (*fixed < 0 || *fixed >= scan_count || *moving < 0 || *moving >= scan_count)
      return refuse("names a scan that the project does not have");
    if (*fixed == *moving) return refuse("pairs a scan with itself");
    const IndexPair pair(static_cast<int>(*fixed), static_cast<int>(*moving));
    if (std::ranges::find(pairs, pair) != pairs.end()) return refuse("is named twice");
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace tiltmap
