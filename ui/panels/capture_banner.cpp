#include "ui/panels/capture_banner.h"

#include <QGridLayout>
#include <QLabel>

#include "ui/look/theme.h"
#include "ui/models/capture_model.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

CaptureBanner::CaptureBanner(CaptureModel& model, const Theme& theme, QWidget* parent)
    : QFrame(parent),
      model_(model),
      theme_(theme),
      sign_(new QLabel(this)),
      title_(new QLabel(this)),
      sentence_(wrappedLabel(this, "capture-sentence")) {
  setObjectName("capture-banner");
  setAttribute(Qt::WA_StyledBackground);
  sign_->setObjectName("capture-sign");
  title_->setObjectName("capture-title");
  title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  title_->setWordWrap(true);
  sign_->setAlignment(Qt::AlignCenter);
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(8, 8, 8, 8);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(4);
  grid->setColumnStretch(1, 1);
  grid->addWidget(sign_, 0, 0);
  grid->addWidget(title_, 0, 1);
  grid->addWidget(sentence_, 1, 0, 1, 2);
  connect(&model, &CaptureModel::changed, this, &CaptureBanner::refresh);
  connect(&theme, &Theme::changed, this, &CaptureBanner::refresh);
  refresh();
}

QString CaptureBanner::title() const {
  return title_->text();
}
QString CaptureBanner::sentence() const {
  return sentence_->text();
}

CaptureBanner::Kind CaptureBanner::kind() const {
  switch (model_.state()) {
    case StationState::Idle:
      return Kind::Quiet;
    case StationState::Ready:
      return model_.now().error || !model_.trouble().isEmpty() ? Kind::Warning : Kind::Good;
    case StationState::Reconnecting:
      return Kind::Warning;
    case StationState::Fault:
      return Kind::Error;
    case StationState::Verdict:
      if (!model_.verdict().judgement()) return Kind::Working;
      return model_.verdict().judgement()->light == CaptureLight::MoveOn ? Kind::Good : Kind::Error;
    default:
      return Kind::Working;
  }
}

// Never colour alone.
QString CaptureBanner::sign() const {
  switch (model_.state()) {
    case StationState::Idle:
      return "–";
    case StationState::Connecting:
      return "…";
    case StationState::Ready:
      return model_.now().error || !model_.trouble().isEmpty() ? "!" : "✓";
    case StationState::Moving:
      return "↕";
    case StationState::Scanning:
      return "»";
    case StationState::Reconnecting:
      return "?";
    case StationState::Fault:
      return "!";
    case StationState::Verdict:
      break;
  }
  const auto& judgement = model_.verdict().judgement();
  if (!judgement) return "…";
  switch (judgement->light) {
    case CaptureLight::MoveOn:
      return "✓";
    case CaptureLight::Rescan:
      return "↻";
    case CaptureLight::Closer:
      return "→←";
  }
  return {};
}

void CaptureBanner::refresh() {
  const ThemeColours& colours = theme_.colours();
  const QPalette look = Theme::palette(theme_.look());
  QColor back = colours.note_ground, mark = colours.accent;
  switch (kind()) {
    case Kind::Quiet:
      back = look.color(QPalette::AlternateBase);
      mark = colours.muted;
      break;
    case Kind::Good:
      mark = colours.good;
      break;
    case Kind::Working:
      break;
    case Kind::Warning:
      back = colours.warning_ground;
      mark = colours.warning;
      break;
    case Kind::Error:
      back = colours.error_ground;
      mark = colours.error;
      break;
  }
  // A style sheet and no palette: see setTextColour().
  const QString sheet = QString(
                            "#capture-banner { background: %1; border: none; }"
                            "#capture-sentence { color: %2; }"
                            "#capture-sign, #capture-title { color: %3; }")
                            .arg(back.name(), look.color(QPalette::WindowText).name(), mark.name());
  if (styleSheet() != sheet) setStyleSheet(sheet);
  QFont large = font();
  large.setPointSizeF(1.6 * font().pointSizeF());
  large.setBold(true);
  for (QLabel* label : {sign_, title_})
    if (label->font() != large) label->setFont(large);
  sign_->setMinimumWidth(sign_->fontMetrics().horizontalAdvance("→←"));
  sign_->setText(sign());
  title_->setText(model_.title());
  sentence_->setText(model_.sentence());
  setAccessibleName(model_.title() + ". " + model_.sentence());
}

}  // namespace tiltmap::ui
