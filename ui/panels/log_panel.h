// What the program did, line by line; the same as in the log file.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

namespace tiltmap::ui {

class TableView;

class LogPanel : public QWidget {
  Q_OBJECT

 public:
  explicit LogPanel(const PanelContext& context, QWidget* parent = nullptr);
  TableView* view() const { return view_; }

 private:
  TableView* view_;
};

}  // namespace tiltmap::ui
