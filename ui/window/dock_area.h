// The panels as docks, arranged by perspective.
#pragma once

#include <QWidget>
#include <map>

#include "ui/panels/panel.h"
#include "ui/window/perspectives.h"

namespace ads {
class CDockManager;
class CDockWidget;
}  // namespace ads

namespace tiltmap::ui {

// Each perspective remembers how its user arranged it. A panel is made when it is first shown.
class DockArea : public QWidget {
  Q_OBJECT

 public:
  explicit DockArea(const PanelContext& context, QWidget* parent = nullptr);
  ~DockArea() override;

  const PanelContext& context() const { return context_; }
  Perspective perspective() const { return perspective_; }
  void setPerspective(Perspective perspective);
  // The present one as it was delivered.
  void resetLayout();
  void saveLayout() const;

  bool isShown(const QString& panel) const;
  void showPanel(const QString& panel);  // raises it where it stands behind others
  void togglePanel(const QString& panel);
  // The panel's own widget; makes it where it has not been shown yet. Nothing for a name that is not there.
  QWidget* panel(const QString& id) const;

 Q_SIGNALS:
  void perspectiveChanged();
  void panelsChanged();

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void makeDocks(const PanelContext& context);
  void arrange(Perspective perspective);
  void restyle();
  QString layoutKey(Perspective perspective) const;

  PanelContext context_;
  ads::CDockManager* manager_;
  std::map<QString, ads::CDockWidget*> docks_;
  Perspective perspective_ = Perspective::Inspect;
  bool restored_ = false;  // a perspective has been set: its layout is the user's
};

}  // namespace tiltmap::ui
