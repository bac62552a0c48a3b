#include "ui/panels/stepper_view_panel.h"

#include <QCheckBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QSpinBox>
#include <QStackedLayout>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/look/flow_layout.h"
#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/models/study_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/stepper_scene_widget.h"

namespace tiltmap::ui {

namespace {

Rgb rgbOf(const QColor& colour) {
  return {static_cast<std::uint8_t>(colour.red()), static_cast<std::uint8_t>(colour.green()),
          static_cast<std::uint8_t>(colour.blue())};
}

QColor colourOf(Rgb c) {
  return {c.r, c.g, c.b};
}

constexpr RejectReason kFates[] = {
    RejectReason::None,       RejectReason::TooFar,   RejectReason::NormalDisagrees,
    RejectReason::Statistics, RejectReason::NoNormal, RejectReason::NoPartner};

QString fateTip(RejectReason reason) {
  switch (reason) {
    case RejectReason::None:
      return "Pairs used for the motion; paler where the loss leaves them less weight";
    case RejectReason::TooFar:
      return "Rejected: further apart than the distance bound";
    case RejectReason::NormalDisagrees:
      return "Rejected: the surfaces' normals differ by more than the angle bound";
    case RejectReason::Statistics:
      return "Rejected: beyond the bound from mean and deviation of all distances";
    case RejectReason::NoNormal:
      return "Rejected: one of the two has no normal";
    case RejectReason::NoPartner:
      return "Nothing of the other scan to pair with";
  }
  return {};
}

// The line as the view draws it.
QIcon fateIcon(RejectReason reason, const QColor& colour, double ratio) {
  QPixmap pixmap(QSize(28, 14) * ratio);
  pixmap.setDevicePixelRatio(ratio);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(colour, 2.0, Qt::SolidLine, Qt::FlatCap));
  for (const auto& [from, to] : fateDashes(reason))
    painter.drawLine(QPointF(2.0 + 24.0 * from, 7.0), QPointF(2.0 + 24.0 * to, 7.0));
  painter.setPen(Qt::NoPen);
  painter.setBrush(colour);
  // Without a partner there is no line, and the dot stands alone.
  painter.drawEllipse(QPointF(reason == RejectReason::NoPartner ? 14.0 : 3.5, 7.0), 2.5, 2.5);
  return QIcon(pixmap);
}

}  // namespace

StepperViewPanel::StepperViewPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(context.workspace.stepper()),
      study_(StudyModel::of(model_)),
      scene_(std::make_unique<Scene>()),
      layer_(std::make_unique<RegistrationLayer>(*scene_)) {
  view_ = new StepperSceneWidget(*scene_, *layer_, model_.start(), this);
  view_->setObjectName("stepper-view");
  view_->setAccessibleName("3D view of the two scans being registered");
  view_->setToolTip(
      "Drag turns, right or Shift-drag shifts, wheel zooms, click picks a pair.\n"
      "Keys: 8 top, 2 bottom, 5 front, 0 back, 4 left, 6 right, 7 and 9 at an angle, O orthographic.\n"
      "While the start is moved: arrows, page up and down, comma and period; Shift for a tenth");
  empty_ = new EmptyState("Two scans are needed. Import some, or simulate a survey.",
                          context.actions.find("op.import"), this);
  empty_->setObjectName("stepper-view-empty");
  auto* pages = new QWidget(this);
  pages_ = new QStackedLayout(pages);
  pages_->addWidget(empty_);
  pages_->addWidget(view_);
  sentence_ = new QLabel(this);
  sentence_->setObjectName("stepper-picked");
  sentence_->setAccessibleName("The picked pair");
  sentence_->setWordWrap(true);
  sentence_->setContentsMargins(8, 4, 8, 4);
  sentence_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(buildBar());
  layout->addWidget(pages, 1);
  layout->addWidget(buildLegend());
  layout->addWidget(sentence_);
  setFocusProxy(view_);

  connect(&model_, &StepperModel::choiceChanged, this, &StepperViewPanel::loadScans);
  connect(&model_, &StepperModel::positionChanged, this, &StepperViewPanel::showStep);
  connect(&model_, &StepperModel::pickedChanged, this, &StepperViewPanel::showPicked);
  connect(&study_, &StudyModel::treeChanged, this, &StepperViewPanel::showTree);
  connect(&model_.start(), &StartModel::ghostChanged, this, &StepperViewPanel::showGhost);
  connect(&model_.start(), &StartModel::pointPairsChanged, this, &StepperViewPanel::showMarks);
  connect(&context.theme, &Theme::changed, this, &StepperViewPanel::applyTheme);
  connect(view_, &SceneWidget::clicked, this, &StepperViewPanel::clicked);
  connect(view_, &SceneWidget::frameAsked, this, [this] {
    scene_->frame({});
    view_->drawSoon();
  });
  scene_->setView(SceneView::Iso);
  SceneSettings settings = scene_->settings();
  settings.path = false;
  (void)scene_->setSettings(settings);
  applyTheme();
  loadScans();
}

StepperViewPanel::~StepperViewPanel() {
  // The widget lets go of the scene before the scene goes.
  delete view_;
}

QWidget* StepperViewPanel::view() const {
  return view_;
}

QImage StepperViewPanel::picture() {
  return view_->grabFramebuffer();
}

QWidget* StepperViewPanel::buildBar() {
  auto* bar = new QWidget(this);
  // In a narrow view the buttons go on below the names of the scans.
  auto* row = new FlowLayout(bar);
  row->setContentsMargins(8, 4, 8, 4);
  row->setSpacing(8);
  title_ = new QLabel(bar);
  title_->setObjectName("stepper-view-title");
  title_->setMinimumSize(120, fontMetrics().height() + 8);
  points_ = toggleButton(bar, "stepper-show-points", "Points", "The points of both scans", true);
  patches_ = toggleButton(bar, "stepper-show-patches", "Patches",
                          "Outlines of the plane patches that are paired, coloured by the fate of their pair",
                          false);
  found_ = toggleButton(bar, "stepper-as-found", "As found",
                        "Show the moving scan where the step's pairs were found, before its motion", false);
  tree_ = toggleButton(bar, "stepper-show-tree", "Tree",
                       "The kD-tree's cells, and the leaves that the search for the picked pair looks into",
                       false);
  depth_ = new QSpinBox(bar);
  depth_->setObjectName("stepper-tree-depth");
  depth_->setAccessibleName("Depth of the cells shown");
  depth_->setToolTip("Cells down to this level, 0 (the whole) to 12");
  depth_->setRange(0, 12);
  depth_->setValue(study_.treeDepth());
  depth_->setVisible(false);
  adjust_ = toggleButton(
      bar, "stepper-adjust", "Move start",
      "Drag the handles, or use arrows, page up and down, comma and period, to move the start", false);
  pick_points_ = toggleButton(
      bar, "stepper-pick-points", "Pick points",
      "Click the same places in both scans, the fixed one first: three pairs give a start", false);
  row->addWidget(title_);
  for (QWidget* control :
       std::initializer_list<QWidget*>{points_, patches_, found_, tree_, depth_, adjust_, pick_points_})
    row->addWidget(control);
  connect(tree_, &QToolButton::toggled, this, [this](bool on) {
    depth_->setVisible(on);
    study_.setTreeShown(on);
  });
  connect(depth_, qOverload<int>(&QSpinBox::valueChanged), &study_, &StudyModel::setTreeDepth);
  connect(points_, &QToolButton::toggled, this, [this](bool on) {
    layer_->setPointsShown(on);
    view_->drawSoon();
  });
  connect(patches_, &QToolButton::toggled, this, &StepperViewPanel::showStep);
  connect(found_, &QToolButton::toggled, this, &StepperViewPanel::showStep);
  connect(adjust_, &QToolButton::toggled, this, [this](bool on) {
    if (on) pick_points_->setChecked(false);
    if (on) model_.goTo(0);
    // Where it would end is what one moves it for; the box beside the numbers takes it away.
    if (on) model_.start().setGhostWanted(true);
    view_->setAdjusting(on);
    if (on) view_->setFocus();
  });
  connect(pick_points_, &QToolButton::toggled, this, [this](bool on) {
    if (on) adjust_->setChecked(false);
    showPicked();
  });
  return bar;
}

QWidget* StepperViewPanel::buildLegend() {
  auto* bar = new QWidget(this);
  bar->setObjectName("stepper-legend");
  auto* row = new QHBoxLayout(bar);
  row->setContentsMargins(8, 4, 8, 0);
  row->setSpacing(12);
  for (const RejectReason reason : kFates) {
    auto* box = new QCheckBox(bar);
    box->setObjectName(QString("stepper-fate-%1").arg(static_cast<int>(reason)));
    box->setChecked(reason != RejectReason::NoPartner);
    box->setToolTip(fateTip(reason));
    box->setIconSize(QSize(28, 14));
    connect(box, &QCheckBox::toggled, this, &StepperViewPanel::showStep);
    row->addWidget(box);
    fates_[reason] = box;
  }
  row->addStretch(1);
  return bar;
}

void StepperViewPanel::paintLegend() {
  const RegistrationColours colours = RegistrationColours::of(context_.theme.isDark());
  const TraceStep* step = model_.current();
  for (const auto& [reason, box] : fates_) {
    const auto k = static_cast<std::size_t>(reason);
    const std::size_t count = step ? step->report.rejected[k] : 0;
    QString text = qt(rejectReasonName(reason));
    if (step) text += " " + groupedNumber(static_cast<long long>(count));
    box->setText(text);
    box->setAccessibleName("Show pairs: " + qt(rejectReasonName(reason)));
    box->setIcon(fateIcon(reason, colourOf(colours.fate[k]), devicePixelRatioF()));
    // What the method never says need not take room.
    const bool usual = reason == RejectReason::None || reason == RejectReason::NormalDisagrees;
    box->setVisible(usual || count > 0);
  }
}

std::set<RejectReason> StepperViewPanel::shownFates() const {
  std::set<RejectReason> shown;
  for (const auto& [reason, box] : fates_)
    if (box->isChecked()) shown.insert(reason);
  return shown;
}

void StepperViewPanel::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  loadScans();
}

// The points are read off the window's thread, and only when they are to be seen.
void StepperViewPanel::loadScans() {
  const PreparedPairPtr scans = model_.scans();
  pages_->setCurrentWidget(scans ? static_cast<QWidget*>(view_) : empty_);
  title_->setText(
      scans
          ? QString("Moving %1, orange, on fixed %2, grey").arg(model_.scanName(false), model_.scanName(true))
          : QString());
  title_->setToolTip(title_->text());
  for (QToolButton* button : {points_, patches_, found_, tree_, adjust_, pick_points_})
    button->setEnabled(scans != nullptr);
  if (!scans) {
    loader_.cancel();
    loaded_ = nullptr;
    layer_->clear();
    adjust_->setChecked(false);
    pick_points_->setChecked(false);
    view_->drawSoon();
    return;
  }
  if (loaded_ == scans.get() || !isVisible()) return;
  loaded_ = scans.get();
  loader_.start([this, scans](const std::stop_token&) -> BackgroundWorker::Done {
    auto fixed = scanPointsOf(scans->fixed(), false);
    auto moving = scanPointsOf(scans->moving(), false);
    return [this, fixed = std::move(fixed), moving = std::move(moving)]() mutable {
      for (const auto* points : {&fixed, &moving})
        if (!*points) return context_.workspace.messages().error(points->error());
      layer_->setScans(std::move(fixed->xyz), std::move(moving->xyz), model_.pose());
      showStep();
      showMarks();
    };
  });
}

void StepperViewPanel::showStep() {
  layer_->setPixelRatio(devicePixelRatioF());
  layer_->place(found_->isChecked() ? model_.poseBefore() : model_.pose());
  layer_->setPairs(model_.attempt(), model_.pairs(), shownFates(), patches_->isChecked());
  paintLegend();
  showPicked();
  showGhost();
}

void StepperViewPanel::showGhost() {
  const auto& ghost = model_.start().ghost();
  layer_->setGhost(ghost && ghost->succeeded() && model_.position() == 0
                       ? std::optional(ghost->fixed_from_moving)
                       : std::nullopt);
  view_->drawSoon();
}

void StepperViewPanel::showMarks() {
  std::vector<std::pair<Eigen::Vector3d, int>> fixed, moving;
  int number = 1;
  for (const StartModel::PointPair& pair : model_.start().pointPairs()) {
    if (pair.fixed) fixed.emplace_back(*pair.fixed, number);
    if (pair.moving) moving.emplace_back(*pair.moving, number);
    ++number;
  }
  layer_->setMarks(fixed, moving);
  showPicked();
  view_->drawSoon();
}

void StepperViewPanel::showTree() {
  layer_->setTree(study_.cells(), study_.visit(), study_.query());
  showPicked();
}

void StepperViewPanel::showPicked() {
  layer_->setPicked(model_.picked());
  QString text = model_.pickedSentence();
  if (pick_points_->isChecked())
    text =
        QString("Point pair %1: click a point of the %2 scan.")
            .arg(model_.start().pointPairs().size() +
                 (model_.start().pointPairs().empty() || model_.start().pointPairs().back().complete() ? 1
                                                                                                       : 0))
            .arg(model_.start().nextIsFixed() ? "fixed (grey)" : "moving (orange)");
  else if (text.isEmpty())
    text =
        model_.current() ? "Click a pair to have it explained." : "The pairs show here once a step is taken.";
  if (const QString tree = study_.treeSentence(); !tree.isEmpty() && !pick_points_->isChecked())
    text = model_.picked() ? text + " " + tree : tree;
  sentence_->setText(text);
  view_->drawSoon();
}

void StepperViewPanel::clicked(const QPointF& place) {
  const Eigen::Vector2d pixel = view_->pixelAt(place);
  const double ratio = view_->devicePixelRatioF();
  if (!pick_points_->isChecked()) return model_.pick(layer_->pickPair(pixel, 8.0 * ratio));
  const bool of_fixed = model_.start().nextIsFixed();
  if (const auto point = layer_->pickPoint(of_fixed, pixel, 10.0 * ratio))
    model_.start().addPoint(of_fixed, *point);
}

void StepperViewPanel::applyTheme() {
  const ThemeColours& c = context_.theme.colours();
  scene_->setColours(
      {rgbOf(c.view_top), rgbOf(c.view_bottom), rgbOf(c.view_text), rgbOf(c.view_grid), rgbOf(c.no_data)});
  RegistrationColours colours = RegistrationColours::of(context_.theme.isDark());
  colours.ground = rgbOf(c.view_bottom);
  layer_->setColours(colours);
  paintLegend();
  view_->drawSoon();
}

}  // namespace tiltmap::ui
