// The box that cuts a part out of the 3D view, in numbers; its sides can be dragged in the picture as well.
#pragma once

#include <QWidget>
#include <array>

class QDoubleSpinBox;

namespace tiltmap::ui {

class Scene;

class SliceBar : public QWidget {
  Q_OBJECT

 public:
  explicit SliceBar(Scene& scene, QWidget* parent = nullptr);

  // The first time: around everything.
  void setActive(bool active);
  // The box was dragged.
  void refresh();

 Q_SIGNALS:
  void changed();

 private:
  void take();
  void makeWhole();
  void makeLevelSlice();

  Scene& scene_;
  bool filling_ = false;
  std::array<QDoubleSpinBox*, 3> low_{}, high_{};
};

}  // namespace tiltmap::ui
