#include "ui/panels/capture_panel.h"

#include <QAbstractButton>
#include <QAbstractSpinBox>
#include <QAction>
#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QTabBar>
#include <QTabWidget>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/theme.h"
#include "ui/models/capture_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/capture_banner.h"
#include "ui/panels/capture_connect_page.h"
#include "ui/panels/capture_stop_page.h"
#include "ui/panels/capture_tilt_page.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

namespace {

constexpr int kNextStop = 2;  // the tab

// Gloves: everything that is pressed is tall.
void makeTall(QWidget& root) {
  for (QWidget* widget : root.findChildren<QWidget*>())
    if (qobject_cast<QAbstractButton*>(widget) || qobject_cast<QComboBox*>(widget) ||
        qobject_cast<QAbstractSpinBox*>(widget) ||
        (qobject_cast<QLineEdit*>(widget) && !qobject_cast<QAbstractSpinBox*>(widget->parentWidget()) &&
         !qobject_cast<QComboBox*>(widget->parentWidget())))
      if (!qobject_cast<QTabBar*>(widget->parentWidget())) widget->setMinimumHeight(CapturePanel::kTarget_px);
}

}  // namespace

CapturePanel::CapturePanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(captureModel(context.workspace)),
      banner_(new CaptureBanner(model_, context.theme, this)),
      tabs_(new QTabWidget(this)),
      connect_page_(new CaptureConnectPage(model_, context, this)),
      stop_page_(new CaptureStopPage(model_, context, this)) {
  tabs_->setObjectName("capture-tabs");
  tabs_->setDocumentMode(true);
  tabs_->tabBar()->setExpanding(true);
  tabs_->tabBar()->setStyleSheet(QString("QTabBar::tab { min-height: %1px; }").arg(kTarget_px - 6));
  tabs_->addTab(scrolled(connect_page_, "capture-connect-scroll", this), "&Instruments");
  tabs_->addTab(scrolled(new CaptureTiltPage(model_, this), "capture-tilt-scroll", this), "T&ilt");
  tabs_->addTab(scrolled(stop_page_, "capture-stop-scroll", this), "&Next stop");
  tabs_->setTabToolTip(0, "Where the instruments are, who they are and how they are");
  tabs_->setTabToolTip(1, "Move the tilt by hand, search home, park");
  tabs_->setTabToolTip(2, "Where the next stop is, and how it is swept");
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  column->addWidget(banner_);
  column->addWidget(tabs_, 1);
  figures_box_ = makeFigures();
  column->addWidget(figures_box_);
  column->addWidget(makeButtons());
  setFocusProxy(start_);
  column->setSizeConstraint(QLayout::SetNoConstraint);
  setMinimumSize(minimumSizeHint());
  makeTall(*this);
  stop_->setMinimumHeight(56);
  start_->setMinimumHeight(56);
  resume_->setMinimumHeight(56);

  connect(&model_, &CaptureModel::changed, this, &CapturePanel::refresh);
  connect(tabs_, &QTabWidget::currentChanged, this, &CapturePanel::refresh);
  connect(stop_page_, &CaptureStopPage::changed, this, &CapturePanel::refresh);
  connect(&context.theme, &Theme::changed, this, &CapturePanel::paintStop);
  paintStop();
  refresh();
}

QWidget* CapturePanel::makeFigures() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(8, 4, 8, 4);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(2);
  progress_ = new QProgressBar(box);
  progress_->setObjectName("capture-progress");
  progress_->setAccessibleName("Lines taken");
  progress_->setRange(0, 1000);
  grid->addWidget(progress_, 0, 0, 1, 2);
  const std::pair<const char*, const char*> rows[] = {
      {"Time left", "Until the sweep is done, as fast as it went so far"},
      {"Dead cells", "Share of the beams that brought no point"},
      {"Taken again", "Lines that came damaged, or while the tilt moved; how often an instrument was lost"},
      {"Tilt error", "Angle read back minus angle wished, of the last line; and the largest"},
      {"Disk", "Room on the disk of the project, and how many sweeps of these settings it holds"}};
  int k = 0;
  for (const auto& [name, tip] : rows) {
    auto* label = new QLabel(name, box);
    auto* value = new QLabel(box);
    value->setObjectName(QString("capture-figure-%1").arg(k));
    value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    value->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
    for (QLabel* one : {label, value}) one->setToolTip(tip);
    figures_.push_back(value);
    grid->addWidget(label, 1 + k, 0);
    grid->addWidget(value, 1 + k, 1);
    ++k;
  }
  grid->setColumnStretch(1, 1);
  place_ = wrappedLabel(box, "capture-place");
  grid->addWidget(place_, 1 + k, 0, 1, 2);
  return box;
}

QWidget* CapturePanel::makeButtons() {
  auto* box = new QWidget(this);
  auto* row = new QHBoxLayout(box);
  row->setContentsMargins(8, 4, 8, 8);
  row->setSpacing(8);
  start_ = new QPushButton("Start", box);
  start_->setObjectName("capture-start");
  start_->setAccessibleName("Start the sweep of the next stop");
  connect(start_, &QPushButton::clicked, this, &CapturePanel::start);
  resume_ = new QPushButton("Go on", box);
  describe(resume_, "capture-resume", "Go on with the interrupted stop",
           "Take the lines that the last stop is missing, with its own settings. The vehicle must not have "
           "moved");
  connect(resume_, &QPushButton::clicked, &model_, &CaptureModel::resume);
  stop_ = new QPushButton("STOP", box);
  const QAction* action = context_.actions.find("capture.stop");
  const QString key = action ? action->shortcut().toString(QKeySequence::NativeText) : QString();
  describe(stop_, "capture-stop", "Stop",
           "Stop whatever goes on: tilt, sweep, search. Every line that is complete is kept (" + key + ")");
  connect(stop_, &QPushButton::clicked, &model_, &CaptureModel::stop);
  row->addWidget(start_, 2);
  row->addWidget(resume_, 2);
  row->addWidget(stop_, 3);
  return box;
}

// Red in every theme; white on it is 6.6 : 1.
void CapturePanel::paintStop() {
  stop_->setStyleSheet(
      "QPushButton { background: #b71c1c; color: white; border: 2px solid #7f0000; border-radius: 4px; }"
      "QPushButton:focus { border-color: palette(text); }"
      "QPushButton:pressed { background: #7f0000; }");
  QFont bold = font();
  bold.setBold(true);
  start_->setFont(bold);
  resume_->setFont(bold);
  bold.setPointSizeF(1.4 * bold.pointSizeF());
  stop_->setFont(bold);
}

void CapturePanel::start() {
  if (start_->isEnabled()) model_.start(stop_page_->lastFromNext());
}

void CapturePanel::refresh() {
  QString why = model_.whyNotStart();
  if (why.isEmpty()) why = stop_page_->missing();
  start_->setEnabled(why.isEmpty());
  start_->setToolTip(why.isEmpty() ? "Take the next stop, line by line, into the project" : why);
  resume_->setVisible(model_.canResume());
  const StationSweep& sweep = model_.now().sweep;
  progress_->setValue(sweep.number == 0 ? 0 : 1000 * sweep.rows_taken / std::max(1, sweep.geometry.rows));
  progress_->setFormat(model_.linesText());
  const QString texts[] = {model_.leftText(), model_.deadText(), model_.retriesText(), model_.tiltErrorText(),
                           model_.diskText()};
  for (std::size_t k = 0; k < figures_.size(); ++k) figures_[k]->setText(texts[k].isEmpty() ? "–" : texts[k]);
  QString place;
  const CaptureVerdict& verdict = model_.verdict();
  if (const auto& told = verdict.judgement()) {
    if (told->overlap > 0.0) place = QString("Overlap %1 %. ").arg(100.0 * told->overlap, 0, 'f', 0);
    // Of one that has no place nothing holds.
    if (told->placed && !told->weak_directions.isEmpty())
      place += "It " + told->weak_directions + (told->weak_directions.endsWith('.') ? "" : ".");
    place_->setToolTip(told->figures);
  } else if (const auto& so_far = verdict.estimate(); so_far && so_far->overlap > 0.0) {
    place =
        QString("Overlap so far %1 % (%2 lines).").arg(100.0 * so_far->overlap, 0, 'f', 0).arg(so_far->lines);
  }
  place_->setText(place);
  place_->setVisible(!place.isEmpty());
  // Who prepares the next stop needs the room, not what the last one was at.
  figures_box_->setVisible(tabs_->currentIndex() != kNextStop || model_.isSweeping());
  context_.actions.scheduleRefresh();
}

}  // namespace tiltmap::ui
