#include "core/scan/cell_mask.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap {

namespace {

// Larger than any scanner's; sizes of a file that is damaged are no reason to ask for memory.
constexpr int kMostRows = 100'000, kMostColumns = 100'000;

}  // namespace

std::size_t CellMask::cells() const {
  std::size_t sum = 0;
  for (const CellRun& run : runs) sum += static_cast<std::size_t>(run.last - run.first + 1);
  return sum;
}

CellMask cellMask(int rows, int columns, const std::vector<char>& masked) {
  if (rows < 0 || columns < 0 ||
      masked.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))
    throw std::invalid_argument("cellMask: not one flag a cell");
  CellMask mask{rows, columns, {}};
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto at = [&](int c) {
        return masked[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                      static_cast<std::size_t>(c)] != 0;
      };
      if (!at(column)) continue;
      const int first = column;
      while (column + 1 < columns && at(column + 1)) ++column;
      mask.runs.push_back({row, first, column});
    }
  return mask;
}

std::vector<char> maskedCells(const CellMask& mask) {
  const auto columns = static_cast<std::size_t>(mask.columns);
  std::vector<char> cells(static_cast<std::size_t>(mask.rows) * columns, 0);
  for (const CellRun& run : mask.runs)
    for (int column = run.first; column <= run.last; ++column)
      cells[static_cast<std::size_t>(run.row) * columns + static_cast<std::size_t>(column)] = 1;
  return cells;
}

Status checkCellMask(const CellMask& mask) {
  const auto refuse = [](const std::string& what) {
    return fail(what, "mask of cells", "learn the mask anew from scans of this scanner");
  };
  if (mask.rows < 1 || mask.columns < 1 || mask.rows > kMostRows || mask.columns > kMostColumns)
    return refuse("the mask's size is impossible");
  const CellRun* before = nullptr;
  for (const CellRun& run : mask.runs) {
    if (run.row < 0 || run.row >= mask.rows || run.first < 0 || run.first > run.last ||
        run.last >= mask.columns)
      return refuse("the mask names cells outside of its matrix");
    if (before && (before->row > run.row || (before->row == run.row && before->last >= run.first)))
      return refuse("the mask's runs are not in order");
    before = &run;
  }
  return {};
}

std::string cellMaskText(const CellMask& mask) {
  std::string text = std::to_string(mask.rows) + "x" + std::to_string(mask.columns);
  for (const CellRun& run : mask.runs)
    text += " " + std::to_string(run.row) + ":" + std::to_string(run.first) + "-" + std::to_string(run.last);
  return text;
}

Result<CellMask> parseCellMask(const std::string& text, const std::string& where) {
  const auto refuse = [&] {
    return fail("the mask of cells cannot be read", where, "learn the mask anew from scans of this scanner");
  };
  // Whole numbers that fit; all else is no mask.
  const auto number = [](std::string_view word) -> std::optional<int> {
    const auto value = parseInteger(word);
    if (!value || *value < 0 || *value > kMostColumns) return std::nullopt;
    return static_cast<int>(*value);
  };
  CellMask mask;
  bool first = true;
  for (const std::string_view word : splitWords(text)) {
    if (first) {
      const auto size = splitAt(word, 'x');
      if (size.size() != 2) return refuse();
      const auto rows = number(size[0]), columns = number(size[1]);
      if (!rows || !columns) return refuse();
      mask.rows = *rows;
      mask.columns = *columns;
      first = false;
      continue;
    }
    const auto parts = splitAt(word, ':');
    if (parts.size() != 2) return refuse();
    const auto ends = splitAt(parts[1], '-');
    if (ends.size() != 2) return refuse();
    const auto row = number(parts[0]), from = number(ends[0]), to = number(ends[1]);
    if (!row || !from || !to) return refuse();
    mask.runs.push_back({*row, *from, *to});
  }
  if (const Status status = checkCellMask(mask); !status) return refuse();
  return mask;
}

bool maskCells(const CellMask& mask, RangeImageData& data) {
  if (mask.rows != data.rows || mask.columns != data.columns) return false;
  for (const CellRun& run : mask.runs)
    for (int column = run.first; column <= run.last; ++column) {
      CellCode& code = data.code[static_cast<std::size_t>(run.row) * static_cast<std::size_t>(data.columns) +
                                 static_cast<std::size_t>(column)];
      if (code != cell_code::kNotScanned) code = cell_code::kMasked;
    }
  return true;
}

}  // namespace tiltmap
