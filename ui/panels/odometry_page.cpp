#include "ui/panels/odometry_page.h"

#include <QEvent>
#include <QLineEdit>
#include <QPainter>

#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

class GloveButton : public QToolButton {
 public:
  using QToolButton::QToolButton;
  QSize sizeHint() const override {
    return QToolButton::sizeHint().expandedTo({kGloveControl_px, kGloveControl_px});
  }
  // In large letters four of them stand side by side in a narrow panel.
  QSize minimumSizeHint() const override {
    const int words = fontMetrics().horizontalAdvance(text()) + 12;
    return {std::max(kGloveControl_px, std::min(words, sizeHint().width())), sizeHint().height()};
  }

 protected:
  // Which one is on is seen on any ground.
  void paintEvent(QPaintEvent* event) override {
    QToolButton::paintEvent(event);
    if (!isChecked()) return;
    QPainter painter(this);
    painter.fillRect(rect().adjusted(2, height() - 5, -2, -1), palette().color(QPalette::Link));
  }
};

}  // namespace

QToolButton* gloveButton(QWidget* parent, const QString& name, const QString& text, const QString& tip) {
  auto* button = new GloveButton(parent);
  describe(button, name, text, tip);
  button->setText(text);
  button->setFocusPolicy(Qt::StrongFocus);
  button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  return button;
}

QLineEdit* gloveField(QWidget* parent, const QString& name, const QString& accessible, const QString& tip) {
  auto* line = new QLineEdit(parent);
  describe(line, name, accessible, tip);
  line->setMinimumHeight(kGloveField_px);
  return line;
}

SentenceLabel::SentenceLabel(QWidget* parent, const QString& name, const QString& accessible)
    : QLabel(parent) {
  setObjectName(name);
  setAccessibleName(accessible);
  setWordWrap(true);
  setTextInteractionFlags(Qt::TextSelectableByMouse);
}

void SentenceLabel::say(const QString& words) {
  if (words == text()) return;
  setText(words);
  fit();
}

void SentenceLabel::resizeEvent(QResizeEvent* event) {
  QLabel::resizeEvent(event);
  fit();
}

void SentenceLabel::changeEvent(QEvent* event) {
  QLabel::changeEvent(event);
  if (event->type() == QEvent::FontChange) fit();
}

void SentenceLabel::fit() {
  if (width() < kGloveControl_px) return;  // not laid out yet
  setMinimumHeight(0);                     // which heightForWidth() would not go below
  if (!text().isEmpty()) setMinimumHeight(heightForWidth(width()));
}

}  // namespace tiltmap::ui
