// What the scanner sees: the line it takes now, and the matrix that fills line by line.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

namespace tiltmap::ui {

class PolarView;
class SweepMatrixView;

class CaptureLinePanel : public QWidget {
  Q_OBJECT

 public:
  explicit CaptureLinePanel(const PanelContext& context, QWidget* parent = nullptr);
  PolarView& view() { return *view_; }

 private:
  PolarView* view_;
};

class CaptureMatrixPanel : public QWidget {
  Q_OBJECT

 public:
  explicit CaptureMatrixPanel(const PanelContext& context, QWidget* parent = nullptr);
  SweepMatrixView& view() { return *view_; }

 private:
  SweepMatrixView* view_;
};

}  // namespace tiltmap::ui
