// One way to tell the step to a new stop.
#pragma once

#include <QLabel>
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

// Words as long as they come: as high as they need at the width they get, which a wrapped label alone does
// not insist on.
class SentenceLabel : public QLabel {
 public:
  SentenceLabel(QWidget* parent, const QString& name, const QString& accessible);
  void say(const QString& text);

 protected:
  void resizeEvent(QResizeEvent* event) override;
  void changeEvent(QEvent* event) override;

 private:
  void fit();
};

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
