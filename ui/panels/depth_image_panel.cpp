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
    : QWidget(parent), context_(context), model_(new DepthModel(context.workspace, this)) {
  for (int side = 0; side < 2; ++side) {
    views_[side] = new DepthView(context.theme, this);
    views_[side]->setObjectName(QString("depth-view-%1").arg(side));
    views_[side]->setAccessibleName(side == 0 ? "Depth image" : "Second depth image");
    connect(views_[side], &DepthView::hovered, this, [this](const std::optional<MatrixCell>& cell) {
      context_.workspace.selection().setHovered(
          cell && model_->scan() ? std::optional(CellPlace{*model_->scan(), cell->row, cell->column})
                                 : std::nullopt);
    });
    connect(views_[side], &DepthView::picked, this, [this](const MatrixCell& cell) {
      if (model_->scan())
        context_.workspace.selection().setPicked(CellPlace{*model_->scan(), cell.row, cell.column});
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
  connect(&workspace.selection(), &Selection::hoveredChanged, this, &DepthImagePanel::refreshMarks);
  connect(&workspace.selection(), &Selection::pickedChanged, this, &DepthImagePanel::refreshMarks);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &DepthImagePanel::refreshReadout);
  connect(model_, &DepthModel::wantedChanged, this, &DepthImagePanel::refreshImages);
  connect(model_, &DepthModel::imagesChanged, this, &DepthImagePanel::refreshImages);
  connect(model_, &DepthModel::scanChanged, this, &DepthImagePanel::refreshMarks);
  model_->setQuantity(0, quantity(0));
  showTwo(two_->isChecked());
  refreshImages();
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
      if (side == 0 || isTwofold()) model_->setQuantity(static_cast<std::size_t>(side), quantity(side));
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
                 QString("scan-%1-depth.png").arg(model_->index())},
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
  model_->setQuantity(1, two ? std::optional(quantity(1)) : std::nullopt);
  refreshRange();
}

void DepthImagePanel::refreshImages() {
  bar_->setEnabled(model_->hasScan());
  pages_->setCurrentIndex(model_->hasScan() ? 1 : 0);
  for (std::size_t side = 0; side < 2; ++side)
    views_[side]->setImage(model_->image(side), model_->trouble(side));
  const QString text = model_->summary();
  changed_->setText(text);
  changed_->setVisible(!text.isEmpty());
  refreshRange();
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
    return cell && model_->hasCell(*cell) ? std::optional(MatrixCell{cell->row, cell->column}) : std::nullopt;
  };
  for (DepthView* view : views_) view->setMarks(here(selection.hovered()), here(selection.picked()));
  refreshReadout();
}

void DepthImagePanel::refreshReadout() {
  const Selection& selection = context_.workspace.selection();
  const auto cell = selection.hovered() ? selection.hovered() : selection.picked();
  const bool here = cell && model_->hasCell(*cell);
  readout_->setText(here             ? model_->readout(*cell)
                    : model_->scan() ? QString("Point at a cell to read it; click marks it in 3D.")
                                     : QString());
}

Status DepthImagePanel::writePicture(const QString& file) const {
  std::vector<RgbImage> pictures;
  for (int side = 0; side < (isTwofold() ? 2 : 1); ++side) {
    const DepthImage* image = views_[side]->image();
    if (!image) return fail("there is no depth image to save", "depth image", "choose a scan with a matrix");
    DepthFigureSettings settings;
    settings.background = context_.theme.isDark() ? TopViewBackground::Dark : TopViewBackground::White;
    settings.title = "Scan " + std::to_string(model_->index());
    settings.range = views_[side]->range();
    auto figure = drawDepthFigure(*image, settings);
    if (!figure) return fail(figure.error());
    pictures.push_back(std::move(figure->image));
  }
  return writePng(pathOf(file), pictures.size() == 2 ? sideBySide(pictures[0], pictures[1]) : pictures[0]);
}

}  // namespace tiltmap::ui
