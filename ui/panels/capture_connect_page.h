// Where the instruments are, who they are, and how they are.
#pragma once

#include <QWidget>

#include "hardware/capture/capture_plan.h"
#include "ui/panels/panel.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;
class QStackedWidget;

namespace tiltmap::ui {

class CaptureModel;

class CaptureConnectPage : public QWidget {
  Q_OBJECT

 public:
  enum class Source { Find, Named, Emulator, Recording };

  CaptureConnectPage(CaptureModel& model, const PanelContext& context, QWidget* parent = nullptr);

  // By what is chosen and typed here.
  void connectNow();

 private:
  QWidget* buildFind();
  QWidget* buildNamed();
  QWidget* buildEmulator();
  QWidget* buildRecording();
  QWidget* buildFaults();
  QLineEdit* line(const QString& name, const QString& accessible, const QString& tip,
                  const QString& placeholder);
  Source source() const;
  void press();
  void order();
  void refresh();

  CaptureModel& model_;
  PanelContext context_;
  QComboBox* source_;
  QStackedWidget* pages_;
  QLineEdit *tilt_options_ = nullptr, *network_ = nullptr, *scanner_ = nullptr, *tilt_ = nullptr;
  QComboBox* drive_ = nullptr;
  QSpinBox* seed_ = nullptr;
  QDoubleSpinBox* speed_ = nullptr;
  QWidget* faults_ = nullptr;  // to be ordered, of emulated instruments that are there
  QComboBox* fault_ = nullptr;
  QPushButton* order_ = nullptr;
  QLineEdit *scanner_file_ = nullptr, *tilt_file_ = nullptr;
  QPushButton* connect_;
  QLabel* instruments_;
};

}  // namespace tiltmap::ui
