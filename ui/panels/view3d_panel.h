// The scans in 3D.
#pragma once

#include <QTimer>
#include <QWidget>
#include <memory>

#include "ui/panels/panel.h"
#include "ui/scene/scene.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QStackedLayout;
class QToolButton;

namespace tiltmap::ui {

class SceneWidget;

class View3dPanel : public QWidget {
  Q_OBJECT

 public:
  explicit View3dPanel(const PanelContext& context, QWidget* parent = nullptr);
  ~View3dPanel() override;

  Scene& scene() { return *scene_; }
  QWidget* view() const;
  // What the view shows now, drawn anew.
  QImage picture();

 private:
  void buildBar();
  void refreshScans();
  void refreshStages();
  void applySettings();
  void applyTheme();
  void savePicture();
  void tellTroubles(const std::vector<std::string>& troubles);

  PanelContext context_;
  std::unique_ptr<Scene> scene_;
  SceneWidget* view_;
  QWidget* empty_;
  QStackedLayout* pages_;
  QWidget* bar_;
  QComboBox* colouring_;
  QComboBox* stage_;
  QComboBox* points_;
  QDoubleSpinBox* size_;
  QToolButton* orthographic_;
  QToolButton* path_;
  QToolButton* grid_;
};

}  // namespace tiltmap::ui
