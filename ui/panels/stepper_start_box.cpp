#include "ui/panels/stepper_start_box.h"

#include <QCheckBox>
#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <cmath>

#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/fold_box.h"

namespace tiltmap::ui {

namespace {

double headingOf(const Pose& pose) {
  const Eigen::Vector3d h = pose.heading();
  return std::atan2(-h.x(), h.y());
}

QDoubleSpinBox* number(QWidget* parent, const QString& name, const QString& text, const QString& unit,
                       double most, double step, int places) {
  auto* box = new QDoubleSpinBox(parent);
  describe(box, name, text, QString("%1, -%2 to %2%3").arg(text).arg(most).arg(unit));
  box->setRange(-most, most);
  box->setSingleStep(step);
  box->setDecimals(places);
  box->setSuffix(unit);
  box->setKeyboardTracking(false);
  box->setAlignment(Qt::AlignRight);
  return box;
}

}  // namespace

StepperStartBox::StepperStartBox(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), stepper_(context.workspace.stepper()), model_(stepper_.start()) {
  auto* fold = new FoldBox("Start", "stepper-start", this);
  fold->setToolTip("Where the registration starts: by odometry, or set by hand");
  fold->content()->addWidget(buildNumbers());
  fold->content()->addWidget(buildPoints());
  fold->content()->addWidget(buildSweep());
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(fold);
  connect(&model_, &StartModel::startChanged, this, &StepperStartBox::refreshStart);
  connect(&model_, &StartModel::ghostChanged, this, &StepperStartBox::refreshGhost);
  connect(&model_, &StartModel::pointPairsChanged, this, &StepperStartBox::refreshPoints);
  connect(&model_, &StartModel::sweepChanged, this, &StepperStartBox::refreshSweep);
  refreshStart();
  refreshPoints();
}

QWidget* StepperStartBox::buildNumbers() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(8);
  x_ = number(box, "stepper-start-x", "Start to the right", " m", 1000.0, 0.1, 3);
  y_ = number(box, "stepper-start-y", "Start ahead", " m", 1000.0, 0.1, 3);
  z_ = number(box, "stepper-start-z", "Start above", " m", 1000.0, 0.1, 3);
  heading_ = number(box, "stepper-start-heading", "Heading of the start, left positive", " °", 360.0, 1.0, 2);
  const std::pair<const char*, QDoubleSpinBox*> rows[] = {
      {"x", x_}, {"y", y_}, {"z", z_}, {"Heading", heading_}};
  int at = 0;
  for (const auto& [text, spin] : rows) {
    grid->addWidget(new QLabel(text, box), at / 2, 2 * (at % 2));
    grid->addWidget(spin, at / 2, 2 * (at % 2) + 1);
    grid->setColumnStretch(2 * (at % 2) + 1, 1);
    connect(spin, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &StepperStartBox::takeNumbers);
    ++at;
  }
  reset_ = new QPushButton("Odometry", box);
  describe(reset_, "stepper-start-reset", "Start from the odometry", "Start where the odometry says");
  connect(reset_, &QPushButton::clicked, &model_, &StartModel::reset);
  ghost_ = new QCheckBox("Show where it would end", box);
  describe(ghost_, "stepper-ghost", "Show where registering would end",
           "A ghost of the moving scan, computed anew whenever the start changes");
  connect(ghost_, &QCheckBox::toggled, &model_, &StartModel::setGhostWanted);
  ghost_text_ = wrappedLabel(box, "stepper-ghost-text");
  grid->addWidget(reset_, 2, 0, 1, 4, Qt::AlignLeft);
  grid->addWidget(ghost_, 3, 0, 1, 4);
  grid->addWidget(ghost_text_, 4, 0, 1, 4);
  return box;
}

QWidget* StepperStartBox::buildPoints() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  points_ = new QTableWidget(0, 2, box);
  describe(points_, "stepper-points", "Point pairs",
           "Points picked in both scans; residual: how far they stay apart");
  points_->setHorizontalHeaderLabels({"Picked in", "Residual (mm)"});
  points_->horizontalHeader()->setSectionResizeMode(QHeaderView::Stretch);
  points_->verticalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  points_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  points_->setSelectionBehavior(QAbstractItemView::SelectRows);
  points_->setSelectionMode(QAbstractItemView::SingleSelection);
  points_->setFixedHeight(104);
  points_text_ = wrappedLabel(box, "stepper-points-text");
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  use_points_ = new QPushButton("Use points", box);
  describe(use_points_, "stepper-use-points", "Start from the point pairs",
           "Place the moving scan so that the pairs fit best");
  remove_point_ = new QPushButton("Remove", box);
  describe(remove_point_, "stepper-remove-point", "Remove the point pair",
           "Take out the selected pair, or the last one");
  connect(use_points_, &QPushButton::clicked, this, [this] { model_.usePointPairs(); });
  connect(remove_point_, &QPushButton::clicked, this, [this] {
    const int chosen = points_->currentRow() >= 0 ? points_->currentRow() : points_->rowCount() - 1;
    if (chosen >= 0) model_.removePointPair(static_cast<std::size_t>(chosen));
  });
  row->addWidget(use_points_);
  row->addWidget(remove_point_);
  row->addStretch(1);
  column->addWidget(points_text_);
  column->addWidget(points_);
  column->addLayout(row);
  return box;
}

QWidget* StepperStartBox::buildSweep() {
  auto* box = new QWidget(this);
  auto* column = new QVBoxLayout(box);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(4);
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  sweep_ = new QPushButton("Try all headings", box);
  describe(sweep_, "stepper-sweep", "Try all headings",
           "Turn the moving scan on the spot in steps of 3 degrees and count what fits; the curve is "
           "among the plots");
  use_sweep_ = new QPushButton("Use the best", box);
  describe(use_sweep_, "stepper-use-heading", "Start from the best heading",
           "Turn the start to the heading at which most fits");
  connect(sweep_, &QPushButton::clicked, &model_, &StartModel::sweepHeadings);
  connect(use_sweep_, &QPushButton::clicked, this, [this] { model_.useBestHeading(); });
  row->addWidget(sweep_);
  row->addWidget(use_sweep_);
  row->addStretch(1);
  sweep_text_ = wrappedLabel(box, "stepper-sweep-text");
  column->addLayout(row);
  column->addWidget(sweep_text_);
  return box;
}

void StepperStartBox::takeNumbers() {
  if (showing_ || !model_.hasScans()) return;
  const Pose& now = model_.start();
  const double turn = heading_->value() * kDegree - headingOf(now);
  const Pose turned = std::abs(turn) > 1e-9 ? turnedStart(now, turn) : now;
  model_.setStart(Pose(turned.quaternion(), {x_->value(), y_->value(), z_->value()}));
}

void StepperStartBox::refreshStart() {
  showing_ = true;
  const Pose& start = model_.start();
  x_->setValue(start.translation().x());
  y_->setValue(start.translation().y());
  z_->setValue(start.translation().z());
  heading_->setValue(headingOf(start) / kDegree);
  showing_ = false;
  const bool any = model_.hasScans();
  for (QWidget* widget :
       {static_cast<QWidget*>(x_), static_cast<QWidget*>(y_), static_cast<QWidget*>(z_),
        static_cast<QWidget*>(heading_), static_cast<QWidget*>(ghost_), static_cast<QWidget*>(sweep_)})
    widget->setEnabled(any);
  reset_->setEnabled(any && model_.byHand());
  refreshGhost();
  refreshSweep();
}

void StepperStartBox::refreshGhost() {
  ghost_->setChecked(model_.ghostWanted());
  QString text;
  if (!model_.ghostWanted()) {
  } else if (const auto& ghost = model_.ghost()) {
    text =
        ghost->succeeded()
            ? QString("It would end %1 and %2° from here; %3 % agree.")
                  .arg(smallLengthText(difference(ghost->fixed_from_moving, model_.start()).translation_m,
                                       LengthUnit::Millimetre))
                  .arg(difference(ghost->fixed_from_moving, model_.start()).rotation_rad / kDegree, 0, 'f', 1)
                  .arg(100.0 * ghost->agreement, 0, 'f', 0)
            : "From here it would fail: " + qt(stopReasonName(ghost->stop_reason)) + ".";
  } else if (model_.ghostBusy()) {
    text = "Registering from here…";
  }
  ghost_text_->setText(text);
  ghost_text_->setVisible(model_.ghostWanted());
}

void StepperStartBox::refreshPoints() {
  const auto fit = model_.pointPairFit();
  points_->setRowCount(static_cast<int>(model_.pointPairs().size()));
  std::size_t complete = 0;
  for (int row = 0; row < points_->rowCount(); ++row) {
    const StartModel::PointPair& pair = model_.pointPairs()[static_cast<std::size_t>(row)];
    const QString sides = pair.complete() ? "both scans" : (pair.fixed ? "fixed scan" : "moving scan");
    QString residual = "–";
    if (pair.complete()) {
      if (fit) residual = QString::number(1e3 * fit->residual_m[complete], 'f', 1);
      ++complete;
    }
    points_->setItem(row, 0, new QTableWidgetItem(sides));
    auto* item = new QTableWidgetItem(residual);
    item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
    points_->setItem(row, 1, item);
  }
  const bool any = points_->rowCount() > 0;
  points_->setVisible(any);
  remove_point_->setVisible(any);
  use_points_->setEnabled(fit.has_value());
  QString text;
  if (!any)
    text =
        "Point pairs: press Pick points in the registration view, then click the same places in both scans.";
  else if (fit)
    text =
        QString("Point pairs: %1 apart on average.").arg(smallLengthText(fit->rms_m, LengthUnit::Millimetre));
  else if (complete >= 3)
    text = qt(fit.error().what) + ".";
  else
    text = QString("Point pairs: next, a point of the %1 scan; three pairs are needed.")
               .arg(model_.nextIsFixed() ? "fixed" : "moving");
  points_text_->setText(text);
}

void StepperStartBox::refreshSweep() {
  const auto& sweep = model_.sweep();
  use_sweep_->setEnabled(sweep.has_value());
  QString text;
  if (sweep)
    text = QString("Most fits at %1° from the start: %2 % of the moving scan.")
               .arg(sweep->bestScore().turned_rad / kDegree, 0, 'f', 0)
               .arg(100.0 * sweep->bestScore().score, 0, 'f', 0);
  else if (model_.sweepBusy())
    text = "Trying headings…";
  sweep_text_->setText(text);
  sweep_text_->setVisible(!text.isEmpty());
}

}  // namespace tiltmap::ui
