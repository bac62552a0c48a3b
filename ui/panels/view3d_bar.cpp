// The bars of the 3D view's panel.
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenu>
#include <QToolButton>

#include "ui/look/flow_layout.h"
#include "ui/look/icons.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/compare_bar.h"
#include "ui/panels/controls.h"
#include "ui/panels/measure_bar.h"
#include "ui/panels/picture_bar.h"
#include "ui/panels/scene_widget.h"
#include "ui/panels/slice_bar.h"
#include "ui/panels/view3d_panel.h"

namespace tiltmap::ui {

void View3dPanel::buildBar() {
  Preferences& preferences = context_.workspace.preferences();
  bar_ = new QWidget(this);
  auto* layout = new FlowLayout(bar_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(4);

  colouring_ = new QComboBox(bar_);
  describe(colouring_, "view3d-colouring", "Colours of the points", "What the colours of the points show");
  const std::pair<SceneColouring, const char*> colourings[] = {
      {SceneColouring::Scan, "By scan"},        {SceneColouring::Height, "By height"},
      {SceneColouring::Range, "By range"},      {SceneColouring::Intensity, "By intensity"},
      {SceneColouring::Normal, "By normal"},    {SceneColouring::Age, "By age"},
      {SceneColouring::Residual, "By residual"}};
  for (const auto& [colouring, text] : colourings)
    colouring_->addItem(text, qt(sceneColouringName(colouring)));
  colouring_->setCurrentIndex(
      std::max(0, colouring_->findData(preferences.text("view3d/colouring", "scan"))));

  stage_ = new QComboBox(bar_);
  describe(stage_, "view3d-stage", "Stage of the poses", "Whose poses place the scans");

  points_ = new QComboBox(bar_);
  describe(points_, "view3d-points", "Raw or reduced points",
           "All points, or those that are left when neighbours on a line nearer than 0.25 m become one");
  points_->addItem("All points", "all");
  points_->addItem("Reduced", "reduced");
  points_->setCurrentIndex(preferences.text("view3d/points") == "reduced" ? 1 : 0);

  size_ = new QDoubleSpinBox(bar_);
  describe(size_, "view3d-point-size", "Point size in pixels", "Size of a point, 1 to 12 px");
  size_->setRange(1.0, 12.0);
  size_->setSingleStep(0.5);
  size_->setDecimals(1);
  size_->setSuffix(" px");
  size_->setValue(preferences.text("view3d/point-size", "2").toDouble());

  auto* views = new QToolButton(bar_);
  describe(views, "view3d-views", "Views", "Look from above, from the front, from the side or at an angle");
  views->setText("View");
  views->setPopupMode(QToolButton::InstantPopup);
  views->setAutoRaise(true);
  auto* menu = new QMenu(views);
  const std::tuple<SceneView, const char*, const char*> list[] = {
      {SceneView::Top, "Top", "8"},         {SceneView::Bottom, "Bottom", "2"},
      {SceneView::Front, "Front", "5"},     {SceneView::Back, "Back", "0"},
      {SceneView::Left, "Left", "4"},       {SceneView::Right, "Right", "6"},
      {SceneView::Iso, "At an angle", "7"}, {SceneView::IsoBack, "At an angle, from behind", "9"}};
  for (const auto& [view, text, key] : list) {
    QAction* action = menu->addAction(QString("%1\t%2").arg(text, key));
    action->setObjectName(QString("view3d-view-%1").arg(key));
    connect(action, &QAction::triggered, this, [this, chosen = view] {
      scene_->setView(chosen);
      view_->drawSoon();
    });
  }
  menu->addSeparator();
  QAction* frame = menu->addAction("Frame the selection\tF");
  connect(frame, &QAction::triggered, this, [this] { Q_EMIT view_->frameAsked(); });
  views->setMenu(menu);

  orthographic_ =
      toggleButton(bar_, "view3d-orthographic", "Ortho", "Without perspective, with a scale bar (O)", false);
  path_ = toggleButton(bar_, "view3d-path", "Path", "The path, with an arrow along the heading of each stop",
                       preferences.text("view3d/path", "1") == "1");
  grid_ = toggleButton(bar_, "view3d-grid", "Grid", "A grid on the ground; its size stands in the corner",
                       preferences.text("view3d/grid", "1") == "1");
  shaded_ = toggleButton(bar_, "view3d-shaded", "Shading",
                         "Edges and hollows stand out by their depth (eye-dome lighting)",
                         preferences.text("view3d/shaded", "0") == "1");
  compare_ =
      toggleButton(bar_, "view3d-compare", "Compare", "Two stages of the poses, before and after", false);
  slice_ = toggleButton(bar_, "view3d-slice", "Slice", "Only the points within a box", false);
  measure_ = toggleButton(bar_, "view3d-measure", "Measure", "Distance between two points (M)", false);
  save_ = toggleButton(bar_, "view3d-save", "Save picture", "Save what is shown as a PNG file of any size",
                       false);
  save_->setIcon(icon("document-save"));
  save_->setToolButtonStyle(Qt::ToolButtonIconOnly);
  // Over the view: in the bar it would push the view down whenever it comes.
  computing_ = new QLabel(view_);
  computing_->setObjectName("view3d-computing");
  computing_->setAccessibleName("What is being read or computed");
  computing_->setAttribute(Qt::WA_TransparentForMouseEvents);
  computing_->setAutoFillBackground(true);
  computing_->setContentsMargins(8, 4, 8, 4);
  computing_->hide();

  compare_bar_ = new CompareBar(*scene_, this);
  slice_bar_ = new SliceBar(*scene_, this);
  measure_bar_ = new MeasureBar(*scene_, preferences, this);
  picture_bar_ = new PictureBar(this);
  compare_bar_->setObjectName("view3d-compare-bar");
  slice_bar_->setObjectName("view3d-slice-bar");
  measure_bar_->setObjectName("view3d-measure-bar");
  picture_bar_->setObjectName("view3d-picture-bar");

  for (QWidget* widget :
       std::initializer_list<QWidget*>{colouring_, stage_, points_, size_, views, orthographic_, path_, grid_,
                                       shaded_, compare_, slice_, measure_, save_})
    layout->addWidget(widget);
  connect(compare_, &QToolButton::toggled, compare_bar_, &CompareBar::setActive);
  connect(slice_, &QToolButton::toggled, slice_bar_, &SliceBar::setActive);
  connect(measure_, &QToolButton::toggled, measure_bar_, &MeasureBar::setActive);
  connect(save_, &QToolButton::toggled, this, [this](bool on) {
    picture_bar_->setWanted(view_->size() * view_->devicePixelRatioF());
    picture_bar_->setVisible(on);
  });
  connect(picture_bar_, &PictureBar::viewSizeAsked, this,
          [this] { picture_bar_->setWanted(view_->size() * view_->devicePixelRatioF()); });
  connect(picture_bar_, &PictureBar::saveAsked, this, &View3dPanel::askForPicture);
  connect(compare_bar_, &CompareBar::sidesChanged, this, &View3dPanel::refreshResiduals);
  connect(compare_bar_, &CompareBar::changed, view_, &SceneWidget::drawSoon);
  connect(slice_bar_, &SliceBar::changed, view_, &SceneWidget::drawSoon);
  connect(measure_bar_, &MeasureBar::changed, view_, &SceneWidget::drawSoon);
  for (QComboBox* box : {colouring_, points_})
    connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &View3dPanel::applySettings);
  connect(size_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &View3dPanel::applySettings);
  for (QToolButton* button : {path_, grid_, shaded_})
    connect(button, &QToolButton::toggled, this, &View3dPanel::applySettings);
  connect(orthographic_, &QToolButton::toggled, this, [this](bool on) {
    if (scene_->isOrthographic() != on) scene_->setOrthographic(on);
    view_->drawSoon();
  });
  connect(stage_, QOverload<int>::of(&QComboBox::activated), this, [this] {
    const QString name = stage_->currentData().toString();
    const auto stage = parseStage(utf8(name));
    context_.workspace.display().setStage(stage ? std::optional(*stage) : std::nullopt);
  });
}

}  // namespace tiltmap::ui
