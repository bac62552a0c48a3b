// The last stop and the new one from above, forward of the last one up.
#pragma once

#include <QWidget>
#include <optional>

#include "core/geometry/pose.h"

class QPainter;

namespace tiltmap::ui {

class Theme;

class StepSketch : public QWidget {
  Q_OBJECT

 public:
  explicit StepSketch(const Theme& theme, QWidget* parent = nullptr);

  // last_from_next; nothing: the last stop alone. A first stop has no last one.
  void setStep(const std::optional<Pose>& step, bool first);
  // Where a place in the frame of the last stop is drawn, widget coordinates.
  QPointF placeOf(const Eigen::Vector2d& place_m) const;
  double grid() const { return grid_m_; }  // metres from line to line
  QSize sizeHint() const override { return {240, 150}; }
  QSize minimumSizeHint() const override { return {120, 110}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void fit();
  void paintGrid(QPainter& painter) const;
  void paintStop(QPainter& painter, const Eigen::Vector2d& place_m, double heading_rad, bool is_new,
                 const QString& name) const;

  const Theme& theme_;
  std::optional<Pose> step_;
  bool first_ = false;
  Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
  double grid_m_ = 1.0, pixels_a_metre_ = 1.0;
};

}  // namespace tiltmap::ui
