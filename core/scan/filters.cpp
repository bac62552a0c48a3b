#include "core/scan/filters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

namespace tiltmap {

namespace {

constexpr std::size_t kMostVotes = 9;

// The values that vote, with a border of NaN so that every cell has a whole window. NaN does not vote.
struct VoteMatrix {
  std::size_t border_rows = 0;
  std::size_t border_columns = 0;
  std::size_t stride = 0;
  std::vector<float> value;

  VoteMatrix(const RangeImage& image, const MedianFilterSettings& settings)
      : border_rows(settings.window == MedianWindow::Square ? 1 : 0),
        border_columns(settings.window == MedianWindow::Square ? 1 : 3),
        stride(static_cast<std::size_t>(image.columns()) + 2 * border_columns),
        value((static_cast<std::size_t>(image.rows()) + 2 * border_rows) * stride,
              std::numeric_limits<float>::quiet_NaN()) {
    const auto no_return = static_cast<float>(settings.no_return_range_m);
    for (int row = 0; row < image.rows(); ++row) {
      std::size_t at = place(row, 0);
      std::size_t cell = image.index(row, 0);
      for (int column = 0; column < image.columns(); ++column, ++at, ++cell) {
        const CellCode code = image.code(cell);
        if (cell_code::hasPoint(code)) {
          value[at] = image.range(cell);
        } else if (settings.no_return_votes && cell_code::isFar(code)) {
          value[at] = no_return;
        }
      }
    }
  }
  std::size_t place(int row, int column) const {
    return (static_cast<std::size_t>(row) + border_rows) * stride + static_cast<std::size_t>(column) +
           border_columns;
  }
};

// Where the voters sit, relative to the centre's place, in row-major order.
std::vector<std::ptrdiff_t> windowOffsets(const MedianFilterSettings& settings, std::size_t stride) {
  const std::ptrdiff_t high = settings.window == MedianWindow::Square ? 1 : 0;
  const std::ptrdiff_t wide = settings.window == MedianWindow::Square ? 1 : 3;
  std::vector<std::ptrdiff_t> offsets;
  for (std::ptrdiff_t row = -high; row <= high; ++row)
    for (std::ptrdiff_t column = -wide; column <= wide; ++column)
      if (settings.include_centre || row != 0 || column != 0)
        offsets.push_back(row * static_cast<std::ptrdiff_t>(stride) + column);
  return offsets;
}

// Whether the centre differs too much, by counting: the median is nearer by more than the threshold exactly
// when enough votes are. Sorting is then left to the few cells that change.
bool differs(const float* centre, const std::vector<std::ptrdiff_t>& offsets, float threshold,
             bool one_sided) {
  const float own = *centre;
  int votes = 0, nearer = 0, further = 0;
  for (const std::ptrdiff_t offset : offsets) {
    const float other = centre[offset];
    votes += static_cast<int>(other == other);  // NaN fails all three
    nearer += static_cast<int>(own - other > threshold);
    further += static_cast<int>(other - own > threshold);
  }
  const int lower_middle = (votes - 1) / 2;  // the median's index among the sorted votes
  return nearer > lower_middle || (!one_sided && further >= votes - lower_middle && votes > 0);
}

float lowerMedian(const float* centre, const std::vector<std::ptrdiff_t>& offsets) {
  std::array<float, kMostVotes> votes{};
  std::size_t count = 0;
  for (const std::ptrdiff_t offset : offsets)
    if (!std::isnan(centre[offset])) votes[count++] = centre[offset];
  const auto middle = votes.begin() + static_cast<std::ptrdiff_t>((count - 1) / 2);
  std::nth_element(votes.begin(), middle, votes.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

// The code of the window's first cell without a return; kMeasured where there is none.
CellCode firstFarCode(const RangeImage& image, int row, int column, MedianWindow window) {
  const int high = window == MedianWindow::Square ? 1 : 0;
  const int wide = window == MedianWindow::Square ? 1 : 3;
  for (int r = std::max(row - high, 0); r <= std::min(row + high, image.rows() - 1); ++r)
    for (int c = std::max(column - wide, 0); c <= std::min(column + wide, image.columns() - 1); ++c)
      if (cell_code::isFar(image.code(r, c))) return image.code(r, c);
  return cell_code::kMeasured;
}

void requireUsable(const RangeImagePtr& image, const MedianFilterSettings& settings) {
  if (!image) throw std::invalid_argument("medianFiltered: no image");
  if (!(settings.threshold_m >= 0.0) || !std::isfinite(settings.threshold_m))
    throw std::invalid_argument("medianFiltered: the threshold must be finite and not negative");
  if (!(settings.no_return_range_m > 0.0) || !std::isfinite(settings.no_return_range_m))
    throw std::invalid_argument("medianFiltered: the no-return range must be finite and positive");
}

}  // namespace

double FilteredImage::meanChange() const {
  if (changes.empty()) return 0.0;
  double sum = 0.0;
  for (const CellChange& change : changes) sum += std::abs(change.after_m - change.before_m);
  return sum / static_cast<double>(changes.size());
}

FilteredImage medianFiltered(const RangeImagePtr& image, const MedianFilterSettings& settings) {
  requireUsable(image, settings);
  FilteredImage result{image, {}};
  if (settings.window == MedianWindow::None || !image->isMatrix()) return result;

  const VoteMatrix votes(*image, settings);
  const std::vector<std::ptrdiff_t> offsets = windowOffsets(settings, votes.stride);
  const auto threshold = static_cast<float>(settings.threshold_m);
  const auto no_return = static_cast<float>(settings.no_return_range_m);
  RangeImageData data;  // copied from the image at the first change
  for (int row = 0; row < image->rows(); ++row) {
    const float* centre = votes.value.data() + votes.place(row, 0);
    for (int column = 0; column < image->columns(); ++column, ++centre) {
      if (std::isnan(*centre) || !differs(centre, offsets, threshold, settings.one_sided)) continue;
      const std::size_t cell = image->index(row, column);
      const bool was_point = image->hasPoint(cell);
      if (!was_point && !image->isRegular()) continue;
      const float median = lowerMedian(centre, offsets);
      const CellCode far_code =
          median == no_return ? firstFarCode(*image, row, column, settings.window) : cell_code::kMeasured;
      const bool is_point = !settings.no_return_votes || far_code == cell_code::kMeasured;
      if (!was_point && !is_point) continue;
      if (result.changes.empty()) data = image->data();
      data.code[cell] = is_point ? cell_code::kReplaced : far_code;
      data.range_m[cell] = is_point ? median : 0.0F;
      result.changes.push_back({row, column, static_cast<double>(*centre), static_cast<double>(median)});
    }
  }
  if (result.changes.empty()) return result;
  auto made = RangeImage::make(std::move(data));
  if (!made) throw std::logic_error("medianFiltered: " + made.error().what);
  result.image = *std::move(made);
  return result;
}

}  // namespace tiltmap
