// The plan of the site, drawn and driven: zoom, shift, choose, and place the picture by two points.
#pragma once

#include <QPixmap>
#include <QWidget>
#include <optional>

#include "ui/models/site_map_model.h"
#include "ui/panels/panel.h"

namespace tiltmap::ui {

class SiteMapView : public QWidget {
  Q_OBJECT

 public:
  SiteMapView(SiteMapModel& model, const PanelContext& context, QWidget* parent = nullptr);

  const MapWindow& seen() const { return seen_; }
  void fit();
  bool isFitted() const { return fitted_; }
  void setPictureShown(bool shown);
  void setLegendShown(bool shown);
  // Where the picture is to be placed by two points: a point in the picture, where it belongs, and both once
  // more. Snaps to stops. Esc ends it.
  void startPlacing();
  void stopPlacing();
  bool isPlacing() const { return placing_.has_value(); }
  QString placingText() const;  // what to do next

 Q_SIGNALS:
  void placingChanged();

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  bool event(QEvent* event) override;

 private:
  struct Placing {
    std::vector<QPointF> picture_px;
    std::vector<QPointF> world_m;
  };
  void click(const QPointF& at, Qt::KeyboardModifiers keys);
  void placeClick(const QPointF& at);
  QPointF snapped(const QPointF& at) const;  // pixel to world, onto a stop near by
  void zoom(const QPointF& at, double factor);
  void drawPicture(QPainter& painter) const;
  void drawGrid(QPainter& painter) const;
  void drawLinks(QPainter& painter) const;
  void drawStops(QPainter& painter) const;
  void drawNumbers(QPainter& painter) const;
  void drawPlacing(QPainter& painter) const;
  void drawScale(QPainter& painter) const;
  void drawNorth(QPainter& painter) const;
  void drawLegend(QPainter& painter) const;
  void selectNext(int step);

  SiteMapModel& model_;
  PanelContext context_;
  MapWindow seen_;
  bool fitted_ = true;
  bool picture_shown_ = true;
  bool legend_shown_ = true;
  std::optional<QPointF> pressed_, dragged_;
  QPointF pointer_;
  std::optional<Placing> placing_;
};

}  // namespace tiltmap::ui
