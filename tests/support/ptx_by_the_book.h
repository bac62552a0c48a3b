// A PTX file taken apart as its published layout says, with nothing of ours: columns, rows, the scanner's
// place, its three axes, a 4 x 4 matrix that acts on row vectors, then a line a cell, column by column.
#pragma once

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tiltmap::test {

struct PtxCell {
  std::array<double, 3> local{};  // 0 0 0 where there is no point
  double intensity = 0.0;
  std::vector<int> colour;  // empty or three
};

struct PtxBlock {
  int columns = 0, rows = 0;
  std::array<double, 3> place{};
  std::array<std::array<double, 3>, 3> axes{};
  std::array<std::array<double, 4>, 4> matrix{};
  std::vector<PtxCell> cells;  // column by column

  const PtxCell& cell(int row, int column) const {
    return cells.at(static_cast<std::size_t>(column) * static_cast<std::size_t>(rows) +
                    static_cast<std::size_t>(row));
  }
  // [x y z 1] M
  std::array<double, 3> world(const PtxCell& cell) const {
    std::array<double, 3> out{};
    for (std::size_t j = 0; j < 3; ++j) {
      out[j] = matrix[3][j];
      for (std::size_t i = 0; i < 3; ++i) out[j] += cell.local[i] * matrix[i][j];
    }
    return out;
  }
};

// Throws std::runtime_error where the file is not laid out so.
inline std::vector<PtxBlock> ptxByTheBook(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  const auto numbers = [&](std::size_t least, std::size_t most) {
    if (!std::getline(file, line)) throw std::runtime_error("the file ends too early");
    std::vector<double> values;
    const char* at = line.c_str();
    for (char* end = nullptr;; at = end) {
      const double value = std::strtod(at, &end);
      if (end == at) break;
      values.push_back(value);
    }
    if (*at != '\0' || values.size() < least || values.size() > most)
      throw std::runtime_error("not a line of " + std::to_string(least) + " numbers: " + line);
    return values;
  };
  std::vector<PtxBlock> blocks;
  while (file.peek() != std::ifstream::traits_type::eof()) {
    PtxBlock block;
    block.columns = static_cast<int>(numbers(1, 1)[0]);
    block.rows = static_cast<int>(numbers(1, 1)[0]);
    const auto place = numbers(3, 3);
    for (std::size_t i = 0; i < 3; ++i) block.place[i] = place[i];
    for (auto& axis : block.axes) {
      const auto values = numbers(3, 3);
      for (std::size_t i = 0; i < 3; ++i) axis[i] = values[i];
    }
    for (auto& row : block.matrix) {
      const auto values = numbers(4, 4);
      for (std::size_t i = 0; i < 4; ++i) row[i] = values[i];
    }
    for (long long k = 0; k < static_cast<long long>(block.columns) * block.rows; ++k) {
      const auto values = numbers(4, 7);
      if (values.size() != 4 && values.size() != 7)
        throw std::runtime_error("neither 4 nor 7 numbers: " + line);
      PtxCell cell{{values[0], values[1], values[2]}, values[3], {}};
      for (std::size_t i = 4; i < values.size(); ++i) cell.colour.push_back(static_cast<int>(values[i]));
      block.cells.push_back(std::move(cell));
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace tiltmap::test
