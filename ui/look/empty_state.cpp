#include "ui/look/empty_state.h"

#include <QAction>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>

namespace tiltmap::ui {

EmptyState::EmptyState(const QString& text, QAction* action, QWidget* parent) : QWidget(parent) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(8);
  label_ = new QLabel(text, this);
  label_->setWordWrap(true);
  label_->setAlignment(Qt::AlignCenter);
  label_->setForegroundRole(QPalette::PlaceholderText);
  layout->addStretch();
  layout->addWidget(label_);
  if (action) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(action);
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setFocusPolicy(Qt::StrongFocus);
    layout->addWidget(button, 0, Qt::AlignHCenter);
  }
  layout->addStretch();
}

void EmptyState::setText(const QString& text) {
  label_->setText(text);
}

}  // namespace tiltmap::ui
