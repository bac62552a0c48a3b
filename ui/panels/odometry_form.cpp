#include "ui/panels/odometry_form.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QVBoxLayout>

#include "core/base/text.h"
#include "ui/models/preferences.h"
#include "ui/models/step_words.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"
#include "ui/panels/odometry_by_hand.h"
#include "ui/panels/odometry_sources.h"
#include "ui/panels/step_sketch.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kModeKey = "capture/odometry-mode";

struct ModeWords {
  const char *name, *text, *tip;
};
constexpr ModeWords kModes[] = {
    {"odometry-typed", "Type", "Type how far the vehicle has driven and turned"},
    {"odometry-nudged", "Nudge", "Press buttons until the sketch shows where the vehicle stands"},
    {"odometry-file", "File", "Take the step out of a TUM file: stamp x y z qx qy qz qw"},
    {"odometry-feed", "Feed", "Take the step from the vehicle's own odometry over the network"},
};

QString sentenceOf(const Error& error) {
  QString text = qt(error.what);
  if (!text.isEmpty()) text[0] = text[0].toUpper();
  return error.remedy.empty() ? text + "." : text + ": " + qt(error.remedy) + ".";
}

}  // namespace

OdometryForm::OdometryForm(const Theme& theme, Preferences& preferences, QWidget* parent)
    : QWidget(parent), preferences_(preferences) {
  describe(this, "odometry-form", "Odometry of the new stop",
           "Where the new stop is, seen from the last one, as the vehicle knows it");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);

  auto* bar = new QHBoxLayout;
  bar->setSpacing(4);
  for (std::size_t k = 0; k < buttons_.size(); ++k) {
    QToolButton* button = gloveButton(this, kModes[k].name, kModes[k].text, kModes[k].tip);
    button->setCheckable(true);
    bar->addWidget(button, 1);
    // No group of buttons: Tab would pass by all but the one that is on.
    connect(button, &QToolButton::clicked, this, [this, k] { setMode(static_cast<Mode>(k)); });
    buttons_[k] = button;
  }
  layout->addLayout(bar);

  pages_ = {new TypedOdometryPage(preferences, this), new NudgedOdometryPage(this),
            new FileOdometryPage(preferences, this), new FeedOdometryPage(theme, preferences, this)};
  for (OdometryPage* each : pages_) {
    each->hide();
    layout->addWidget(each);
    connect(each, &OdometryPage::changed, this, [this, each] {
      if (each == &page()) refresh();
    });
  }
  sentence_ = new SentenceLabel(this, "odometry-sentence", "The step in words");
  layout->addWidget(sentence_);
  sketch_ = new StepSketch(theme, this);
  layout->addWidget(sketch_, 1);

  const int remembered = preferences.text(kModeKey, "0").toInt();
  const bool known = remembered > 0 && remembered < static_cast<int>(pages_.size());
  mode_ = known ? static_cast<Mode>(remembered) : Mode::Typed;
  page().show();
  refresh();
}

void OdometryForm::setMode(Mode mode) {
  if (mode != mode_) {
    page().hide();
    mode_ = mode;
    page().show();
    preferences_.setText(kModeKey, QString::number(static_cast<int>(mode)));
  }
  refresh();
}

std::optional<Pose> OdometryForm::lastFromNext() const {
  if (first_) return {};
  const auto step = page().step();
  return step ? std::optional(*step) : std::nullopt;
}

QString OdometryForm::stepText() const {
  const auto step = lastFromNext();
  if (!step) return {};
  const auto number = [](double value) { return qt(shortestReal(value)); };
  return QStringList{number(step->translation().x()), number(step->translation().y()),
                     number(headingChange(*step) / kDegree)}
      .join(",");
}

QString OdometryForm::missing() const {
  if (first_) return {};
  const auto step = page().step();
  return step ? QString() : sentenceOf(step.error());
}

QString OdometryForm::sentence() const {
  if (first_) return "This is the first stop: the map begins here, and it needs no odometry.";
  const auto step = lastFromNext();
  return step ? stepInWords(*step) : missing();
}

void OdometryForm::setFirstStop(bool first) {
  if (first == first_) return;
  first_ = first;
  for (OdometryPage* each : pages_) each->setFirstStop(first);
  refresh();
}

void OdometryForm::stopCaptured() {
  for (OdometryPage* each : pages_) each->stopCaptured();
  refresh();
}

void OdometryForm::refresh() {
  for (std::size_t k = 0; k < buttons_.size(); ++k)
    buttons_[k]->setChecked(k == static_cast<std::size_t>(mode_));
  sentence_->say(sentence());
  sketch_->setStep(lastFromNext(), first_);
  Q_EMIT changed();
}

}  // namespace tiltmap::ui
