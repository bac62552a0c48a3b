// Pictures of panels compared with ones that were looked at, cell by cell, so that fonts and antialiasing do
// not matter.
#pragma once

#include <QImage>
#include <QString>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tiltmap::test {

// The mean colour of each cell of a grid over the picture, 0 to 255, as text: small enough to be kept with
// the tests and read in a change.
inline std::vector<int> panelCells(const QImage& picture, int columns, int rows) {
  const QImage small = picture.convertToFormat(QImage::Format_RGB32)
                           .scaled(columns * 8, rows * 8, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
  std::vector<int> cells;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      int sum[3] = {0, 0, 0};
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          const QRgb pixel = small.pixel(8 * column + x, 8 * row + y);
          sum[0] += qRed(pixel);
          sum[1] += qGreen(pixel);
          sum[2] += qBlue(pixel);
        }
      for (const int value : sum) cells.push_back(value / 64);
    }
  return cells;
}

// Compares with tests/ui/baselines/NAME.txt under `source`: at most `far` (share) of the cells may differ by
// more than `tolerance` levels. With TILTMAP_NEW_BASELINES set it is written anew, and the test fails to say
// so.
inline void expectLikePanelBaseline(const QImage& picture, const std::string& source, const std::string& name,
                                    int tolerance = 12, double far = 0.04) {
  constexpr int kColumns = 24, kRows = 16;
  ASSERT_FALSE(picture.isNull());
  const std::vector<int> cells = panelCells(picture, kColumns, kRows);
  const std::string path = source + "/tests/ui/baselines/" + name + ".txt";
  if (std::getenv("TILTMAP_NEW_BASELINES")) {
    std::ofstream out(path);
    for (std::size_t i = 0; i < cells.size(); ++i)
      out << cells[i] << ((i + 1) % (3 * kColumns) == 0 ? "\n" : " ");
    picture.save(QString::fromStdString(path + ".png"));
    FAIL() << "the baseline was written anew: look at " << path << ".png, then run without it";
  }
  std::ifstream in(path);
  std::vector<int> known;
  for (int value = 0; in >> value;) known.push_back(value);
  ASSERT_EQ(known.size(), cells.size()) << "there is no baseline " << path;
  std::size_t off = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) off += std::abs(cells[i] - known[i]) > tolerance;
  EXPECT_LE(static_cast<double>(off), far * static_cast<double>(cells.size()))
      << name << ": " << off << " of " << cells.size() << " values differ";
}

}  // namespace tiltmap::test
