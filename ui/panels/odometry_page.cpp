#include "ui/panels/odometry_page.h"

#include <QLineEdit>

#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

class GloveButton : public QToolButton {
 public:
  using QToolButton::QToolButton;
  QSize sizeHint() const override {
    return QToolButton::sizeHint().expandedTo({kGloveControl_px, kGloveControl_px});
  }
  QSize minimumSizeHint() const override { return sizeHint(); }
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

}  // namespace tiltmap::ui
