// One way to tell the step to a new stop.
#pragma once

#include <QWidget>

#include "core/base/result.h"
#include "core/geometry/pose.h"

class QLineEdit;
class QToolButton;

namespace tiltmap::ui {

// What a gloved finger hits, and a field that it can be set into.
inline constexpr int kGloveControl_px = 44;
inline constexpr int kGloveField_px = 36;

// At least kGloveControl_px wide and high, and never narrower than its text.
QToolButton* gloveButton(QWidget* parent, const QString& name, const QString& text, const QString& tip);
QLineEdit* gloveField(QWidget* parent, const QString& name, const QString& accessible, const QString& tip);

class OdometryPage : public QWidget {
  Q_OBJECT

 public:
  using QWidget::QWidget;

  // last_from_next, or what is missing and what to do.
  virtual Result<Pose> step() const = 0;
  // The new stop is the last one from now on.
  virtual void stopCaptured() = 0;
  virtual void setFirstStop(bool first) = 0;

 Q_SIGNALS:
  void changed();
};

}  // namespace tiltmap::ui
