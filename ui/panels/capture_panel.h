// Capturing in the field: instruments, tilt, the next stop, how the sweep goes, and a Stop that always works.
#pragma once

#include <QWidget>
#include <vector>

#include "ui/panels/panel.h"

class QLabel;
class QProgressBar;
class QPushButton;
class QTabWidget;

namespace tiltmap::ui {

class CaptureBanner;
class CaptureConnectPage;
class CaptureModel;
class CaptureStopPage;

class CapturePanel : public QWidget {
  Q_OBJECT

 public:
  explicit CapturePanel(const PanelContext& context, QWidget* parent = nullptr);

  CaptureModel& model() { return model_; }
  CaptureBanner& banner() { return *banner_; }
  CaptureConnectPage& connectPage() { return *connect_page_; }
  // The next stop, as it is set here.
  void start();

  // What a gloved finger hits, in pixels of an ordinary screen.
  static constexpr int kTarget_px = 44;
  // Lower than its parts ask for: behind another tab it must not ask for more than a small screen has.
  QSize minimumSizeHint() const override { return {340, 320}; }

 private:
  QWidget* makeFigures();
  QWidget* makeButtons();
  void refresh();
  void paintStop();

  PanelContext context_;
  CaptureModel& model_;
  CaptureBanner* banner_;
  QTabWidget* tabs_;
  CaptureConnectPage* connect_page_;
  CaptureStopPage* stop_page_;
  QProgressBar* progress_ = nullptr;
  QWidget* figures_box_ = nullptr;
  std::vector<QLabel*> figures_;
  QLabel* place_ = nullptr;
  QPushButton *start_ = nullptr, *resume_ = nullptr, *stop_ = nullptr;
};

}  // namespace tiltmap::ui
