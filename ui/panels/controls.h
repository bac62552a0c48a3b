// Small controls of a panel's bars, each with a name, an accessible name and a tooltip.
#pragma once

#include <QDoubleSpinBox>
#include <QLabel>
#include <QScrollArea>
#include <QToolButton>

#include "ui/look/icons.h"

namespace tiltmap::ui {

inline void describe(QWidget* widget, const QString& name, const QString& accessible, const QString& tip) {
  widget->setObjectName(name);
  widget->setAccessibleName(accessible);
  widget->setToolTip(tip);
}

inline QToolButton* toolButton(QWidget* parent, const QString& name, const QString& text,
                               const QString& tip) {
  auto* button = new QToolButton(parent);
  describe(button, name, text, tip);
  button->setText(text);
  button->setAutoRaise(true);
  return button;
}

inline QToolButton* toggleButton(QWidget* parent, const QString& name, const QString& text,
                                 const QString& tip, bool on) {
  QToolButton* button = toolButton(parent, name, text, tip);
  button->setCheckable(true);
  button->setChecked(on);
  return button;
}

// A picture with words for those who cannot see it.
inline QToolButton* iconButton(QWidget* parent, const QString& name, const QString& image,
                               const QString& text, const QString& tip) {
  auto* button = new QToolButton(parent);
  describe(button, name, text, tip);
  button->setIcon(icon(image));
  button->setIconSize(QSize(20, 20));
  button->setFocusPolicy(Qt::StrongFocus);
  return button;
}

// Sentences, which can be selected and copied.
inline QLabel* wrappedLabel(QWidget* parent, const QString& name) {
  auto* label = new QLabel(parent);
  label->setObjectName(name);
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  return label;
}

// As high as it needs, however little room there is.
inline QScrollArea* scrolled(QWidget* page, const QString& name, QWidget* parent) {
  auto* scroll = new QScrollArea(parent);
  scroll->setObjectName(name);
  scroll->setWidget(page);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setFocusPolicy(Qt::NoFocus);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  return scroll;
}

// A length in metres, told when the number has been finished.
inline QDoubleSpinBox* lengthBox(QWidget* parent, const QString& name, const QString& accessible,
                                 const QString& tip) {
  auto* box = new QDoubleSpinBox(parent);
  describe(box, name, accessible, tip);
  box->setRange(-100000.0, 100000.0);
  box->setDecimals(2);
  box->setSingleStep(0.1);
  box->setSuffix(" m");
  box->setKeyboardTracking(false);
  box->setAlignment(Qt::AlignRight);
  box->setFixedWidth(box->fontMetrics().horizontalAdvance("-10000.00 m") + 30);
  return box;
}

}  // namespace tiltmap::ui
