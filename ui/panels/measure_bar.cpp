#include "ui/panels/measure_bar.h"

#include <QApplication>
#include <QClipboard>
#include <QHBoxLayout>
#include <QLabel>

#include "ui/panels/controls.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

MeasureBar::MeasureBar(Scene& scene, const Preferences& preferences, QWidget* parent)
    : QWidget(parent), scene_(scene), preferences_(preferences) {
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(8, 2, 8, 4);
  layout->setSpacing(8);
  reading_ = new QLabel(this);
  describe(reading_, "measure-reading", "Distance",
           "Length of the line, and how far its end lies from its start along each axis of the map");
  reading_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  reading_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  copy_ = toolButton(this, "measure-copy", "Copy", "Copy the numbers");
  connect(copy_, &QToolButton::clicked, this, [this] { QApplication::clipboard()->setText(reading()); });
  clear_ = toolButton(this, "measure-clear", "Clear", "Forget the measurement (Esc)");
  connect(clear_, &QToolButton::clicked, this, &MeasureBar::clear);
  layout->addWidget(reading_, 1);
  layout->addWidget(copy_);
  layout->addWidget(clear_);
  connect(&preferences, &Preferences::unitsChanged, this, &MeasureBar::refresh);
  refresh();
}

void MeasureBar::setActive(bool active) {
  active_ = active;
  setVisible(active);
  if (!active) clear();
}

void MeasureBar::take(const Eigen::Vector3d& place) {
  std::vector<Eigen::Vector3d> places = scene_.measured();
  if (places.size() >= 2) places.clear();
  places.push_back(place);
  scene_.setMeasured(places);
  refresh();
  Q_EMIT changed();
}

void MeasureBar::clear() {
  scene_.setMeasured({});
  refresh();
  Q_EMIT changed();
}

QString MeasureBar::reading() const {
  const auto& places = scene_.measured();
  if (places.size() < 2) return {};
  const LengthUnit unit = preferences_.lengthUnit();
  const Eigen::Vector3d by = places[1] - places[0];
  return QString("Distance %1   dx %2   dy %3   dz %4   level %5")
      .arg(lengthText(by.norm(), unit), lengthText(by.x(), unit), lengthText(by.y(), unit),
           lengthText(by.z(), unit), lengthText(by.head<2>().norm(), unit));
}

void MeasureBar::refresh() {
  const std::size_t places = scene_.measured().size();
  reading_->setText(places == 2   ? reading()
                    : places == 1 ? QString("Click the second point.")
                                  : QString("Click two points to measure between them; Esc clears."));
  copy_->setEnabled(places == 2);
  clear_->setEnabled(places > 0);
}

}  // namespace tiltmap::ui
