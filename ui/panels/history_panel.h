// Every edit of the project, and a way to any of them.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

namespace tiltmap::ui {

class HistoryModel;
class TableView;

class HistoryPanel : public QWidget {
  Q_OBJECT

 public:
  explicit HistoryPanel(const PanelContext& context, QWidget* parent = nullptr);
  TableView* view() const { return view_; }

 private:
  void goTo(const QModelIndex& index);

  PanelContext context_;
  HistoryModel* model_;
  TableView* view_;
};

}  // namespace tiltmap::ui
