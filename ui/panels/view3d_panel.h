// The scans in 3D.
#pragma once

#include <QElapsedTimer>
#include <QTimer>
#include <QWidget>
#include <memory>

#include "ui/panels/panel.h"
#include "ui/scene/point_reader.h"
#include "ui/scene/scene.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QStackedLayout;
class QToolButton;

namespace tiltmap::ui {

class CompareBar;
class MeasureBar;
class PictureBar;
class SceneWidget;
class SliceBar;

class View3dPanel : public QWidget {
  Q_OBJECT

 public:
  explicit View3dPanel(const PanelContext& context, QWidget* parent = nullptr);
  ~View3dPanel() override;

  Scene& scene() { return *scene_; }
  QWidget* view() const;
  // What the view shows now, drawn anew with all points.
  QImage picture();
  // The same at any size, as a PNG file.
  Status writePicture(const QString& file, const QSize& size, bool on_white);
  // Points that are not drawn yet are read in the background.
  bool isReading() const { return reader_.isReading(); }
  PointReader& reader() { return reader_; }
  CompareBar& compareBar() { return *compare_bar_; }

 private:
  void buildBar();
  void refreshScans();
  void refreshStages();
  void applySettings();
  void applyTheme();
  void refreshResiduals();
  void readMissing();
  void refreshComputing();
  void askForPicture();
  SceneColours usualColours() const;
  void takeClick(const QPointF& place);

  PanelContext context_;
  std::unique_ptr<Scene> scene_;
  PointReader reader_;
  QElapsedTimer reading_since_;
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
  QToolButton* shaded_;
  QToolButton* compare_;
  QToolButton* slice_;
  QToolButton* measure_;
  QToolButton* save_;
  QLabel* computing_;
  CompareBar* compare_bar_;
  SliceBar* slice_bar_;
  MeasureBar* measure_bar_;
  PictureBar* picture_bar_;
  QTimer residuals_soon_;
};

}  // namespace tiltmap::ui
