#include "ui/panels/capture_tilt_page.h"

#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>

#include "ui/models/capture_model.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

CaptureTiltPage::CaptureTiltPage(CaptureModel& model, QWidget* parent)
    : QWidget(parent),
      model_(model),
      angle_(new QLabel(this)),
      target_(new QDoubleSpinBox(this)),
      live_(nullptr) {
  angle_->setObjectName("capture-tilt-angle");
  angle_->setToolTip("Where the tilt stands, as it was read back: 0 level, positive up");
  QFont large = font();
  large.setPointSizeF(1.6 * font().pointSizeF());
  large.setBold(true);
  angle_->setFont(large);
  angle_->setAlignment(Qt::AlignCenter);
  describe(target_, "capture-tilt-target", "Angle to go to", "Angle to go to, degrees; 0 level, positive up");
  target_->setRange(-180.0, 180.0);
  target_->setDecimals(1);
  target_->setSuffix("°");
  target_->setAlignment(Qt::AlignRight);

  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(4, 8, 4, 8);  // four buttons in large letters, beside a scroll bar
  grid->setVerticalSpacing(8);
  grid->setHorizontalSpacing(4);
  grid->addWidget(angle_, 0, 0, 1, 4);
  int column = 0;
  for (const double step : {-5.0, -0.8, 0.8, 5.0}) {
    const QString words = QString("%1 by %2°").arg(step > 0.0 ? "Up" : "Down").arg(std::abs(step));
    QPushButton* jog = button(QString("capture-jog-%1-%2")
                                  .arg(step > 0.0 ? "up" : "down")
                                  .arg(std::abs(step) > 1.0 ? "far" : "near"),
                              QString(step > 0.0 ? "▲ " : "▼ ") + QString::number(std::abs(step)) + "°",
                              words, words + ", from where the tilt stands");
    connect(jog, &QPushButton::clicked, &model_, [this, step] { model_.jogBy(step * kDegree); });
    grid->addWidget(jog, 1, column++);
  }
  QPushButton* go = button("capture-tilt-go", "Go there", "Go to the angle", "Move the tilt to this angle");
  connect(go, &QPushButton::clicked, &model_, [this] { model_.jogTo(target_->value() * kDegree); });
  QPushButton* home =
      button("capture-home", "Search home", "Search home",
             "Let the tilt search its home switch anew. The search itself cannot be stopped by "
             "every controller: keep clear");
  connect(home, &QPushButton::clicked, &model_, &CaptureModel::home);
  QPushButton* park = button("capture-park", "Park", "Park the tilt",
                             "Bring the tilt to level, where it stays while the vehicle drives");
  connect(park, &QPushButton::clicked, &model_, &CaptureModel::park);
  live_ = button("capture-live", "Live line", "Live line",
                 "Show lines as the scanner measures them while no sweep runs");
  moving_.removeOne(live_);
  live_->setCheckable(true);
  live_->setChecked(true);
  connect(live_, &QPushButton::toggled, &model_, &CaptureModel::setLive);
  grid->addWidget(target_, 2, 0, 1, 2);
  grid->addWidget(go, 2, 2, 1, 2);
  grid->addWidget(home, 3, 0, 1, 2);
  grid->addWidget(park, 3, 2, 1, 2);
  grid->addWidget(live_, 4, 0, 1, 4);
  grid->setRowStretch(5, 1);
  connect(&model_, &CaptureModel::changed, this, &CaptureTiltPage::refresh);
  refresh();
}

QPushButton* CaptureTiltPage::button(const QString& name, const QString& text, const QString& accessible,
                                     const QString& tip) {
  auto* made = new QPushButton(text, this);
  describe(made, name, accessible, tip);
  moving_ << made;
  return made;
}

void CaptureTiltPage::refresh() {
  const bool still = model_.state() == StationState::Ready || model_.state() == StationState::Verdict;
  for (QPushButton* button : moving_)
    button->setEnabled(still && !model_.now().replays && !model_.isSweeping());
  target_->setEnabled(model_.isConnected() && !model_.now().replays);
  const QString angle = model_.tiltText();
  angle_->setText(!angle.isEmpty()                                ? angle
                  : model_.state() == StationState::Moving        ? QString("moving")
                  : model_.isConnected() && !model_.now().replays ? QString("not known yet")
                                                                  : QString("–"));
  const QSignalBlocker quiet(live_);
  live_->setChecked(model_.now().live);
}

}  // namespace tiltmap::ui
