// The project tree: scans, links and results, in step with what the other panels select.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QTreeView;

namespace tiltmap::ui {

class EmptyState;
class ProjectTreeModel;

class ProjectTreePanel : public QWidget {
  Q_OBJECT

 public:
  explicit ProjectTreePanel(const PanelContext& context, QWidget* parent = nullptr);

  QTreeView* view() const { return view_; }
  ProjectTreeModel& model() const { return *model_; }
  // The current scan's name becomes editable.
  void beginRename();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void expandGroups();
  void showEmpty();
  void takeSelection();  // tree to the shared selection
  void showSelection();  // the other way
  void showMenu(const QPoint& at);
  void activate(const QModelIndex& index);

  PanelContext context_;
  ProjectTreeModel* model_;
  QTreeView* view_;
  EmptyState* empty_;
  bool following_ = false;
};

}  // namespace tiltmap::ui
