#include "ui/panels/capture_line_panels.h"

#include <QVBoxLayout>

#include "ui/models/capture_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/polar_view.h"
#include "ui/panels/sweep_matrix_view.h"

namespace tiltmap::ui {

namespace {

void fill(QWidget* panel, QWidget* view) {
  auto* column = new QVBoxLayout(panel);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(view);
  panel->setFocusProxy(view);
}

}  // namespace

CaptureLinePanel::CaptureLinePanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), view_(new PolarView(context.theme, this)) {
  fill(this, view_);
  CaptureModel& model = captureModel(context.workspace);
  connect(&model, &CaptureModel::lineSeen, this, [this, &model](const StationLinePtr& line) {
    view_->setLine(line->range_m, model.azimuths(line->range_m.size()), line->code);
  });
  connect(&model, &CaptureModel::changed, this, [this, &model] {
    if (!model.now().line && !view_->isEmpty()) view_->clear();
  });
}

CaptureMatrixPanel::CaptureMatrixPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), view_(new SweepMatrixView(context.theme, this)) {
  fill(this, view_);
  CaptureModel& model = captureModel(context.workspace);
  const auto begin = [this, &model] {
    if (model.now().sweep.number == 0) return view_->clear();
    view_->begin(model.now().sweep.geometry);
    for (const StationLinePtr& line : model.rows()) view_->setRow(line->row, line->range_m, line->code);
  };
  connect(&model, &CaptureModel::sweepBegan, this, begin);
  connect(&model, &CaptureModel::rowTaken, this, [this](const StationLinePtr& line) {
    if (line->row < view_->rows()) view_->setRow(line->row, line->range_m, line->code);
  });
  begin();
}

}  // namespace tiltmap::ui
