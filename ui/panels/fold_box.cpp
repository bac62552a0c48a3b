#include "ui/panels/fold_box.h"

#include <QToolButton>
#include <QVBoxLayout>

namespace tiltmap::ui {

FoldBox::FoldBox(const QString& title, const QString& name, QWidget* parent, bool open)
    : QWidget(parent), button_(new QToolButton(this)), body_(new QWidget(this)) {
  button_->setObjectName(name);
  button_->setText(title);
  button_->setAccessibleName(title);
  button_->setToolTip("Show or hide: " + title.toLower());
  button_->setCheckable(true);
  button_->setAutoRaise(true);
  button_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  button_->setFocusPolicy(Qt::StrongFocus);
  content_ = new QVBoxLayout(body_);
  content_->setContentsMargins(8, 0, 0, 0);
  content_->setSpacing(8);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  column->addWidget(button_);
  column->addWidget(body_);
  connect(button_, &QToolButton::toggled, this, [this](bool on) {
    button_->setArrowType(on ? Qt::DownArrow : Qt::RightArrow);
    body_->setVisible(on);
    Q_EMIT toggled(on);
  });
  button_->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
  body_->setVisible(open);
  button_->setChecked(open);
}

bool FoldBox::isOpen() const {
  return button_->isChecked();
}

void FoldBox::setOpen(bool open) {
  button_->setChecked(open);
}

}  // namespace tiltmap::ui
