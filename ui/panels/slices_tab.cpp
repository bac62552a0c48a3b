#include "ui/panels/slices_tab.h"

#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>

#include "ui/look/theme.h"
#include "ui/models/study_model.h"
#include "ui/models/workspace.h"
#include "ui/scene/registration_layer.h"

namespace tiltmap::ui {

namespace {

QColor colourOf(Rgb c) {
  return {c.r, c.g, c.b};
}

QVector<QPointF> placed(const std::vector<Eigen::Vector3d>& points, const Pose& pose) {
  QVector<QPointF> places;
  for (const Eigen::Vector3d& own : points) {
    const Eigen::Vector3d p = pose * own;
    places << QPointF(p.x(), p.y());
  }
  return places;
}

}  // namespace

SlicePlot::SlicePlot(const PanelContext& context, QWidget* parent)
    : StepperPlot(context, "stepper-slices", "Slices of both scans from above", parent),
      study_(StudyModel::of(model_)),
      fixed_(addDots("fixed")),
      by_scan_(addDots("whole scans")),
      by_slice_(addDots("its slice")) {
  setToolTip(
      "The slices from above: the fixed one, and the moving one where its slice and where the whole scans "
      "put it");
  setTitleOf(Bottom, "x (m)");
  setTitleOf(Left, "y (m)");
  setEqualScales();
  showLegend();
  connect(&study_, &StudyModel::slicesChanged, this, [this] { refresh(); });
  follow();
}

void SlicePlot::refresh() {
  const RegistrationColours colours = RegistrationColours::of(theme_.isDark());
  setPen(fixed_, colourOf(colours.fixed), Qt::SolidLine, 4.0);
  setPen(by_slice_, colourOf(colours.moving), Qt::SolidLine, 3.0);
  setPen(by_scan_, colourOf(colours.ghost), Qt::SolidLine, 3.0);
  const auto& slices = study_.slices();
  const bool compared = slices && model_.count() > 0;
  setPoints(fixed_, slices ? placed(slices->fixed, Pose()) : QVector<QPointF>());
  setPoints(by_slice_, slices ? placed(slices->moving, slices->fixed_from_moving) : QVector<QPointF>());
  setPoints(by_scan_, compared ? placed(slices->moving,
                                        model_.isEnded() ? model_.result()->fixed_from_moving : model_.pose())
                               : QVector<QPointF>());
  setInLegend(by_scan_, compared);
  redraw();
}

SlicesTab::SlicesTab(const PanelContext& context, QWidget* parent)
    : QWidget(parent), stepper_(context.workspace.stepper()), study_(StudyModel::of(stepper_)) {
  height_ = new QDoubleSpinBox(this);
  height_->setObjectName("stepper-slice-height");
  height_->setAccessibleName("Height of the slice");
  height_->setToolTip("Height of the slice above the scanner, -5 to 20 m; it is 0.3 m thick");
  height_->setRange(-5.0, 20.0);
  height_->setSingleStep(0.1);
  height_->setSuffix(" m");
  height_->setKeyboardTracking(false);
  height_->setValue(study_.sliceSettings().height_m);
  match_ = new QPushButton("Match slices", this);
  match_->setObjectName("stepper-match-slices");
  match_->setAccessibleName("Match slices");
  match_->setToolTip("Match a horizontal slice of both scans in the plane, from the same start");
  text_ = new QLabel(this);
  text_->setObjectName("stepper-slice-text");
  text_->setWordWrap(true);
  text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* label = new QLabel("Hei&ght", this);
  label->setBuddy(height_);
  // Beside the plot and not above it: the panel is low, and the plot needs what height there is.
  auto* side = new QWidget(this);
  side->setFixedWidth(36 * fontMetrics().averageCharWidth());
  auto* controls = new QGridLayout(side);
  controls->setContentsMargins(8, 8, 8, 4);
  controls->setSpacing(6);
  controls->addWidget(label, 0, 0);
  controls->addWidget(height_, 0, 1);
  controls->addWidget(match_, 1, 0, 1, 2);
  controls->addWidget(text_, 2, 0, 1, 2, Qt::AlignTop);
  controls->setColumnStretch(1, 1);
  controls->setRowStretch(2, 1);
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(0);
  row->addWidget(side);
  row->addWidget(new SlicePlot(context, this), 1);
  connect(height_, qOverload<double>(&QDoubleSpinBox::valueChanged), &study_, &StudyModel::setSliceHeight);
  connect(match_, &QPushButton::clicked, &study_, &StudyModel::matchSlices);
  connect(&study_, &StudyModel::slicesChanged, this, &SlicesTab::refresh);
  connect(&study_, &StudyModel::failed, &context.workspace.messages(), &Messages::error);
  connect(&stepper_, &StepperModel::choiceChanged, this, &SlicesTab::refresh);
  refresh();
}

void SlicesTab::refresh() {
  match_->setEnabled(stepper_.isReady());
  text_->setText(study_.sliceSentence());
}

}  // namespace tiltmap::ui
