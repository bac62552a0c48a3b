// The range matrix of the current scan as a picture, one or two side by side.
#pragma once

#include <QWidget>
#include <memory>
#include <optional>

#include "core/project/project_snapshot.h"
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
  // Both images as shown, with axes and colour bars.
  Status writePicture(const QString& file) const;

 private:
  void buildBar();
  void refreshScan();  // another scan, or its matrix changed
  void refreshSide(int side);
  void refreshResiduals();
  void refreshRange();
  void refreshMarks();
  void refreshReadout();
  void lockRange(bool locked);
  void takeRange();
  void showTwo(bool two);
  DepthQuantity quantity(int side) const;
  std::shared_ptr<const DepthImage> imageOf(DepthQuantity quantity, QString& trouble) const;

  PanelContext context_;
  std::optional<ScanId> scan_;
  std::size_t index_ = 0;
  std::int64_t matrix_ = 0, geometry_id_ = 0;
  ScannerGeometry geometry_;
  RangeImagePtr image_;
  std::vector<Eigen::Vector3d> points_, normals_;
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
