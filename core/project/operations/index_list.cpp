#include "core/project/operations/index_list.h"

#include <algorithm>
#include <numeric>

#include "core/base/text.h"

namespace tiltmap {

Result<std::vector<int>> parseIndexList(const std::string& text, int count, const std::string& where) {
  const std::string remedy =
      count > 0 ? "give scan numbers from 0 to " + std::to_string(count - 1) + ", such as 0-5 or 0,2,7"
                : "the project has no scans";
  std::vector<bool> named(static_cast<std::size_t>(count), false);
  std::vector<int> list;
  for (const std::string_view part : splitAt(text, ',')) {
    const auto ends = splitAt(trimmed(part), '-');
    const auto first = parseInteger(ends.front());
    const auto last = ends.size() == 2 ? parseInteger(ends[1]) : first;
    if (!first || !last || ends.size() > 2 || *first < 0 || *last < *first || *last >= count)
      return fail("\"" + std::string(part) + "\" names no scans of this project", where, remedy);
    for (long long i = *first; i <= *last; ++i) {
      if (named[static_cast<std::size_t>(i)]) continue;
      named[static_cast<std::size_t>(i)] = true;
      list.push_back(static_cast<int>(i));
    }
  }
  return list;
}

Result<std::vector<int>> parseIndexesOrAll(const std::string& text, int count, const std::string& where) {
  if (!trimmed(text).empty()) {
    auto list = parseIndexList(text, count, where);
    if (list) std::ranges::sort(*list);
    return list;
  }
  std::vector<int> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace tiltmap
