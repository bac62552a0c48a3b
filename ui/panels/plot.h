// A plot: curves, histograms and dots over two axes.
#pragma once

#include <QColor>
#include <QPointF>
#include <QVector>
#include <QWidget>
#include <memory>
#include <optional>

namespace tiltmap::ui {

struct PlotColours {
  QColor canvas, text, muted, line, accent;
};

struct PlotBar {
  double from = 0.0, to = 0.0, height = 0.0;
};

// The one place that knows Qwt, whose headers are no C++20: this file and its source are compiled as C++17
// and include nothing of ours. Vertical marks show positions; a click tells its x.
class Plot : public QWidget {
  Q_OBJECT

 public:
  enum Axis { Bottom, Left };

  Plot(const QString& name, const QString& accessible, QWidget* parent = nullptr);
  ~Plot() override;

  void setColours(const PlotColours& colours);
  void setTitleOf(Axis axis, const QString& title);
  void setRange(Axis axis, double from, double to, double step = 0.0);
  void setAutomatic(Axis axis);
  void setLogarithmic(Axis axis);
  // The same length of both axes shows the same number of units, and both hold all points.
  void setEqualScales();
  std::pair<double, double> range(Axis axis) const;  // shown
  void showLegend();

  // The numbers name the series from now on. Dots have no line.
  int addCurve(const QString& title);
  int addDots(const QString& title);
  int addHistogram(const QString& title);
  void setPen(int series, const QColor& colour, Qt::PenStyle style, double width);
  void setFill(int series, const QColor& outline, const QColor& fill);  // invalid colours: none
  void setPoints(int series, const QVector<QPointF>& points);
  void setBars(int series, const QVector<PlotBar>& bars);
  void setInLegend(int series, bool shown);
  // Hidden without.
  void setMark(std::optional<double> x);
  void redraw();

  QVector<QPointF> points(int series) const;
  QVector<PlotBar> bars(int series) const;
  std::optional<double> mark() const;
  QWidget* canvas() const;
  QPointF placeOf(const QPointF& value) const;  // on the canvas

 Q_SIGNALS:
  void clickedAt(double x);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void changeEvent(QEvent* event) override;

 private:
  void restyle();
  void fitSeries();  // for equal scales, which have curves and dots only
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tiltmap::ui
