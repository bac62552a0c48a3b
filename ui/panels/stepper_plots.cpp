#include "ui/panels/stepper_plots.h"

#include <algorithm>
#include <cmath>

#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/scene/registration_layer.h"

namespace tiltmap::ui {

namespace {

QColor colourOf(Rgb c) {
  return {c.r, c.g, c.b};
}

Qt::PenStyle penOf(RejectReason reason) {
  switch (reason) {
    case RejectReason::None:
      return Qt::SolidLine;
    case RejectReason::TooFar:
      return Qt::DashLine;
    case RejectReason::NormalDisagrees:
      return Qt::DotLine;
    case RejectReason::Statistics:
      return Qt::DashDotLine;
    default:
      return Qt::DashDotDotLine;
  }
}

}  // namespace

StepperPlot::StepperPlot(const PanelContext& context, const QString& name, const QString& accessible,
                         QWidget* parent)
    : Plot(name, accessible, parent), model_(context.workspace.stepper()), theme_(context.theme) {}

void StepperPlot::follow() {
  connect(&theme_, &Theme::changed, this, &StepperPlot::restyle);
  connect(&model_, &StepperModel::stepsChanged, this, [this] { refresh(); });
  connect(&model_, &StepperModel::positionChanged, this, [this] { refresh(); });
  restyle();
}

void StepperPlot::restyle() {
  const ThemeColours& c = theme_.colours();
  const QPalette palette = Theme::palette(theme_.look());
  setColours({palette.color(QPalette::Base), palette.color(QPalette::WindowText), c.muted, c.line, c.accent});
  refresh();
}

void StepperPlot::goToClicked() {
  connect(this, &Plot::clickedAt, this, [this](double x) { model_.goTo(static_cast<int>(std::lround(x))); });
}

void StepperPlot::setIterations() {
  const int count = model_.count();
  const double step = count <= 12 ? 1.0 : count <= 30 ? 5.0 : count <= 60 ? 10.0 : 20.0;
  setRange(Bottom, 0.0, std::max(1, count), step);
  setMark(model_.position() > 0 ? std::optional<double>(model_.position()) : std::nullopt);
}

ConvergencePlot::ConvergencePlot(const PanelContext& context, QWidget* parent)
    : StepperPlot(context, "stepper-convergence", "RMS residual by iteration", parent),
      rms_(addCurve("RMS residual")),
      scale_(addCurve("loss scale")) {
  setToolTip("RMS residual and loss scale of every iteration, logarithmic; click to go to one");
  setLogarithmic(Left);
  setTitleOf(Bottom, "iteration");
  setTitleOf(Left, "mm");
  showLegend();
  goToClicked();
  follow();
}

void ConvergencePlot::refresh() {
  setPen(rms_, theme_.colours().accent, Qt::SolidLine, 2.0);
  setPen(scale_, theme_.colours().warning, Qt::DashLine, 1.5);
  QVector<QPointF> rms, scale;
  for (int k = 0; k < model_.count(); ++k) {
    const StepReport& report = model_.steps()[static_cast<std::size_t>(k)]->report;
    // A logarithmic axis has no place for zero.
    if (report.rms_m > 0.0) rms << QPointF(k + 1, 1e3 * report.rms_m);
    if (report.loss.scale_m > 0.0) scale << QPointF(k + 1, std::max(1e-2, 1e3 * report.loss.scale_m));
  }
  setPoints(rms_, rms);
  setPoints(scale_, scale);
  setInLegend(scale_, !scale.isEmpty());
  if (rms.isEmpty() && scale.isEmpty())
    setRange(Left, 1.0, 1000.0);
  else
    setAutomatic(Left);
  setIterations();
  redraw();
}

PairsPlot::PairsPlot(const PanelContext& context, QWidget* parent)
    : StepperPlot(context, "stepper-pairs", "Pairs by reason and iteration", parent) {
  setToolTip("Pairs kept and rejected, by reason; click to go to an iteration");
  for (std::size_t k = 0; k < kRejectReasons; ++k)
    curves_[k] = addCurve(qt(rejectReasonName(static_cast<RejectReason>(k))));
  setTitleOf(Bottom, "iteration");
  setTitleOf(Left, "pairs");
  showLegend();
  goToClicked();
  follow();
}

void PairsPlot::refresh() {
  const RegistrationColours colours = RegistrationColours::of(theme_.isDark());
  double most = 1.0;
  for (std::size_t reason = 0; reason < kRejectReasons; ++reason) {
    setPen(curves_[reason], colourOf(colours.fate[reason]), penOf(static_cast<RejectReason>(reason)),
           reason == 0 ? 2.4 : 1.6);
    QVector<QPointF> points;
    bool any = reason == 0;
    for (int k = 0; k < model_.count(); ++k) {
      const auto count =
          static_cast<double>(model_.steps()[static_cast<std::size_t>(k)]->report.rejected[reason]);
      points << QPointF(k + 1, count);
      any |= count > 0.0;
      most = std::max(most, count);
    }
    // Reasons that never came up are no lines along the bottom.
    setPoints(curves_[reason], any ? points : QVector<QPointF>());
    setInLegend(curves_[reason], any);
  }
  setRange(Left, 0.0, model_.count() > 0 ? 1.05 * most : 1000.0);
  setIterations();
  redraw();
}

ResidualPlot::ResidualPlot(const PanelContext& context, QWidget* parent)
    : StepperPlot(context, "stepper-residuals", "Histogram of the residuals", parent),
      weighted_(addHistogram("by weight")),
      all_(addHistogram("kept pairs")) {
  setToolTip(
      "Residuals of the kept pairs at the iteration shown; filled: each by the weight the loss leaves it. "
      "The mark is the median");
  setTitleOf(Bottom, "residual (mm)");
  setTitleOf(Left, "pairs");
  showLegend();
  follow();
}

void ResidualPlot::refresh() {
  const QColor kept = colourOf(RegistrationColours::of(theme_.isDark()).fate[0]);
  QColor filled = kept;
  filled.setAlpha(150);
  setFill(all_, kept, {});
  setFill(weighted_, {}, filled);
  const ResidualHistogram histogram = residualHistogram(model_.pairs());
  QVector<PlotBar> all, weighted;
  double most = 1.0;
  for (std::size_t k = 0; k < histogram.counts.size(); ++k) {
    const double from = 1e3 * histogram.bin_m * static_cast<double>(k), to = from + 1e3 * histogram.bin_m;
    const auto count = static_cast<double>(histogram.counts[k]);
    all << PlotBar{from, to, count};
    weighted << PlotBar{from, to, histogram.weighted[k]};
    most = std::max(most, count);
  }
  setBars(all_, all);
  setBars(weighted_, weighted);
  setRange(Bottom, 0.0, all.isEmpty() ? 100.0 : all.back().to);
  setRange(Left, 0.0, 1.05 * most);
  setTitleOf(Bottom, histogram.beyond > 0 ? QString("residual (mm); %1 lie further out").arg(histogram.beyond)
                                          : QString("residual (mm)"));
  setMark(all.isEmpty() ? std::nullopt : std::optional(1e3 * histogram.median_m));
  redraw();
}

HeadingPlot::HeadingPlot(const PanelContext& context, QWidget* parent)
    : StepperPlot(context, "stepper-headings", "Score by heading", parent), score_(addCurve("score")) {
  setToolTip("Share of the moving scan that fits, by the heading tried; the mark is the best");
  setTitleOf(Bottom, "heading against the start (degrees, left positive)");
  setTitleOf(Left, "fits (%)");
  setRange(Bottom, -180.0, 180.0, 45.0);
  setRange(Left, 0.0, 100.0);
  connect(&model_.start(), &StartModel::sweepChanged, this, [this] { refresh(); });
  follow();
}

void HeadingPlot::refresh() {
  setPen(score_, theme_.colours().accent, Qt::SolidLine, 2.0);
  const auto& sweep = model_.start().sweep();
  QVector<QPointF> points;
  if (sweep)
    for (const HeadingScore& one : sweep->scores)
      points << QPointF(one.turned_rad / kDegree, 100.0 * one.score);
  setPoints(score_, points);
  setMark(sweep ? std::optional(sweep->bestScore().turned_rad / kDegree) : std::nullopt);
  redraw();
}

}  // namespace tiltmap::ui
