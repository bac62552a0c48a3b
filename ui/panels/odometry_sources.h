// The step to a new stop from poses that the vehicle has written or sends.
#pragma once

#include <QTimer>
#include <memory>
#include <optional>

#include "core/io/pose_track.h"
#include "hardware/odometry/odometry_feed.h"
#include "ui/panels/odometry_page.h"

class QComboBox;
class QLabel;
class QLineEdit;
class QToolButton;

namespace tiltmap::ui {

class Preferences;
class Theme;

// Poses at two stamps of a TUM file; each stands for the nearest one that the file has, within
// kStampWithin_s.
class FileOdometryPage : public OdometryPage {
  Q_OBJECT

 public:
  explicit FileOdometryPage(Preferences& preferences, QWidget* parent = nullptr);
  Result<Pose> step() const override;
  // The last stamp becomes that of the new stop, and the new one that of the pose after it.
  void stopCaptured() override;
  void setFirstStop(bool first) override;

  void open(const QString& path);
  static constexpr double kStampWithin_s = 0.5;

 private:
  Result<double> stampOf(const QLineEdit* field, const char* which) const;
  std::optional<std::size_t> newStop() const;  // its pose in the file
  void read();
  void moveBy(int poses);
  void refresh();

  Preferences& preferences_;
  std::optional<Result<PoseTrack>> track_;
  bool first_ = false;
  QLineEdit *path_, *last_, *next_;
  QComboBox* axes_;
  QToolButton *again_, *earlier_, *later_;
  QLabel* last_label_;
  SentenceLabel* found_;
};

// The feed's pose at the last stop and the one that was taken at the new one.
class FeedOdometryPage : public OdometryPage {
  Q_OBJECT

 public:
  FeedOdometryPage(const Theme& theme, Preferences& preferences, QWidget* parent = nullptr);
  Result<Pose> step() const override;
  // The pose that was taken is that of the last stop; without one, the latest if the feed is receiving.
  void stopCaptured() override;
  void setFirstStop(bool first) override;

 private:
  struct Marked {
    StampedPose pose;
    int epoch = 0;
  };

  void connectOrNot(bool on);
  void poll();
  std::optional<Marked> now() const;  // nothing unless the feed is receiving
  void refresh();

  const Theme& theme_;
  Preferences& preferences_;
  std::unique_ptr<OdometryFeed> feed_;
  std::optional<FeedStatus> status_;
  std::optional<Marked> last_, taken_;
  // Epochs go on over connections to the same address.
  std::optional<TcpAddress> address_;
  int epochs_before_ = 0;
  std::optional<double> last_stamp_s_;
  bool first_ = false;
  QTimer timer_;
  QLineEdit* where_;
  QComboBox* axes_;
  QToolButton *connect_, *take_, *here_;
  SentenceLabel *state_, *pose_;
};

}  // namespace tiltmap::ui
