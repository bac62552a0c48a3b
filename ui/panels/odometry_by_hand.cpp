#include "ui/panels/odometry_by_hand.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>

#include "core/base/text.h"
#include "hardware/capture/capture_operation.h"
#include "ui/models/preferences.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kKindKey = "capture/odometry-typed-as";

QLineEdit* numberField(QWidget* parent, const QString& name, const QString& accessible, const QString& tip) {
  QLineEdit* field = gloveField(parent, name, accessible, tip);
  field->setAlignment(Qt::AlignRight);
  field->setInputMethodHints(Qt::ImhFormattedNumbersOnly);
  return field;
}

}  // namespace

TypedOdometryPage::TypedOdometryPage(Preferences& preferences, QWidget* parent)
    : OdometryPage(parent), preferences_(preferences) {
  auto* layout = new QGridLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);
  layout->setColumnStretch(1, 1);
  kind_ = new QComboBox(this);
  describe(
      kind_, "odometry-typed-as", "What is typed",
      "A distance driven straight ahead and how far the vehicle turned then; or where the new stop lies to "
      "the right and forward, and how far it turned");
  kind_->addItems({"Distance and turn", "Right, forward and turn"});
  kind_->setMinimumHeight(kGloveField_px);
  kind_->setCurrentIndex(preferences.text(kKindKey, "0") == "1" ? 1 : 0);
  layout->addWidget(kind_, 0, 0, 1, 3);
  right_ =
      numberField(this, "odometry-right", "To the right, metres",
                  "How far the new stop lies to the right of the last one, in metres; negative to the left");
  forward_ = numberField(this, "odometry-forward", "Forward, metres",
                         "How far the vehicle has driven forward, in metres; negative backwards");
  turn_ = numberField(this, "odometry-turn", "Turn to the left, degrees",
                      "How far the vehicle has turned, in degrees; left is positive, right negative");
  right_label_ = new QLabel("Right", this);
  forward_label_ = new QLabel(this);
  auto* turn_label = new QLabel("Turn, left +", this);
  int row = 1;
  for (const auto& [label, field, unit] :
       {std::tuple(right_label_, right_, "m"), std::tuple(forward_label_, forward_, "m"),
        std::tuple(turn_label, turn_, "°")}) {
    label->setBuddy(field);
    layout->addWidget(label, row, 0);
    layout->addWidget(field, row, 1);
    auto* shown = new QLabel(unit, this);
    layout->addWidget(shown, row++, 2);
    if (field == right_) right_unit_ = shown;
    connect(field, &QLineEdit::textChanged, this, &OdometryPage::changed);
  }
  connect(kind_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this](int index) {
    preferences_.setText(kKindKey, QString::number(index));
    showKind();
    Q_EMIT changed();
  });
  showKind();
}

bool TypedOdometryPage::byDistance() const {
  return kind_->currentIndex() == 0;
}

void TypedOdometryPage::showKind() {
  right_->setVisible(!byDistance());
  right_label_->setVisible(!byDistance());
  right_unit_->setVisible(!byDistance());
  forward_label_->setText(byDistance() ? "Distance" : "Forward");
}

Result<Pose> TypedOdometryPage::step() const {
  const auto text = [](const QLineEdit* field) { return std::string(trimmed(utf8(field->text()))); };
  std::vector<std::pair<const char*, std::string>> fields;
  if (!byDistance()) fields.emplace_back("how far to the right", text(right_));
  fields.emplace_back(byDistance() ? "the distance" : "how far forward", text(forward_));
  fields.emplace_back("the turn", text(turn_));
  for (const auto& [what, number] : fields) {
    if (number.empty()) return fail(what + std::string(" is missing"), "", "type a number, 0 for none");
    if (!parseReal(number))
      return fail(what + std::string(" is no number: ") + printable(number), "",
                  "type it with a point, as 5.2");
  }
  const std::string right = byDistance() ? "0" : text(right_);
  return parseStep(right + "," + text(forward_) + "," + text(turn_));
}

void TypedOdometryPage::stopCaptured() {
  for (QLineEdit* field : {right_, forward_, turn_}) field->clear();
}

NudgedOdometryPage::NudgedOdometryPage(QWidget* parent) : OdometryPage(parent) {
  auto* layout = new QGridLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);
  const auto add = [&](int row, int column, int span, const QString& name, const QString& text,
                       const QString& words, const Pose& by) {
    QToolButton* button = gloveButton(this, "nudge-" + name, text, words + "; each press adds to the step");
    button->setAccessibleName(words);
    layout->addWidget(button, row, column, 1, span);
    connect(button, &QToolButton::clicked, this, [this, by] { nudge(by); });
  };
  int row = 0;
  for (const auto& [id, word, sign] :
       {std::tuple("forward", "Forward", 1.0), std::tuple("back", "Back", -1.0)}) {
    layout->addWidget(new QLabel(word, this), row, 0);
    int column = 1;
    for (const double metres : {0.1, 1.0}) {
      const QString size = qt(shortestReal(metres)) + " m";
      add(row, column, 3, QString("%1-%2").arg(id, qt(shortestReal(metres))), size,
          QString("%1 by %2").arg(word, size), Pose::planar(0.0, sign * metres, 0.0));
      column += 3;
    }
    ++row;
  }
  for (const auto& [id, word, sign] :
       {std::tuple("left", "Turn left", 1.0), std::tuple("right", "Turn right", -1.0)}) {
    layout->addWidget(new QLabel(word, this), row, 0);
    int column = 1;
    for (const int degrees : {1, 10, 45}) {
      const QString size = QString::number(degrees) + "°";
      add(row, column, 2, QString("%1-%2").arg(id).arg(degrees), size, QString("%1 by %2").arg(word, size),
          Pose::planar(0.0, 0.0, sign * degrees * kDegree));
      column += 2;
    }
    ++row;
  }
  for (int column = 1; column <= 6; ++column) layout->setColumnStretch(column, 1);
  reset_ = gloveButton(this, "nudge-reset", "Begin again",
                       "Forget the nudges: the new stop is where the last one is");
  layout->addWidget(reset_, row, 1, 1, 6);
  connect(reset_, &QToolButton::clicked, this, [this] {
    stopCaptured();
    Q_EMIT changed();
  });
  reset_->setEnabled(false);
}

Result<Pose> NudgedOdometryPage::step() const {
  if (!pressed_)
    return fail("the vehicle has not been moved yet", "",
                "press the buttons until the sketch shows where it stands");
  return step_;
}

void NudgedOdometryPage::nudge(const Pose& by) {
  step_ = step_ * by;
  pressed_ = true;
  reset_->setEnabled(true);
  Q_EMIT changed();
}

void NudgedOdometryPage::stopCaptured() {
  step_ = Pose();
  pressed_ = false;
  reset_->setEnabled(false);
}

}  // namespace tiltmap::ui
