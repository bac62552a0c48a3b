// One depth image with its axes: zoom, pan, marks.
#pragma once

#include <QImage>
#include <QPointF>
#include <QRectF>
#include <QWidget>
#include <memory>
#include <optional>
#include <utility>

#include "core/products/depth_image.h"

namespace tiltmap::ui {

class Theme;

struct MatrixCell {
  int row = 0;
  int column = 0;
  bool operator==(const MatrixCell&) const = default;
};

// Which part of the matrix is seen: two views side by side share it.
struct DepthWindow {
  double zoom = 1.0;         // 1: all of it
  QPointF centre{0.5, 0.5};  // in parts of the picture
  bool operator==(const DepthWindow&) const = default;
};

class DepthView : public QWidget {
  Q_OBJECT

 public:
  explicit DepthView(const Theme& theme, QWidget* parent = nullptr);

  // Nothing: `message` is shown in its place.
  void setImage(std::shared_ptr<const DepthImage> image, const QString& message = {});
  const DepthImage* image() const { return image_.get(); }
  // Of the colour bar; nothing: the image's own.
  void setRange(std::optional<std::pair<double, double>> range);
  std::pair<double, double> range() const;
  void setMarks(std::optional<MatrixCell> hovered, std::optional<MatrixCell> picked);
  void setWindow(const DepthWindow& window);
  const DepthWindow& seen() const { return window_; }

  // Widget coordinates.
  std::optional<MatrixCell> cellAt(const QPointF& place) const;
  QPointF placeOf(const MatrixCell& cell) const;  // its middle
  QSize sizeHint() const override { return {480, 260}; }
  QSize minimumSizeHint() const override { return {200, 130}; }

 Q_SIGNALS:
  void hovered(std::optional<tiltmap::ui::MatrixCell> cell);
  void picked(const tiltmap::ui::MatrixCell& cell);
  void windowChanged(const tiltmap::ui::DepthWindow& window);

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void leaveEvent(QEvent* event) override;

  QRectF room() const;   // inside axes and colour bar
  QRectF whole() const;  // where the whole matrix would lie
  const Theme& theme() const { return theme_; }
  void redraw();  // the image's values or its range have changed
  // The values of one row have changed, and nothing else.
  void redrawRow(int row);

 private:
  void paintAxes(QPainter& painter, const QRectF& seen, const QRectF& all) const;
  void paintBar(QPainter& painter, const QRectF& seen) const;
  void paintMark(QPainter& painter, const MatrixCell& cell, const QColor& colour) const;
  void changeWindow(DepthWindow window);
  void zoomAt(const QPointF& place, double factor);

  const Theme& theme_;
  std::shared_ptr<const DepthImage> image_;
  QString message_;
  QImage cells_;
  std::optional<std::pair<double, double>> range_;
  std::optional<MatrixCell> hovered_, picked_;
  DepthWindow window_;
  QPointF pressed_, last_;
  bool dragging_ = false, dragged_ = false;
};

}  // namespace tiltmap::ui
