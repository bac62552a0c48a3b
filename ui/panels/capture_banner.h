// The state of a capture at arm's length: a sign, one or two words, and a sentence below.
#pragma once

#include <QFrame>

class QLabel;

namespace tiltmap::ui {

class CaptureModel;
class Theme;

class CaptureBanner : public QFrame {
  Q_OBJECT

 public:
  CaptureBanner(CaptureModel& model, const Theme& theme, QWidget* parent = nullptr);

  QString title() const;
  QString sentence() const;

 private:
  enum class Kind { Quiet, Good, Working, Warning, Error };
  Kind kind() const;
  QString sign() const;
  void refresh();

  CaptureModel& model_;
  const Theme& theme_;
  QLabel *sign_, *title_, *sentence_;
};

}  // namespace tiltmap::ui
