// The plots of the stepper, each a widget of its own.
#pragma once

#include <array>

#include "core/registration/rejection.h"
#include "ui/panels/panel.h"
#include "ui/panels/plot.h"

namespace tiltmap::ui {

class StepperModel;

// A plot that follows the theme and the stepper.
class StepperPlot : public Plot {
  Q_OBJECT

 public:
  StepperPlot(const PanelContext& context, const QString& name, const QString& accessible, QWidget* parent);

 protected:
  void follow();  // from the end of the constructor
  virtual void refresh() = 0;
  void goToClicked();
  // Whole numbers along the iterations, and the mark at the one shown.
  void setIterations();

  StepperModel& model_;
  const Theme& theme_;

 private:
  void restyle();
};

// RMS residual and loss scale by iteration, logarithmic.
class ConvergencePlot : public StepperPlot {
  Q_OBJECT

 public:
  explicit ConvergencePlot(const PanelContext& context, QWidget* parent = nullptr);

 protected:
  void refresh() override;

 private:
  int rms_, scale_;
};

// Pairs by reason and iteration.
class PairsPlot : public StepperPlot {
  Q_OBJECT

 public:
  explicit PairsPlot(const PanelContext& context, QWidget* parent = nullptr);

 protected:
  void refresh() override;

 private:
  std::array<int, kRejectReasons> curves_{};
};

// Residuals of the kept pairs at the iteration shown: all, and by their weight.
class ResidualPlot : public StepperPlot {
  Q_OBJECT

 public:
  explicit ResidualPlot(const PanelContext& context, QWidget* parent = nullptr);

 protected:
  void refresh() override;

 private:
  int weighted_, all_;
};

// The score of every heading that was tried.
class HeadingPlot : public StepperPlot {
  Q_OBJECT

 public:
  explicit HeadingPlot(const PanelContext& context, QWidget* parent = nullptr);

 protected:
  void refresh() override;

 private:
  int score_;
};

}  // namespace tiltmap::ui
