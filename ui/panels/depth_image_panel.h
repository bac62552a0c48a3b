// The range matrix of the current scan as a picture, one or two side by side.
#pragma once

#include <QWidget>
#include <memory>
#include <optional>

#include "ui/models/depth_model.h"
#include "ui/panels/depth_view.h"
#include "ui/panels/panel.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QStackedLayout;
class QToolButton;

namespace tiltmap::ui {

class DepthImagePanel : public QWidget {
  Q_OBJECT

 public:
  explicit DepthImagePanel(const PanelContext& context, QWidget* parent = nullptr);

  DepthView& view(int side) { return *views_[side]; }
  bool isTwofold() const;
  QString readout() const;
  bool isReading() const { return model_->isReading(); }
  // Both images as shown, with axes and colour bars.
  Status writePicture(const QString& file) const;

 private:
  void buildBar();
  void refreshImages();
  void refreshRange();
  void refreshMarks();
  void refreshReadout();
  void lockRange(bool locked);
  void takeRange();
  void showTwo(bool two);
  DepthQuantity quantity(int side) const;

  PanelContext context_;
  DepthModel* model_;
  std::optional<std::pair<double, double>> locked_;  // of quantities in locked_unit_
  std::string locked_unit_;
  bool filling_ = false;

  QWidget* bar_;
  QComboBox* quantities_[2];
  QToolButton* two_;
  QToolButton* lock_;
  QDoubleSpinBox* low_;
  QDoubleSpinBox* high_;
  DepthView* views_[2];
  QLabel* readout_;
  QLabel* changed_;
  QWidget* empty_;
  QStackedLayout* pages_;
};

}  // namespace tiltmap::ui
