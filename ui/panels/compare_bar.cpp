#include "ui/panels/compare_bar.h"

#include <QComboBox>
#include <QLabel>

#include "ui/look/flow_layout.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

CompareBar::CompareBar(Scene& scene, QWidget* parent) : QWidget(parent), scene_(scene) {
  auto* layout = new FlowLayout(this);
  layout->setContentsMargins(8, 2, 8, 4);
  layout->setSpacing(8);
  before_ = new QComboBox(this);
  describe(before_, "compare-before", "Stage to compare with",
           "The stage that the one shown is compared with");
  how_ = new QComboBox(this);
  describe(how_, "compare-how", "How to compare",
           "Wipe: a divider that can be dragged, the other stage on its left. Blink: one after the other");
  how_->addItem("Wipe", "wipe");
  how_->addItem("Blink", "blink");
  period_ = new QDoubleSpinBox(this);
  describe(period_, "compare-period", "Time that each stage is shown, in seconds",
           "How long each stage is shown, 0.2 to 5 s");
  period_->setRange(0.2, 5.0);
  period_->setSingleStep(0.1);
  period_->setDecimals(1);
  period_->setSuffix(" s");
  period_->setValue(0.7);
  hint_ = new QLabel(this);
  hint_->setObjectName("compare-hint");
  auto* label = new QLabel("Compare with", this);
  label->setBuddy(before_);
  for (QWidget* widget : std::initializer_list<QWidget*>{label, before_, how_, period_, hint_})
    layout->addWidget(widget);
  for (QComboBox* box : {before_, how_})
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &CompareBar::apply);
  connect(period_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &CompareBar::apply);
  connect(&blink_, &QTimer::timeout, this, [this] {
    if (!isVisible()) return;
    scene_.setShowsBefore(!scene_.showsBefore());
    Q_EMIT changed();
  });
}

void CompareBar::setStages(const SnapshotPtr& snapshot, Stage shown) {
  const QVariant chosen = before_->currentData();
  {
    const QSignalBlocker quiet(before_);
    before_->clear();
    if (snapshot)
      for (const Stage stage : snapshot->stages())
        if (stage != shown) before_->addItem(stageTitle(stage), qt(stageName(stage)));
    // What one chose; at first where registration began.
    const int again = before_->findData(chosen);
    const int odometry = before_->findData(qt(stageName(Stage::Odometry)));
    before_->setCurrentIndex(again >= 0 ? again : std::max(0, odometry));
  }
  apply();
}

void CompareBar::setActive(bool active) {
  active_ = active;
  setVisible(active);
  apply();
}

void CompareBar::choose(Stage before, bool blink) {
  const QSignalBlocker quiet_stage(before_), quiet_how(how_);
  if (const int row = before_->findData(qt(stageName(before))); row >= 0) before_->setCurrentIndex(row);
  how_->setCurrentIndex(how_->findData(blink ? "blink" : "wipe"));
  apply();
}

void CompareBar::apply() {
  const bool possible = before_->count() > 0;
  const bool blinks = how_->currentData() == "blink";
  for (QWidget* widget : std::initializer_list<QWidget*>{before_, how_}) widget->setEnabled(possible);
  period_->setVisible(blinks && possible);
  hint_->setText(!possible ? "There are poses of one stage only: register the scans to compare."
                 : blinks  ? QString()
                           : QString("Drag the divider; the other stage is left of it."));
  hint_->setVisible(!hint_->text().isEmpty());
  const SceneCompare was = scene_.compare();
  const Stage before_was = scene_.before();
  const SceneCompare how = !active_ || !possible ? SceneCompare::Off
                           : blinks              ? SceneCompare::Blink
                                                 : SceneCompare::Wipe;
  const auto stage = parseStage(utf8(before_->currentData().toString()));
  scene_.setCompare(how, stage ? *stage : before_was);
  const int period_ms = static_cast<int>(1000.0 * period_->value());
  if (how != SceneCompare::Blink)
    blink_.stop();
  else if (!blink_.isActive() || blink_.interval() != period_ms)
    blink_.start(period_ms);
  if (was != scene_.compare() || before_was != scene_.before()) Q_EMIT sidesChanged();
  Q_EMIT changed();
}

}  // namespace tiltmap::ui
