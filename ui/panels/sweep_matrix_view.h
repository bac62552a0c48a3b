// The range matrix while a sweep fills it, line by line.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/scan/range_image.h"
#include "ui/panels/depth_view.h"

class QPainter;

namespace tiltmap::ui {

// What became of a row.
enum class SweepRow {
  Waiting,  // hatched
  Spoiled,  // came to nothing and will be taken again: hatched, with a cross beside it
  Taken,
  Retaken,  // had been spoiled before: a ring beside it
};

// Zoom, axes, colours and colour bar are the depth image's; a row costs no more than its own cells, and the
// colours' ends follow the ranges in steps, so that the picture is steady. Once all rows are there they are
// those of the depth image.
class SweepMatrixView : public DepthView {
  Q_OBJECT

 public:
  explicit SweepMatrixView(const Theme& theme, QWidget* parent = nullptr);

  // A new matrix, nothing taken; axes are angles.
  void begin(const ScannerGeometry& geometry);
  // The same without angles: axes are numbers of rows and columns. Throws std::invalid_argument unless both
  // are positive.
  void begin(int rows, int columns);
  void clear();

  // Metres (of cells with a point) and codes, one a column. A row that was spoiled becomes Retaken, any
  // other Taken. Throws std::invalid_argument for another number of cells, std::out_of_range for a row that
  // is not there.
  void setRow(int row, std::span<const float> ranges_m, std::span<const CellCode> codes);
  // A row that had been taken stays what it is.
  void setSpoiled(int row);
  // The row being taken, marked at both sides; nothing: none is.
  void setCurrentRow(std::optional<int> row);

  int rows() const { return static_cast<int>(states_.size()); }
  SweepRow state(int row) const { return states_.at(static_cast<std::size_t>(row)); }
  int taken() const { return taken_; }  // rows
  std::optional<int> currentRow() const { return current_; }
  // "Row 12 (tilt -20.4°), column 30 (azimuth 15.0°): 3.27 m", as the tooltip of a cell has it.
  QString cellText(const MatrixCell& cell) const;
  // Where a row lies, widget coordinates; clipped to what is seen.
  QRectF placeOfRow(int row) const;

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;

 private:
  void begin(DepthImage image);
  void followRange();
  void paintRows(QPainter& painter, const QRectF& seen) const;
  void paintSigns(QPainter& painter, const QRectF& seen) const;

  std::shared_ptr<DepthImage> matrix_;  // shown; changed here alone
  std::vector<CellCode> codes_;
  std::vector<SweepRow> states_;
  std::optional<int> current_;
  int taken_ = 0;
};

}  // namespace tiltmap::ui
