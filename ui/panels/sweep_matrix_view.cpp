#include "ui/panels/sweep_matrix_view.h"

#include <QHelpEvent>
#include <QPainter>
#include <QToolTip>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/base/text.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
// The ends of the colours move only when they are further off than this share of what lies between them:
// else every line would colour all of the picture a little differently.
constexpr double kSteadyShare = 0.1;
constexpr const char* kEmpty = "No sweep yet. The range matrix fills here line by line as it is captured.";

bool isTaken(SweepRow state) {
  return state == SweepRow::Taken || state == SweepRow::Retaken;
}

}  // namespace

SweepMatrixView::SweepMatrixView(const Theme& theme, QWidget* parent) : DepthView(theme, parent) {
  describe(
      this, "sweep-matrix", "Range matrix of the sweep",
      "The lines of the sweep as they come, hatched where none has been taken yet. Point at a cell to read "
      "it; the wheel zooms.");
  setImage({}, kEmpty);
}

void SweepMatrixView::begin(const ScannerGeometry& geometry) {
  DepthImage image;
  image.rows = geometry.rows;
  image.columns = geometry.columns;
  image.azimuth = {"Azimuth (°)", geometry.azimuth_start_rad / kDegree, geometry.azimuth_step_rad / kDegree};
  image.tilt = {"Tilt (°)", geometry.tilt_start_rad / kDegree, geometry.tilt_step_rad / kDegree};
  begin(std::move(image));
}

void SweepMatrixView::begin(int rows, int columns) {
  DepthImage image;
  image.rows = rows;
  image.columns = columns;
  image.regular = false;
  image.azimuth = {"Column", 0.0, 1.0};
  image.tilt = {"Row", 0.0, 1.0};
  begin(std::move(image));
}

void SweepMatrixView::begin(DepthImage image) {
  if (image.rows < 1 || image.columns < 1) throw std::invalid_argument("a sweep has rows and columns");
  const auto cells = static_cast<std::size_t>(image.rows) * static_cast<std::size_t>(image.columns);
  image.title = std::string("Range");
  image.unit = std::string("m");
  image.low = 0.0;
  image.high = 10.0;  // until there are ranges
  image.value.assign(cells, kNothing);
  codes_.assign(cells, cell_code::kNotScanned);
  states_.assign(static_cast<std::size_t>(image.rows), SweepRow::Waiting);
  current_.reset();
  taken_ = 0;
  matrix_ = std::make_shared<DepthImage>(std::move(image));
  setWindow({});
  setImage(matrix_);
}

void SweepMatrixView::clear() {
  matrix_.reset();
  codes_.clear();
  states_.clear();
  current_.reset();
  taken_ = 0;
  setImage({}, kEmpty);
}

void SweepMatrixView::setRow(int row, std::span<const float> ranges_m, std::span<const CellCode> codes) {
  SweepRow& state = states_.at(static_cast<std::size_t>(row));
  const auto columns = static_cast<std::size_t>(matrix_->columns);
  if (ranges_m.size() != columns || codes.size() != columns)
    throw std::invalid_argument("a row of the matrix has one range and one code a column");
  const std::size_t first = matrix_->index(row, 0);
  for (std::size_t k = 0; k < columns; ++k) {
    codes_[first + k] = codes[k];
    matrix_->value[first + k] = cell_code::hasPoint(codes[k]) ? ranges_m[k] : kNothing;
  }
  if (!isTaken(state)) ++taken_;
  state = state == SweepRow::Spoiled || state == SweepRow::Retaken ? SweepRow::Retaken : SweepRow::Taken;
  redrawRow(row);
  followRange();
}

void SweepMatrixView::followRange() {
  DepthImage next = *matrix_;
  chooseDepthEnds(next);
  const double width = matrix_->high - matrix_->low;
  const bool off = std::abs(next.low - matrix_->low) > kSteadyShare * width ||
                   std::abs(next.high - matrix_->high) > kSteadyShare * width;
  if (!off && taken_ < rows()) return;
  if (next.low == matrix_->low && next.high == matrix_->high) return;
  matrix_->low = next.low;
  matrix_->high = next.high;
  redraw();
}

void SweepMatrixView::setSpoiled(int row) {
  SweepRow& state = states_.at(static_cast<std::size_t>(row));
  if (!isTaken(state)) state = SweepRow::Spoiled;
  update();
}

void SweepMatrixView::setCurrentRow(std::optional<int> row) {
  if (row && (*row < 0 || *row >= rows())) throw std::out_of_range("there is no such row in the sweep");
  if (row == current_) return;
  current_ = row;
  update();
}

QRectF SweepMatrixView::placeOfRow(int row) const {
  if (!matrix_) return {};
  const QRectF all = whole();
  const double high = all.height() / matrix_->rows;
  const QRectF place(all.left(), all.top() + matrix_->pixelOfRow(row) * high, all.width(), high);
  return place.intersected(room());
}

QString SweepMatrixView::cellText(const MatrixCell& cell) const {
  if (!matrix_) return {};
  const auto at = [&](const char* word, const DepthAxis& axis, int number) {
    return matrix_->regular ? QString(" (%1 %2°)").arg(word, qt(fixedReal(axis.at(number), 1))) : QString();
  };
  QString text = QString("Row %1%2, column %3%4: ")
                     .arg(cell.row)
                     .arg(at("tilt", matrix_->tilt, cell.row))
                     .arg(cell.column)
                     .arg(at("azimuth", matrix_->azimuth, cell.column));
  const std::size_t index = matrix_->index(cell.row, cell.column);
  switch (state(cell.row)) {
    case SweepRow::Waiting:
      return text + "not taken yet";
    case SweepRow::Spoiled:
      return text + "spoiled, will be taken again";
    default:
      break;
  }
  const float value = matrix_->value[index];
  text += std::isfinite(value) ? qt(fixedReal(static_cast<double>(value), 2)) + " m"
                               : qt(cellCodeText(codes_[index]));
  return state(cell.row) == SweepRow::Retaken ? text + "; taken again" : text;
}

bool SweepMatrixView::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return DepthView::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const auto cell = cellAt(help->pos());
  QToolTip::showText(help->globalPos(), cell ? cellText(*cell) : matrix_ ? QString() : toolTip(), this);
  return true;
}

void SweepMatrixView::paintEvent(QPaintEvent* event) {
  DepthView::paintEvent(event);
  QPainter painter(this);
  if (matrix_) {
    const QRectF seen = whole().intersected(room());
    paintRows(painter, seen);
    paintSigns(painter, seen);
  }
  if (hasFocus()) {
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(theme().colours().accent);
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void SweepMatrixView::paintRows(QPainter& painter, const QRectF& seen) const {
  painter.save();
  painter.setClipRect(seen);
  const QColor ground = palette().color(QPalette::Base);
  const QBrush hatch(theme().colours().muted, Qt::BDiagPattern);
  // Rows side by side at once: each by itself would leave seams where it does not end on a pixel.
  const auto waits = [this](int pixel_row) { return !isTaken(state(matrix_->rowAtPixel(pixel_row))); };
  for (int y = 0; y < rows();) {
    if (!waits(y)) {
      ++y;
      continue;
    }
    const int from = y;
    while (y < rows() && waits(y)) ++y;
    const QRectF area = placeOfRow(matrix_->rowAtPixel(from)).united(placeOfRow(matrix_->rowAtPixel(y - 1)));
    painter.fillRect(area, ground);
    painter.fillRect(area, hatch);
  }
  painter.setPen(QPen(theme().colours().line, 1.0));
  painter.setBrush(Qt::NoBrush);
  painter.drawRect(seen.adjusted(0.5, 0.5, -0.5, -0.5));
  painter.restore();
}

void SweepMatrixView::paintSigns(QPainter& painter, const QRectF& seen) const {
  const ThemeColours& colours = theme().colours();
  painter.setRenderHint(QPainter::Antialiasing);
  // Beside the matrix, in front of the colour bar.
  const double x = seen.right() + 6.0;
  for (int row = 0; row < rows(); ++row) {
    const QRectF place = placeOfRow(row);
    if (place.isEmpty()) continue;
    const QPointF at(x, place.center().y());
    painter.setBrush(Qt::NoBrush);
    if (state(row) == SweepRow::Spoiled) {
      painter.setPen(QPen(colours.error, 1.8));
      painter.drawLine(at + QPointF(-3, -3), at + QPointF(3, 3));
      painter.drawLine(at + QPointF(-3, 3), at + QPointF(3, -3));
    } else if (state(row) == SweepRow::Retaken) {
      painter.setPen(QPen(colours.warning, 1.6));
      painter.drawEllipse(at, 3.0, 3.0);
    }
  }
  if (!current_) return;
  const QRectF place = placeOfRow(*current_);
  if (place.isEmpty()) return;
  const double y = place.center().y(), high = std::max(2.0, place.height());
  painter.fillRect(QRectF(seen.left(), y - high / 2.0, seen.width(), high), colours.accent);
  painter.setPen(Qt::NoPen);
  painter.setBrush(colours.accent);
  for (const double side : {-1.0, 1.0}) {
    const QPointF tip(side < 0.0 ? seen.left() : seen.right(), y);
    painter.drawPolygon(QPolygonF({tip, tip + QPointF(side * 6.0, -5.0), tip + QPointF(side * 6.0, 5.0)}));
  }
}

}  // namespace tiltmap::ui
