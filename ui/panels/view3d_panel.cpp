#include "ui/panels/view3d_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QStackedLayout>
#include <QToolButton>
#include <QVBoxLayout>

#include "core/products/png.h"
#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/look/theme.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/compare_bar.h"
#include "ui/panels/controls.h"
#include "ui/panels/measure_bar.h"
#include "ui/panels/picture_bar.h"
#include "ui/panels/relaxation_overlay.h"
#include "ui/panels/scene_widget.h"
#include "ui/panels/slice_bar.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

Rgb rgbOf(const QColor& colour) {
  return {static_cast<std::uint8_t>(colour.red()), static_cast<std::uint8_t>(colour.green()),
          static_cast<std::uint8_t>(colour.blue())};
}

// What takes but a moment is not worth a word.
constexpr int kMoment_ms = 300;

}  // namespace

View3dPanel::View3dPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), scene_(std::make_unique<Scene>()) {
  scene_->setReadsItself(false);
  view_ = new SceneWidget(*scene_, this);
  describe(view_, "view3d-view", "3D view of the scans",
           "Drag turns, right or Shift-drag shifts, wheel zooms, click picks a point.\n"
           "Keys: 8 top, 2 bottom, 5 front, 0 back, 4 left, 6 right, 7 and 9 at an angle, O orthographic, "
           "F frames the selection, M measures, Esc forgets what was measured");
  empty_ = new EmptyState("No scans yet. Import some, or simulate a survey.",
                          context.actions.find("op.import"), this);
  empty_->setObjectName("view3d-empty");
  buildBar();
  auto* pages = new QWidget(this);
  pages_ = new QStackedLayout(pages);
  pages_->addWidget(empty_);
  pages_->addWidget(view_);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(bar_);
  for (QWidget* tool :
       std::initializer_list<QWidget*>{compare_bar_, slice_bar_, measure_bar_, picture_bar_}) {
    tool->hide();
    layout->addWidget(tool);
  }
  layout->addWidget(pages, 1);
  setFocusProxy(view_);

  Workspace& workspace = context.workspace;
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &View3dPanel::refreshScans);
  connect(&workspace.session(), &ProjectSession::opened, this, [this] { scene_->setView(SceneView::Iso); });
  connect(&workspace.session(), &ProjectSession::closed, &reader_, &PointReader::forget);
  connect(&reader_, &PointReader::arrived, this, [this] {
    scene_->give(reader_.take());
    view_->drawSoon();
  });
  connect(&reader_, &PointReader::failed, this, [this](const PointReader::Trouble& trouble) {
    context_.workspace.messages().error(
        {trouble.scan + " cannot be drawn: " + trouble.error.what, "3D view", trouble.error.remedy});
  });
  connect(&reader_, &PointReader::progressed, this, &View3dPanel::refreshComputing);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &View3dPanel::refreshScans);
  connect(&workspace.display(), &ScanDisplay::placedChanged, this, &View3dPanel::refreshScans);
  connect(&workspace.display(), &ScanDisplay::visibilityChanged, this, [this] {
    scene_->setVisible([this](ScanId scan) { return context_.workspace.display().isVisible(scan); });
    view_->drawSoon();
  });
  connect(&workspace.selection(), &Selection::hoveredChanged, this, [this] {
    scene_->markHovered(context_.workspace.selection().hovered());
    view_->drawSoon();
  });
  connect(&workspace.selection(), &Selection::pickedChanged, this, [this] {
    scene_->markPicked(context_.workspace.selection().picked());
    view_->drawSoon();
  });
  connect(&context.theme, &Theme::changed, this, &View3dPanel::applyTheme);

  connect(&workspace.residuals(), &Residuals::changed, &residuals_soon_, [this] {
    if (!residuals_soon_.isActive()) residuals_soon_.start();
  });
  residuals_soon_.setSingleShot(true);
  residuals_soon_.setInterval(150);  // many scans: not after each of them
  connect(&residuals_soon_, &QTimer::timeout, this, &View3dPanel::refreshResiduals);

  connect(view_, &SceneWidget::clicked, this, &View3dPanel::takeClick);
  connect(view_, &SceneWidget::sliceDragged, slice_bar_, &SliceBar::refresh);
  connect(view_, &SceneWidget::measureAsked, measure_, &QToolButton::toggle);
  connect(view_, &SceneWidget::escaped, this, [this] {
    // First what was measured goes, then the tool.
    if (scene_->measured().empty())
      measure_->setChecked(false);
    else
      measure_bar_->clear();
  });
  connect(view_, &SceneWidget::hovered, this, [this](const QPointF& place) {
    // Looking through more points than this would hold up the pointer.
    if (scene_->pointsDrawn() > 2000000) return;
    context_.workspace.selection().setHovered(
        scene_->pick(view_->pixelAt(place), 6.0 * view_->devicePixelRatioF()));
  });
  connect(view_, &SceneWidget::left, this, [this] { context_.workspace.selection().setHovered({}); });
  connect(view_, &SceneWidget::frameAsked, this, [this] {
    scene_->frame(context_.workspace.selection().scans());
    view_->drawSoon();
  });
  connect(view_, &SceneWidget::orthographicChanged, this,
          [this] { orthographic_->setChecked(scene_->isOrthographic()); });
  scene_->setVisible([this](ScanId scan) { return context_.workspace.display().isVisible(scan); });
  applyTheme();
  applySettings();
  refreshScans();
  new RelaxationOverlay(context, *scene_, *view_, *compare_, *compare_bar_, this);
}

View3dPanel::~View3dPanel() {
  // The widget lets go of the scene before the scene goes.
  delete view_;
}

QWidget* View3dPanel::view() const {
  return view_;
}

QImage View3dPanel::picture() {
  return view_->wholePicture();
}

void View3dPanel::takeClick(const QPointF& place) {
  const auto cell = scene_->pick(view_->pixelAt(place), 8.0 * view_->devicePixelRatioF());
  if (measure_bar_->isActive()) {
    const auto point = cell ? scene_->shownPoint(*cell, view_->pixelAt(place)) : std::nullopt;
    if (point) measure_bar_->take(*point);
    return;
  }
  if (cell) context_.workspace.selection().setCurrentScan(cell->scan);
  context_.workspace.selection().setPicked(cell);
}

void View3dPanel::applySettings() {
  SceneSettings settings;
  settings.colouring =
      parseSceneColouring(utf8(colouring_->currentData().toString())).value_or(SceneColouring::Scan);
  settings.reduced = points_->currentData() == "reduced";
  settings.point_px = size_->value();
  settings.path = path_->isChecked();
  settings.grid = grid_->isChecked();
  settings.shaded = shaded_->isChecked();
  (void)scene_->setSettings(settings);  // reads nothing itself
  readMissing();
  Preferences& preferences = context_.workspace.preferences();
  preferences.setText("view3d/colouring", colouring_->currentData().toString());
  preferences.setText("view3d/points", points_->currentData().toString());
  preferences.setText("view3d/point-size", QString::number(size_->value()));
  preferences.setText("view3d/path", path_->isChecked() ? "1" : "0");
  preferences.setText("view3d/grid", grid_->isChecked() ? "1" : "0");
  preferences.setText("view3d/shaded", shaded_->isChecked() ? "1" : "0");
  refreshResiduals();
  view_->drawSoon();
}

SceneColours View3dPanel::usualColours() const {
  const ThemeColours& c = context_.theme.colours();
  return {rgbOf(c.view_top), rgbOf(c.view_bottom), rgbOf(c.view_text), rgbOf(c.view_grid),
          rgbOf(c.no_data),  rgbOf(c.good),        rgbOf(c.accent),    rgbOf(c.warning)};
}

void View3dPanel::applyTheme() {
  scene_->setColours(usualColours());
  view_->drawSoon();
}

void View3dPanel::refreshResiduals() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  if (!snapshot || scene_->settings().colouring != SceneColouring::Residual) {
    refreshComputing();
    return;
  }
  Residuals& residuals = context_.workspace.residuals();
  const Stage stage = context_.workspace.display().stage();
  const ScanResiduals now = residuals.ofAll(stage);
  const bool both = scene_->compare() != SceneCompare::Off;
  scene_->setResiduals(now, both ? residuals.ofAll(scene_->before()) : ScanResiduals());
  refreshComputing();
  view_->drawSoon();
}

void View3dPanel::refreshStages() {
  stage_->clear();
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const ScanDisplay& display = context_.workspace.display();
  stage_->addItem("Latest", QString());
  if (snapshot)
    for (const Stage stage : snapshot->stages()) stage_->addItem(stageTitle(stage), qt(stageName(stage)));
  if (const auto chosen = display.chosenStage())
    stage_->setCurrentIndex(std::max(0, stage_->findData(qt(stageName(*chosen)))));
}

void View3dPanel::refreshScans() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  refreshStages();
  const ScanDisplay& display = context_.workspace.display();
  const Stage stage = snapshot ? display.placedStage() : Stage::Odometry;
  (void)scene_->show(display.placed(), stage);
  readMissing();
  compare_bar_->setStages(display.placed(), stage);
  refreshResiduals();
  const bool some = snapshot && !snapshot->scans().empty();
  pages_->setCurrentWidget(some ? static_cast<QWidget*>(view_) : empty_);
  bar_->setEnabled(some);
  view_->drawSoon();
}

void View3dPanel::readMissing() {
  const bool was = reader_.isReading();
  reader_.want(scene_->missing());
  if (was || !reader_.isReading()) return;
  reading_since_.start();
  QTimer::singleShot(kMoment_ms + 1, this, &View3dPanel::refreshComputing);
}

void View3dPanel::refreshComputing() {
  const bool shows_residuals =
      context_.workspace.snapshot() && scene_->settings().colouring == SceneColouring::Residual;
  const int residuals = shows_residuals ? context_.workspace.residuals().wanted() : 0;
  QString text;
  if (reader_.isReading() && reading_since_.isValid() && reading_since_.elapsed() > kMoment_ms)
    text = QString("Reading scans: %1 of %2…").arg(reader_.done()).arg(reader_.total());
  else if (residuals > 0)
    text = QString("Computing residuals: %1 to go…").arg(residuals);
  computing_->setText(text);
  computing_->adjustSize();
  computing_->move(std::max(0, (view_->width() - computing_->width()) / 2),
                   8);  // between what stands in the corners
  computing_->setVisible(!text.isEmpty());
}

Status View3dPanel::writePicture(const QString& file, const QSize& size, bool on_white) {
  const auto image =
      view_->pictureOf(size, on_white ? SceneColours::white() : usualColours(), usualColours());
  if (!image) return fail(image.error());
  RgbImage rgb(image->width(), image->height(), {});
  for (int y = 0; y < image->height(); ++y) {
    const unsigned char* line = image->constScanLine(y);
    for (int x = 0; x < image->width(); ++x) rgb.at(x, y) = {line[3 * x], line[3 * x + 1], line[3 * x + 2]};
  }
  return writePng(pathOf(file), rgb);
}

void View3dPanel::askForPicture() {
  askForFiles(this, context_.workspace.preferences(),
              {FileQuestion::Save, "Save picture", "Pictures (*.png)", "png", "pictures",
               context_.workspace.session().name() + "-3d.png"},
              [this](const QStringList& files) {
                const Status status =
                    writePicture(files.front(), picture_bar_->wanted(), picture_bar_->onWhite());
                if (status)
                  context_.workspace.messages().note("Wrote " + files.front());
                else
                  context_.workspace.messages().error(status.error());
              });
}

}  // namespace tiltmap::ui
