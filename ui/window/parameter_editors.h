// The right widget for a parameter: by its kind, and for texts by what they name.
#pragma once

#include <QWidget>
#include <functional>

#include "ui/models/parameter_model.h"

namespace tiltmap::ui {

// An editor shows text() and tells what its user makes of it; ParameterModel decides whether that is a value.
class ParameterEditor : public QWidget {
  Q_OBJECT

 public:
  using QWidget::QWidget;
  virtual void show(const QString& text) = 0;
  virtual void setWrong(bool wrong) = 0;

 Q_SIGNALS:
  void edited(const QString& text);
};

ParameterEditor* makeParameterEditor(const Operation& operation, const ParameterInfo& info,
                                     Preferences& preferences, QWidget* parent);

}  // namespace tiltmap::ui
