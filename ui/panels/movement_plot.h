// How far each scan has moved from its start, step by step, and the residual beside it.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

namespace tiltmap::ui {

// Lines in the scans' colours; the selected scans' stand out. A click selects the line below the pointer.
class MovementPlot : public QWidget {
  Q_OBJECT

 public:
  explicit MovementPlot(const PanelContext& context, QWidget* parent = nullptr);
  // The index of the scan whose line passes nearest, within a few pixels; -1: none.
  int scanNear(const QPointF& at) const;
  QSize sizeHint() const override { return {360, 200}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  bool event(QEvent* event) override;

 private:
  struct Axes {
    QRectF area;       // pixels
    double steps = 1;  // at the right end
    double moved_m = 0.0, rms_m = 0.0;
    QPointF moved(double step, double metres) const;
    QPointF rms(double step, double metres) const;
  };
  Axes axes() const;
  void drawAxes(QPainter& painter, const Axes& axes) const;

  PanelContext context_;
};

}  // namespace tiltmap::ui
