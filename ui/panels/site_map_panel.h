// The site in plan, with its picture and what belongs to that.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QAction;
class QLabel;
class QStackedWidget;
class QToolButton;

namespace tiltmap::ui {

class SiteMapModel;
class SiteMapView;

class SiteMapPanel : public QWidget {
  Q_OBJECT

 public:
  explicit SiteMapPanel(const PanelContext& context, QWidget* parent = nullptr);

  SiteMapModel& model() const { return *model_; }
  SiteMapView& view() const { return *view_; }
  void addPicture(const QString& file);

 private:
  QToolButton* makePictureButton();
  void refresh();
  void askPicture();

  PanelContext context_;
  SiteMapModel* model_;
  SiteMapView* view_;
  QStackedWidget* pages_;
  QWidget* empty_;
  QLabel* stage_;
  QLabel* banner_;
  QAction* add_ = nullptr;
  QAction* place_ = nullptr;
  QAction* remove_ = nullptr;
  QAction* shown_ = nullptr;
};

}  // namespace tiltmap::ui
