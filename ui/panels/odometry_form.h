// Where the next stop is, as the vehicle knows it: typed, nudged, out of a file or from a feed.
#pragma once

#include <QWidget>
#include <array>
#include <optional>

#include "core/geometry/pose.h"

class QToolButton;

namespace tiltmap::ui {

class OdometryPage;
class Preferences;
class SentenceLabel;
class StepSketch;
class Theme;

// Remembers its kind, the file and the feed's address in the preferences; connects to nothing by itself.
class OdometryForm : public QWidget {
  Q_OBJECT

 public:
  enum class Mode { Typed, Nudged, File, Feed };

  OdometryForm(const Theme& theme, Preferences& preferences, QWidget* parent = nullptr);

  // The step as it is told now; nothing while something is missing() and for a first stop, which needs none.
  // Of files and feeds with height and tilt.
  std::optional<Pose> lastFromNext() const;
  // The same on level ground, as the capture's parameter and parseStep() have it: "0.1,5.2,-3". Empty
  // without a step.
  QString stepText() const;
  // "2.00 m forward, turned 15° to the left", or what is missing.
  QString sentence() const;
  QString missing() const;  // empty where nothing is

  // The project's first stop: a sentence says that it needs no odometry, and nothing can be entered but the
  // file and the feed, whose poses at this stop the next one needs.
  void setFirstStop(bool first);
  bool isFirstStop() const { return first_; }
  // The stop told here is in the project now: what was new is the last stop, and the next step is not known
  // yet. To be called for first stops, too.
  void stopCaptured();

  Mode mode() const { return mode_; }
  void setMode(Mode mode);

 Q_SIGNALS:
  void changed();  // what lastFromNext(), sentence() and missing() tell

 private:
  OdometryPage& page() const { return *pages_[static_cast<std::size_t>(mode_)]; }
  void refresh();

  Preferences& preferences_;
  std::array<OdometryPage*, 4> pages_{};
  std::array<QToolButton*, 4> buttons_{};
  StepSketch* sketch_ = nullptr;
  SentenceLabel* sentence_ = nullptr;
  Mode mode_ = Mode::Typed;
  bool first_ = false;
};

}  // namespace tiltmap::ui
