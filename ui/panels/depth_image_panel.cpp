#include "ui/panels/depth_image_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QStackedLayout>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>

#include "core/base/text.h"
#include "core/products/depth_figure.h"
#include "core/products/png.h"
#include "core/scan/normals.h"
#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

const char* shortTitle(DepthQuantity quantity) {
  switch (quantity) {
    case DepthQuantity::Range:
      return "Range";
    case DepthQuantity::Median:
      return "3 × 3 median";
    case DepthQuantity::PlanarMedian:
      return "Planar median";
    case DepthQuantity::Changed:
      return "Changed cells";
    case DepthQuantity::Normal:
      return "Normals";
    case DepthQuantity::Incidence:
      return "Incidence";
    case DepthQuantity::Intensity:
      return "Intensity";
    case DepthQuantity::Code:
      return "Codes";
    case DepthQuantity::Residual:
      return "Residual";
  }
  return "";
}

QString number(double value, int places) {
  return qt(fixedReal(value, places));
}

QString vectorText(const Eigen::Vector3d& v, int places) {
  return QString("(%1, %2, %3)").arg(number(v.x(), places), number(v.y(), places), number(v.z(), places));
}

RgbImage sideBySide(const RgbImage& left, const RgbImage& right) {
  RgbImage both(left.width + right.width, std::max(left.height, right.height), left.at(0, 0));
  for (int y = 0; y < left.height; ++y)
    for (int x = 0; x < left.width; ++x) both.at(x, y) = left.at(x, y);
  for (int y = 0; y < right.height; ++y)
    for (int x = 0; x < right.width; ++x) both.at(left.width + x, y) = right.at(x, y);
  return both;
}

}  // namespace

DepthImagePanel::DepthImagePanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context) {
  for (int side = 0; side < 2; ++side) {
    views_[side] = new DepthView(context.theme, this);
    views_[side]->setObjectName(QString("depth-view-%1").arg(side));
    views_[side]->setAccessibleName(side == 0 ? "Depth image" : "Second depth image");
    connect(views_[side], &DepthView::hovered, this, [this](const std::optional<MatrixCell>& cell) {
      context_.workspace.selection().setHovered(
          cell && scan_ ? std::optional(CellPlace{*scan_, cell->row, cell->column}) : std::nullopt);
    });
    connect(views_[side], &DepthView::picked, this, [this](const MatrixCell& cell) {
      if (scan_) context_.workspace.selection().setPicked(CellPlace{*scan_, cell.row, cell.column});
    });
    connect(views_[side], &DepthView::windowChanged, this,
            [this, side](const DepthWindow& window) { views_[1 - side]->setWindow(window); });
  }
  empty_ = new EmptyState("Select a scan to see its range matrix.", context.actions.find("op.import"), this);
  readout_ = new QLabel(this);
  readout_->setObjectName("depth-readout");
  readout_->setAccessibleName("The beam under the pointer");
  readout_->setContentsMargins(8, 2, 8, 4);
  readout_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  readout_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  changed_ = new QLabel(this);
  changed_->setObjectName("depth-changed");
  changed_->setAccessibleName("What the filter changed");
  changed_->setContentsMargins(8, 2, 8, 0);
  buildBar();

  auto* matrix = new QWidget(this);
  auto* images = new QHBoxLayout;
  images->setContentsMargins(0, 0, 0, 0);
  images->setSpacing(1);
  for (DepthView* view : views_) images->addWidget(view, 1);
  auto* column = new QVBoxLayout(matrix);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  column->addLayout(images, 1);
  column->addWidget(changed_);
  column->addWidget(readout_);
  auto* pages = new QWidget(this);
  pages_ = new QStackedLayout(pages);
  pages_->addWidget(empty_);
  pages_->addWidget(matrix);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(bar_);
  layout->addWidget(pages, 1);
  setFocusProxy(views_[0]);

  Workspace& workspace = context.workspace;
  connect(&workspace.selection(), &Selection::scansChanged, this, &DepthImagePanel::refreshScan);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &DepthImagePanel::refreshScan);
  connect(&workspace.selection(), &Selection::hoveredChanged, this, &DepthImagePanel::refreshMarks);
  connect(&workspace.selection(), &Selection::pickedChanged, this, &DepthImagePanel::refreshMarks);
  connect(&workspace.residuals(), &Residuals::changed, this, &DepthImagePanel::refreshResiduals);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &DepthImagePanel::refreshResiduals);
  showTwo(two_->isChecked());
  refreshScan();
}

void DepthImagePanel::buildBar() {
  const Preferences& preferences = context_.workspace.preferences();
  bar_ = new QWidget(this);
  auto* layout = new QHBoxLayout(bar_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(8);
  for (int side = 0; side < 2; ++side) {
    auto* box = quantities_[side] = new QComboBox(bar_);
    box->setObjectName(QString("depth-quantity-%1").arg(side));
    box->setAccessibleName(side == 0 ? "What the depth image shows" : "What the second depth image shows");
    box->setToolTip(side == 0 ? "What the image shows" : "What the second image shows");
    for (const DepthQuantity quantity : kDepthQuantities)
      box->addItem(shortTitle(quantity), qt(depthQuantityName(quantity)));
    box->setCurrentIndex(std::max(0, box->findData(preferences.text(QString("depth/quantity-%1").arg(side),
                                                                    side ? "changed" : "range"))));
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this, side] {
      context_.workspace.preferences().setText(QString("depth/quantity-%1").arg(side),
                                               quantities_[side]->currentData().toString());
      refreshSide(side);
      refreshRange();
    });
  }
  const auto button = [&](const QString& name, const QString& text, const QString& tip, bool checkable) {
    auto* made = new QToolButton(bar_);
    made->setObjectName(name);
    made->setAccessibleName(text);
    made->setText(text);
    made->setToolTip(tip);
    made->setCheckable(checkable);
    made->setAutoRaise(true);
    return made;
  };
  two_ = button("depth-two", "Side by side", "Two images of the scan side by side", true);
  two_->setChecked(preferences.text("depth/two", "0") == "1");
  connect(two_, &QToolButton::toggled, this, &DepthImagePanel::showTwo);
  lock_ = button("depth-lock", "Lock range", "Keep the ends of the colour bar from scan to scan", true);
  connect(lock_, &QToolButton::toggled, this, &DepthImagePanel::lockRange);
  const auto spin = [&](const QString& name, const QString& accessible) {
    auto* made = new QDoubleSpinBox(bar_);
    made->setObjectName(name);
    made->setAccessibleName(accessible);
    made->setToolTip(accessible + "; changing it locks the range");
    made->setRange(-1e6, 1e6);
    made->setDecimals(2);
    made->setKeyboardTracking(false);
    made->setButtonSymbols(QAbstractSpinBox::NoButtons);
    made->setAlignment(Qt::AlignRight);
    made->setMaximumWidth(84);
    connect(made, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &DepthImagePanel::takeRange);
    return made;
  };
  low_ = spin("depth-low", "Lower end of the colour bar");
  high_ = spin("depth-high", "Upper end of the colour bar");
  auto* fit = button("depth-fit", "Fit", "Show all of the matrix (double click, F)", false);
  connect(fit, &QToolButton::clicked, this, [this] {
    for (DepthView* view : views_) view->setWindow({});
  });
  auto* save = button("depth-save", "Save picture", "Save as a PNG file, with axes and colour bar", false);
  save->setIcon(icon("document-save"));
  connect(save, &QToolButton::clicked, this, [this] {
    askForFiles(this, context_.workspace.preferences(),
                {FileQuestion::Save, "Save depth image", "Pictures (*.png)", "png", "pictures",
                 QString("scan-%1-depth.png").arg(index_)},
                [this](const QStringList& files) {
                  if (const Status status = writePicture(files.front()); !status)
                    context_.workspace.messages().error(status.error());
                  else
                    context_.workspace.messages().note("Wrote " + files.front());
                });
  });
  for (QWidget* widget :
       std::initializer_list<QWidget*>{quantities_[0], two_, quantities_[1], lock_, low_, high_, fit})
    layout->addWidget(widget);
  layout->addStretch();
  layout->addWidget(save);
}

bool DepthImagePanel::isTwofold() const {
  return two_->isChecked();
}

QString DepthImagePanel::readout() const {
  return readout_->text();
}

DepthQuantity DepthImagePanel::quantity(int side) const {
  return parseDepthQuantity(utf8(quantities_[side]->currentData().toString())).value_or(DepthQuantity::Range);
}

void DepthImagePanel::showTwo(bool two) {
  context_.workspace.preferences().setText("depth/two", two ? "1" : "0");
  quantities_[1]->setVisible(two);
  views_[1]->setVisible(two);
  if (two) refreshSide(1);
  refreshRange();
}

std::shared_ptr<const DepthImage> DepthImagePanel::imageOf(DepthQuantity shown, QString& trouble) const {
  if (!image_) return nullptr;
  ResidualsPtr residuals;
  if (shown == DepthQuantity::Residual) {
    Workspace& workspace = context_.workspace;
    const Stage stage = workspace.display().stage();
    residuals = workspace.residuals().of(*scan_, stage);
    if (!residuals) {
      const std::string why = workspace.residuals().trouble(*scan_, stage);
      trouble = why.empty() ? "Computing the residuals…" : qt(why);
      return nullptr;
    }
  }
  auto depth = depthImageOf(image_, geometry_, shown, residuals ? *residuals : std::vector<float>());
  if (depth) return std::make_shared<const DepthImage>(std::move(*depth));
  trouble = qt(depth.error().what) + ": " + qt(depth.error().remedy);
  return nullptr;
}

void DepthImagePanel::refreshSide(int side) {
  if (side == 1 && !isTwofold()) return;
  QString trouble;
  auto depth = imageOf(quantity(side), trouble);
  views_[side]->setImage(depth, trouble);
  QString text;
  for (const DepthView* view : views_)
    if (const DepthImage* image = view->image();
        image && image->quantity == DepthQuantity::Changed && (view == views_[0] || isTwofold()))
      text = QString("Changed by the 3 × 3 median: %1 cells, mean change %2 m")
                 .arg(qt(groupedInteger(static_cast<long long>(image->changed))),
                      number(image->mean_change_m, 2));
    else if (image && image->quantity == DepthQuantity::Residual && (view == views_[0] || isTwofold()))
      text = image->overlapping == 0
                 ? QString("Residual, %1: no cell overlaps another scan")
                       .arg(stageTitle(context_.workspace.display().stage()))
                 : QString("Residual, %1: median %2 mm over %3 cells that overlap other scans")
                       .arg(stageTitle(context_.workspace.display().stage()),
                            number(1e3 * image->median_residual_m, 1),
                            qt(groupedInteger(static_cast<long long>(image->overlapping))));
  changed_->setText(text);
  changed_->setVisible(!text.isEmpty());
}

void DepthImagePanel::refreshResiduals() {
  bool any = false;
  for (int side = 0; side < 2; ++side)
    if (image_ && quantity(side) == DepthQuantity::Residual && (side == 0 || isTwofold())) {
      refreshSide(side);
      any = true;
    }
  if (any) refreshRange();
}

void DepthImagePanel::refreshScan() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const auto current = context_.workspace.selection().currentScan();
  const ScanEntry* scan = snapshot && current ? snapshot->find(*current) : nullptr;
  if (!scan && snapshot && !snapshot->scans().empty()) scan = &snapshot->scans().front();
  bar_->setEnabled(scan);
  pages_->setCurrentIndex(scan ? 1 : 0);
  if (!scan) {
    scan_.reset();
    image_ = nullptr;
    for (DepthView* view : views_) view->setImage(nullptr);
    refreshMarks();
    return;
  }
  index_ = snapshot->indexOf(scan->id).value_or(0);
  const bool same =
      scan_ == scan->id && matrix_ == scan->matrix && geometry_id_ == scan->geometry_id && image_;
  scan_ = scan->id;
  matrix_ = scan->matrix;
  geometry_id_ = scan->geometry_id;
  geometry_ = scan->geometry;
  if (!same) {
    points_.clear();
    normals_.clear();
    const auto image = scan->image();
    image_ = image ? *image : nullptr;
    if (image) {
      points_ = cellPoints(*image_, geometry_);
      normals_ = matrixNormals(*image_, points_);
      for (int side = 0; side < 2; ++side) refreshSide(side);
    } else {
      for (DepthView* view : views_)
        view->setImage(nullptr, qt(image.error().what) + ": " + qt(image.error().remedy));
    }
    refreshRange();
  }
  refreshMarks();
}

void DepthImagePanel::refreshRange() {
  filling_ = true;
  const DepthImage* shown = views_[0]->image();
  const bool bar = shown && shown->hasColourBar();
  for (QWidget* widget : std::initializer_list<QWidget*>{lock_, low_, high_}) widget->setEnabled(bar);
  for (DepthView* view : views_) {
    const DepthImage* image = view->image();
    const bool held = locked_ && image && image->unit == locked_unit_;
    view->setRange(held ? locked_ : std::nullopt);
  }
  if (bar) {
    const auto [low, high] = views_[0]->range();
    const QString suffix = shown->unit.empty() ? QString() : " " + qt(shown->unit);
    for (QDoubleSpinBox* box : {low_, high_}) {
      box->setSuffix(suffix);
      box->setDecimals(shown->isSigned() ? 3 : 2);  // residuals are millimetres
    }
    low_->setValue(low);
    high_->setValue(high);
  }
  lock_->setChecked(locked_.has_value());
  filling_ = false;
}

void DepthImagePanel::lockRange(bool locked) {
  if (filling_) return;
  locked_.reset();
  if (const DepthImage* image = views_[0]->image(); locked && image) {
    locked_ = views_[0]->range();
    locked_unit_ = image->unit;
  }
  refreshRange();
}

void DepthImagePanel::takeRange() {
  const DepthImage* image = views_[0]->image();
  if (filling_ || !image) return;
  const double low = low_->value(), high = high_->value();
  if (high > low) {
    locked_ = std::pair(low, high);
    locked_unit_ = image->unit;
  }
  refreshRange();
}

void DepthImagePanel::refreshMarks() {
  const Selection& selection = context_.workspace.selection();
  const auto here = [&](const std::optional<CellPlace>& cell) {
    return cell && scan_ && cell->scan == *scan_ ? std::optional(MatrixCell{cell->row, cell->column})
                                                 : std::nullopt;
  };
  for (DepthView* view : views_) view->setMarks(here(selection.hovered()), here(selection.picked()));
  refreshReadout();
}

void DepthImagePanel::refreshReadout() {
  const Selection& selection = context_.workspace.selection();
  const auto cell = selection.hovered() ? selection.hovered() : selection.picked();
  if (!cell || !image_ || !scan_ || cell->scan != *scan_ || cell->row >= image_->rows() ||
      cell->column >= image_->columns()) {
    readout_->setText(image_ ? "Point at a cell to read it; click marks it in 3D." : QString());
    return;
  }
  const LengthUnit unit = context_.workspace.preferences().lengthUnit();
  QString text = QString("Row %1, column %2").arg(cell->row).arg(cell->column);
  if (image_->isRegular())
    text += QString("   tilt %1°, azimuth %2°")
                .arg(number(image_->lineTilt(cell->row) / kDegree, 2),
                     number(geometry_.azimuthOfColumn(cell->column) / kDegree, 2));
  const std::size_t k = image_->index(cell->row, cell->column);
  if (!image_->hasPoint(k)) {
    readout_->setText(text + "   " + qt(cellCodeText(image_->code(k))));
    return;
  }
  text += "   range " + lengthText(image_->range(k), unit);
  text += QString("   point (%1, %2, %3) %4")
              .arg(lengthNumber(points_[k].x(), unit), lengthNumber(points_[k].y(), unit),
                   lengthNumber(points_[k].z(), unit), unitName(unit));
  for (const DepthView* view : views_)
    if (const DepthImage* shown = view->image();
        shown && shown->quantity == DepthQuantity::Residual && std::isfinite(shown->value[k])) {
      text += "   residual " + smallLengthText(shown->value[k], unit);
      break;
    }
  text += normals_[k].isZero() ? "   no normal" : "   normal " + vectorText(normals_[k], 2);
  if (image_->hasIntensity()) text += "   intensity " + number(image_->intensity(k), 0);
  readout_->setText(text);
}

Status DepthImagePanel::writePicture(const QString& file) const {
  std::vector<RgbImage> pictures;
  for (int side = 0; side < (isTwofold() ? 2 : 1); ++side) {
    const DepthImage* image = views_[side]->image();
    if (!image) return fail("there is no depth image to save", "depth image", "choose a scan with a matrix");
    DepthFigureSettings settings;
    settings.background = context_.theme.isDark() ? TopViewBackground::Dark : TopViewBackground::White;
    settings.title = "Scan " + std::to_string(index_);
    settings.range = views_[side]->range();
    auto figure = drawDepthFigure(*image, settings);
    if (!figure) return fail(figure.error());
    pictures.push_back(std::move(figure->image));
  }
  return writePng(pathOf(file), pictures.size() == 2 ? sideBySide(pictures[0], pictures[1]) : pictures[0]);
}

}  // namespace tiltmap::ui
