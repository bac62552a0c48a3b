#include "ui/panels/slice_bar.h"

#include <QHBoxLayout>
#include <QLabel>

#include "ui/look/flow_layout.h"
#include "ui/panels/controls.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

namespace {

constexpr double kLevelSlice_m = 0.2;

}  // namespace

SliceBar::SliceBar(Scene& scene, QWidget* parent) : QWidget(parent), scene_(scene) {
  auto* layout = new FlowLayout(this);
  layout->setContentsMargins(8, 2, 8, 4);
  layout->setSpacing(8);
  const char* names[] = {"x", "y", "z"};
  const char* words[] = {"to the right", "forwards", "upwards"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto* group = new QWidget(this);
    auto* row = new QHBoxLayout(group);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(4);
    low_[axis] =
        lengthBox(group, QString("slice-%1-low").arg(names[axis]),
                  QString("Lower end of the box along %1, metres").arg(names[axis]),
                  QString("Where the box begins along %1 (%2), metres").arg(names[axis], words[axis]));
    high_[axis] =
        lengthBox(group, QString("slice-%1-high").arg(names[axis]),
                  QString("Upper end of the box along %1, metres").arg(names[axis]),
                  QString("Where the box ends along %1 (%2), metres").arg(names[axis], words[axis]));
    row->addWidget(new QLabel(names[axis], group));
    row->addWidget(low_[axis]);
    row->addWidget(new QLabel("to", group));
    row->addWidget(high_[axis]);
    layout->addWidget(group);
    for (QDoubleSpinBox* box : {low_[axis], high_[axis]})
      connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &SliceBar::take);
  }
  auto* level = toolButton(this, "slice-level", "Level slice",
                           "A level slice, 0.2 m thick, at the height of the scanners: a floor plan");
  connect(level, &QToolButton::clicked, this, &SliceBar::makeLevelSlice);
  auto* whole = toolButton(this, "slice-whole", "Whole", "A box around everything that is visible");
  connect(whole, &QToolButton::clicked, this, &SliceBar::makeWhole);
  layout->addWidget(level);
  layout->addWidget(whole);
}

void SliceBar::setActive(bool active) {
  setVisible(active);
  if (!active)
    scene_.setSlice({});
  else if (!scene_.slice())
    makeWhole();
  Q_EMIT changed();
}

void SliceBar::refresh() {
  if (!scene_.slice()) return;
  filling_ = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis]->setValue(scene_.slice()->low[static_cast<int>(axis)]);
    high_[axis]->setValue(scene_.slice()->high[static_cast<int>(axis)]);
  }
  filling_ = false;
}

void SliceBar::take() {
  if (filling_ || !scene_.slice()) return;
  PointBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[static_cast<int>(axis)] = low_[axis]->value();
    box.high[static_cast<int>(axis)] = high_[axis]->value();
  }
  scene_.setSlice(box);
  refresh();
  Q_EMIT changed();
}

void SliceBar::makeWhole() {
  PointBox box = scene_.extent().value_or(PointBox{Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1)});
  // The extent leaves out what one beam in fifty hit far away; the box must not.
  const Eigen::Vector3d more = Eigen::Vector3d::Constant(0.5) + 0.15 * (box.high - box.low);
  box.low -= more;
  box.high += more;
  scene_.setSlice(box);
  refresh();
  Q_EMIT changed();
}

void SliceBar::makeLevelSlice() {
  if (!scene_.slice()) makeWhole();
  PointBox box = *scene_.slice();
  const double height = scene_.scannerHeight();
  box.low.z() = height - 0.5 * kLevelSlice_m;
  box.high.z() = height + 0.5 * kLevelSlice_m;
  scene_.setSlice(box);
  refresh();
  Q_EMIT changed();
}

}  // namespace tiltmap::ui
