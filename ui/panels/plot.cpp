#include "ui/panels/plot.h"

#include <QEvent>
#include <QMouseEvent>
#include <QPolygonF>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>
#include <qwt_legend.h>
#include <qwt_plot.h>
#include <qwt_plot_canvas.h>
#include <qwt_plot_curve.h>
#include <qwt_plot_grid.h>
#include <qwt_plot_histogram.h>
#include <qwt_plot_layout.h>
#include <qwt_plot_marker.h>
#include <qwt_samples.h>
#include <qwt_scale_engine.h>
#include <qwt_scale_widget.h>
#include <qwt_symbol.h>
#include <qwt_text.h>

namespace tiltmap::ui {

namespace {

int axisId(Plot::Axis axis) {
  return axis == Plot::Bottom ? QwtPlot::xBottom : QwtPlot::yLeft;
}

}  // namespace

struct Plot::Parts {
  QwtPlot* plot = nullptr;
  QwtPlotGrid* grid = nullptr;
  QwtPlotMarker* mark = nullptr;
  QwtLegend* legend = nullptr;
  bool equal_scales = false;
  QVector<QwtPlotSeriesItem*> series;
  QVector<bool> is_dots;
  bool legend_changed = false;
  bool restyle_due = false;
  PlotColours colours;

  QwtPlotCurve* curve(int k) const { return static_cast<QwtPlotCurve*>(series[k]); }
  QwtPlotHistogram* histogram(int k) const { return static_cast<QwtPlotHistogram*>(series[k]); }
  int add(QwtPlotSeriesItem* item, bool dots) {
    item->attach(plot);
    series << item;
    is_dots << dots;
    return static_cast<int>(series.size()) - 1;
  }
};

Plot::Plot(const QString& name, const QString& accessible, QWidget* parent)
    : QWidget(parent), parts_(std::make_unique<Parts>()) {
  setObjectName(name);
  setAccessibleName(accessible);
  Parts& p = *parts_;
  p.plot = new QwtPlot(this);
  auto* flat = new QwtPlotCanvas(p.plot);
  flat->setFrameStyle(QFrame::NoFrame);
  flat->setFocusIndicator(QwtPlotCanvas::NoFocusIndicator);
  flat->setPaintAttribute(QwtPlotCanvas::BackingStore, false);
  p.plot->setCanvas(flat);
  flat->installEventFilter(this);
  parts_->plot->installEventFilter(this);
  p.grid = new QwtPlotGrid;
  p.grid->attach(p.plot);
  p.mark = new QwtPlotMarker;
  p.mark->setLineStyle(QwtPlotMarker::VLine);
  p.mark->setVisible(false);
  p.mark->attach(p.plot);
  p.plot->plotLayout()->setAlignCanvasToScales(true);
  p.plot->plotLayout()->setCanvasMargin(0);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(4, 4, 12, 4);
  layout->addWidget(p.plot);
  setMinimumSize(120, 90);
}

Plot::~Plot() = default;

void Plot::setColours(const PlotColours& colours) {
  parts_->colours = colours;
  restyle();
}

void Plot::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::FontChange) restyle();
  // A style sheet above gives the parts back the palettes they had before it, after this has been told.
  if (event->type() == QEvent::StyleChange && !parts_->restyle_due) {
    parts_->restyle_due = true;
    QMetaObject::invokeMethod(
        this,
        [this] {
          parts_->restyle_due = false;
          restyle();
        },
        Qt::QueuedConnection);
  }
}

void Plot::restyle() {
  Parts& p = *parts_;
  p.plot->setCanvasBackground(p.colours.canvas);
  p.grid->setPen(p.colours.line, 1.0, Qt::SolidLine);
  p.mark->setLinePen(p.colours.accent, 2.0, Qt::DashLine);
  for (const Axis axis : {Bottom, Left}) {
    QwtScaleWidget* widget = p.plot->axisWidget(axisId(axis));
    QPalette palette = widget->palette();
    palette.setColor(QPalette::WindowText, p.colours.text);
    palette.setColor(QPalette::Text, p.colours.text);
    widget->setPalette(palette);
    p.plot->setAxisFont(axisId(axis), font());
    if (!p.plot->axisTitle(axisId(axis)).isEmpty()) setTitleOf(axis, p.plot->axisTitle(axisId(axis)).text());
  }
  redraw();
}

void Plot::setTitleOf(Axis axis, const QString& title) {
  QwtText text(title);
  text.setFont(font());
  text.setColor(parts_->colours.muted);
  parts_->plot->setAxisTitle(axisId(axis), text);
}

void Plot::setRange(Axis axis, double from, double to, double step) {
  parts_->plot->setAxisScale(axisId(axis), from, to, step);
}

void Plot::setAutomatic(Axis axis) {
  parts_->plot->setAxisAutoScale(axisId(axis));
}

void Plot::setLogarithmic(Axis axis) {
  parts_->plot->setAxisScaleEngine(axisId(axis), new QwtLogScaleEngine);
}

void Plot::setEqualScales() {
  parts_->equal_scales = true;
}

void Plot::fitSeries() {
  QPolygonF all;
  for (int k = 0; k < parts_->series.size(); ++k) all += points(k);
  const QRectF room = all.isEmpty() ? QRectF(-10.0, -5.0, 20.0, 10.0) : all.boundingRect();
  // The numbers beside the axes take of the canvas' room: twice, so that they are known.
  for (int pass = 0; pass < 2; ++pass) {
    const QSizeF size = parts_->plot->canvas()->size();
    if (size.isEmpty()) return;
    const double per_px = 1.04 * std::max(room.width() / size.width(), room.height() / size.height());
    const QPointF half(0.5 * per_px * size.width(), 0.5 * per_px * size.height());
    parts_->plot->setAxisScale(QwtPlot::xBottom, room.center().x() - half.x(), room.center().x() + half.x());
    parts_->plot->setAxisScale(QwtPlot::yLeft, room.center().y() - half.y(), room.center().y() + half.y());
    parts_->plot->updateAxes();
    parts_->plot->updateLayout();
  }
  parts_->plot->replot();
}

std::pair<double, double> Plot::range(Axis axis) const {
  const QwtInterval shown = parts_->plot->axisInterval(axisId(axis));
  return {shown.minValue(), shown.maxValue()};
}

void Plot::showLegend() {
  parts_->legend = new QwtLegend(parts_->plot);
  parts_->legend->setDefaultItemMode(QwtLegendData::ReadOnly);
  parts_->plot->insertLegend(parts_->legend, QwtPlot::TopLegend);
}

int Plot::addCurve(const QString& title) {
  auto* curve = new QwtPlotCurve(title);
  curve->setRenderHint(QwtPlotItem::RenderAntialiased);
  curve->setLegendAttribute(QwtPlotCurve::LegendShowLine);
  curve->setLegendIconSize(QSize(24, 8));
  return parts_->add(curve, false);
}

int Plot::addDots(const QString& title) {
  auto* curve = new QwtPlotCurve(title);
  curve->setStyle(QwtPlotCurve::NoCurve);
  curve->setLegendAttribute(QwtPlotCurve::LegendShowSymbol);
  return parts_->add(curve, true);
}

int Plot::addHistogram(const QString& title) {
  auto* histogram = new QwtPlotHistogram(title);
  histogram->setStyle(QwtPlotHistogram::Columns);
  return parts_->add(histogram, false);
}

void Plot::setPen(int series, const QColor& colour, Qt::PenStyle style, double width) {
  QwtPlotCurve* curve = parts_->curve(series);
  curve->setPen(colour, width, style);
  const int size = parts_->is_dots[series] ? static_cast<int>(width) : 5;
  curve->setSymbol(new QwtSymbol(QwtSymbol::Ellipse, QBrush(colour), QPen(Qt::NoPen), QSize(size, size)));
}

void Plot::setFill(int series, const QColor& outline, const QColor& fill) {
  QwtPlotHistogram* histogram = parts_->histogram(series);
  histogram->setPen(outline.isValid() ? QPen(outline, 1.2) : QPen(Qt::NoPen));
  histogram->setBrush(fill.isValid() ? QBrush(fill) : QBrush(Qt::NoBrush));
}

void Plot::setPoints(int series, const QVector<QPointF>& points) {
  parts_->curve(series)->setSamples(points);
}

void Plot::setBars(int series, const QVector<PlotBar>& bars) {
  QVector<QwtIntervalSample> samples;
  for (const PlotBar& bar : bars) samples << QwtIntervalSample(bar.height, bar.from, bar.to);
  parts_->histogram(series)->setSamples(samples);
}

void Plot::setInLegend(int series, bool shown) {
  QwtPlotItem& item = *parts_->series[series];
  if (item.testItemAttribute(QwtPlotItem::Legend) == shown) return;
  item.setItemAttribute(QwtPlotItem::Legend, shown);
  parts_->legend_changed = true;
}

void Plot::setMark(std::optional<double> x) {
  parts_->mark->setVisible(x.has_value());
  if (x) parts_->mark->setXValue(*x);
}

void Plot::redraw() {
  parts_->plot->replot();
  // A legend that entries come to while its plot is hidden leaves out those that were there before: it is
  // made anew.
  if (std::exchange(parts_->legend_changed, false) && parts_->legend) showLegend();
  if (parts_->equal_scales) fitSeries();
}

QVector<QPointF> Plot::points(int series) const {
  QVector<QPointF> points;
  const QwtPlotCurve* curve = parts_->curve(series);
  for (std::size_t k = 0; k < curve->dataSize(); ++k) points << curve->sample(static_cast<int>(k));
  return points;
}

QVector<PlotBar> Plot::bars(int series) const {
  QVector<PlotBar> bars;
  const QwtPlotHistogram* histogram = parts_->histogram(series);
  for (std::size_t k = 0; k < histogram->dataSize(); ++k) {
    const QwtIntervalSample sample = histogram->sample(static_cast<int>(k));
    bars << PlotBar{sample.interval.minValue(), sample.interval.maxValue(), sample.value};
  }
  return bars;
}

std::optional<double> Plot::mark() const {
  if (!parts_->mark->isVisible()) return std::nullopt;
  return parts_->mark->xValue();
}

QWidget* Plot::canvas() const {
  return parts_->plot->canvas();
}

QPointF Plot::placeOf(const QPointF& value) const {
  return {parts_->plot->transform(QwtPlot::xBottom, value.x()),
          parts_->plot->transform(QwtPlot::yLeft, value.y())};
}

bool Plot::eventFilter(QObject* watched, QEvent* event) {
  if (watched == canvas() && event->type() == QEvent::MouseButtonPress) {
    const auto* mouse = static_cast<QMouseEvent*>(event);
    if (mouse->button() == Qt::LeftButton)
      Q_EMIT clickedAt(parts_->plot->invTransform(QwtPlot::xBottom, mouse->pos().x()));
  }
  // Once the canvas has its size. It changes with the numbers beside the axes as well, and that is no reason.
  if (watched == parts_->plot && event->type() == QEvent::Resize && parts_->equal_scales)
    QTimer::singleShot(0, this, [this] { fitSeries(); });
  return QWidget::eventFilter(watched, event);
}

}  // namespace tiltmap::ui
