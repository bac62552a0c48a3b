#include "ui/panels/relaxation_panel.h"

#include <QAction>
#include <QComboBox>
#include <QFrame>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QStyledItemDelegate>
#include <QTabWidget>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/models/job_list_model.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/relaxation_table_model.h"
#include "ui/models/strings.h"
#include "ui/models/units.h"
#include "ui/models/workspace.h"
#include "ui/panels/marks.h"
#include "ui/panels/movement_plot.h"
#include "ui/panels/table_view.h"

namespace tiltmap::ui {

namespace {

// The set that a scan is in, with its mark.
class RoleDelegate : public QStyledItemDelegate {
 public:
  RoleDelegate(const Theme& theme, QObject* parent) : QStyledItemDelegate(parent), theme_(theme) {}

 protected:
  void initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const override {
    QStyledItemDelegate::initStyleOption(option, index);
    const auto role = static_cast<RelaxationRole>(index.data(RelaxationTableModel::kSortRole).toInt());
    const qreal ratio = option->widget ? option->widget->devicePixelRatioF() : 1.0;
    option->icon = roleIcon(role, theme_.colours(), ratio);
    option->decorationSize = QSize(16, 16);
    if (role != RelaxationRole::None) option->features |= QStyleOptionViewItem::HasDecoration;
  }

 private:
  const Theme& theme_;
};

QLabel* yieldingLabel(const QString& name, QWidget* parent) {
  auto* label = new QLabel(parent);
  label->setObjectName(name);
  label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  return label;
}

QString sentence(QString text) {
  if (!text.isEmpty()) text[0] = text[0].toUpper();
  return text;
}

}  // namespace

RelaxationPanel::RelaxationPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      relaxation_(context.workspace.relaxation()),
      model_(new RelaxationTableModel(context.workspace, this)),
      jobs_model_(new JobListModel(context.workspace.jobs(), this)) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(makeBar());
  layout->addWidget(makeDecision());
  tabs_ = new QTabWidget(this);
  tabs_->setObjectName("relax-tabs");
  tabs_->setDocumentMode(true);
  tabs_->addTab(makeScans(), "&Scans");
  plot_ = new MovementPlot(context, this);
  tabs_->addTab(plot_, "&Movement");
  tabs_->addTab(makeJobs(), "&Jobs");
  tabs_->addTab(makeLog(), "&Log");
  tabs_->setTabToolTip(0, "Scan by scan: pins, sets, and how far it moves, before and after");
  tabs_->setTabToolTip(1, "How far each scan has moved, step by step");
  tabs_->setTabToolTip(2, "What runs, what waits, and what came of the rest");
  tabs_->setTabToolTip(3, "Every event of every step");
  layout->addWidget(tabs_, 1);
  setFocusProxy(run_);

  connect(&relaxation_, &RelaxationModel::changed, this, &RelaxationPanel::refresh);
  connect(&relaxation_, &RelaxationModel::reset, this, [this] {
    log_->setPlainText(relaxation_.log().join('\n'));
    refresh();
  });
  connect(&relaxation_, &RelaxationModel::logged, log_, &QPlainTextEdit::appendPlainText);
  connect(&context.workspace.jobs(), &JobQueue::changed, this, &RelaxationPanel::refreshJobs);
  connect(&context.workspace.jobs(), &JobQueue::busyChanged, this, &RelaxationPanel::refresh);
  connect(&context.workspace.session(), &ProjectSession::snapshotReplaced, this, &RelaxationPanel::refresh);
  connect(model_, &QAbstractItemModel::modelReset, this, &RelaxationPanel::showSelection);
  connect(table_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &RelaxationPanel::takeSelection);
  connect(&context.workspace.selection(), &Selection::scansChanged, this, &RelaxationPanel::showSelection);
  log_->setPlainText(relaxation_.log().join('\n'));
  showSelection();
  refresh();
}

QWidget* RelaxationPanel::makeBar() {
  auto* bar = new QWidget(this);
  auto* layout = new QVBoxLayout(bar);
  layout->setContentsMargins(8, 8, 8, 4);
  layout->setSpacing(4);
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  preset_ = new QComboBox(bar);
  preset_->setObjectName("relax-preset");
  preset_->setAccessibleName("Preset of the relaxation");
  preset_->setToolTip(
      "default: all overlapping pairs at once; thesis: active and static sets, scan by scan; "
      "sequential: each scan onto those before it");
  for (const ParameterPreset& preset : operations().find("relax")->presets()) {
    preset_->addItem(qt(preset.name));
    preset_->setItemData(preset_->count() - 1, qt(preset.help), Qt::ToolTipRole);
  }
  run_ = new QPushButton("Relax", bar);
  run_->setObjectName("relax-run");
  run_->setToolTip(
      "Spread the errors over all scans, as a proposal; where work is going on it waits its turn");
  QToolButton* form =
      barButton("relax-parameters", "configure", "", "All parameters, before it is started", bar);
  form->setAccessibleName("Parameters of the relaxation");
  form->setToolButtonStyle(Qt::ToolButtonIconOnly);
  pause_ = barButton("relax-pause", "media-playback-pause", "Pause",
                     "Hold the relaxation; it goes on to the same result", bar);
  cancel_ = barButton("relax-cancel", "process-stop", "Cancel", "Stop it; the project stays as it is", bar);
  row->addWidget(preset_);
  row->addWidget(run_);
  row->addWidget(form);
  row->addStretch();
  step_ = barButton("relax-step", "go-next", "Step", "One step more, then pause again", bar);
  step_->setToolButtonStyle(Qt::ToolButtonIconOnly);
  row->addWidget(pause_);
  row->addWidget(step_);
  row->addWidget(cancel_);
  layout->addLayout(row);
  auto* status = new QHBoxLayout;
  status->setSpacing(8);
  state_ = yieldingLabel("relax-state", bar);
  progress_ = new QProgressBar(bar);
  progress_->setObjectName("relax-progress");
  progress_->setAccessibleName("Progress of the relaxation");
  progress_->setRange(0, 1000);
  progress_->setFixedWidth(120);
  progress_->setMaximumHeight(fontMetrics().height() + 2);
  status->addWidget(state_, 1);
  status->addWidget(progress_);
  layout->addLayout(status);
  doing_ = yieldingLabel("relax-doing", bar);
  doing_->setForegroundRole(QPalette::PlaceholderText);
  layout->addWidget(doing_);
  connect(run_, &QPushButton::clicked, this, &RelaxationPanel::run);
  connect(form, &QToolButton::clicked, this, [this] { context_.actions.trigger("op.relax"); });
  connect(pause_, &QToolButton::clicked, this,
          [this] { relaxation_.isPaused() ? relaxation_.resume() : relaxation_.pause(); });
  connect(step_, &QToolButton::clicked, &relaxation_, &RelaxationModel::stepOn);
  connect(cancel_, &QToolButton::clicked, &relaxation_, &RelaxationModel::cancel);
  return bar;
}

QWidget* RelaxationPanel::makeDecision() {
  decision_ = new QFrame(this);
  decision_->setObjectName("relax-decision");
  decision_->setAutoFillBackground(true);
  decision_->setBackgroundRole(QPalette::AlternateBase);
  auto* layout = new QVBoxLayout(decision_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(4);
  decision_text_ = new QLabel(decision_);
  decision_text_->setObjectName("relax-decision-text");
  decision_text_->setWordWrap(true);
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  before_ = barButton("relax-before", "", "Before", "Show all views where the scans were", decision_);
  after_ = barButton("relax-after", "", "After", "Show all views where the scans would be", decision_);
  wipe_ = barButton("relax-wipe", "", "Wipe",
                    "Both in the 3D view: before left of a divider that can be dragged, after right of it",
                    decision_);
  blink_ = barButton("relax-blink", "", "Blink", "Both in the 3D view, one after the other", decision_);
  auto* show = new QLabel("Show", decision_);
  for (QToolButton* button : {before_, after_, wipe_, blink_}) button->setCheckable(true);
  auto* accept = new QPushButton("Accept", decision_);
  accept->setObjectName("relax-accept");
  accept->setToolTip("Store the poses as the stage relaxed, and the links found; undo takes it back");
  auto* discard = new QPushButton("Discard", decision_);
  discard->setObjectName("relax-discard");
  discard->setToolTip("Leave the project as it is; nothing of the result is kept");
  row->addWidget(show);
  for (QToolButton* button : {before_, after_, wipe_, blink_}) row->addWidget(button);
  row->addStretch();
  auto* choice = new QHBoxLayout;
  choice->setSpacing(8);
  choice->addWidget(accept, 1);
  choice->addWidget(discard, 1);
  layout->addWidget(decision_text_);
  layout->addLayout(row);
  layout->addLayout(choice);
  connect(before_, &QToolButton::clicked, this, [this] {
    relaxation_.showBefore(true);
    refresh();
  });
  connect(after_, &QToolButton::clicked, this, [this] {
    relaxation_.showBefore(false);
    refresh();
  });
  const auto compare = [this](ProposalCompare how) {
    relaxation_.compareInView(how);
    refresh();
    // What was asked for is to be seen.
    const QAction* view = context_.actions.find("panel.view3d");
    if (how != ProposalCompare::Off && view && !view->isChecked()) context_.actions.trigger("panel.view3d");
  };
  connect(wipe_, &QToolButton::clicked, this,
          [compare](bool on) { compare(on ? ProposalCompare::Wipe : ProposalCompare::Off); });
  connect(blink_, &QToolButton::clicked, this,
          [compare](bool on) { compare(on ? ProposalCompare::Blink : ProposalCompare::Off); });
  connect(&context_.workspace.display(), &ScanDisplay::proposalCompareChanged, this,
          &RelaxationPanel::refresh);
  connect(accept, &QPushButton::clicked, &relaxation_, &RelaxationModel::accept);
  connect(discard, &QPushButton::clicked, &relaxation_, &RelaxationModel::discard);
  return decision_;
}

QWidget* RelaxationPanel::makeScans() {
  auto* page = new QWidget(this);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  summary_ = new QLabel(page);
  summary_->setObjectName("relax-summary");
  summary_->setWordWrap(true);
  summary_->setContentsMargins(8, 4, 8, 4);
  summary_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  table_ = new TableView(page);
  table_->setObjectName("relax-table");
  table_->setAccessibleName("Scans before and after the relaxation");
  table_->setModel(model_);
  table_->setItemDelegateForColumn(RelaxationTableModel::Role, new RoleDelegate(context_.theme, this));
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  layout->addWidget(summary_);
  layout->addWidget(table_, 1);
  return page;
}

QWidget* RelaxationPanel::makeJobs() {
  auto* page = new QWidget(this);
  auto* layout = new QVBoxLayout(page);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  jobs_ = new TableView(page);
  jobs_->setObjectName("relax-jobs");
  jobs_->setAccessibleName("Jobs");
  jobs_->setModel(jobs_model_);
  jobs_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  jobs_->horizontalHeader()->setSectionResizeMode(JobListModel::Title, QHeaderView::Stretch);
  job_cancel_ = barButton("relax-job-cancel", "process-stop", "Cancel the selected",
                          "Take the selected jobs out of the queue, or stop the one that runs", page);
  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 4, 8, 4);
  bar->addStretch();
  bar->addWidget(job_cancel_);
  layout->addWidget(jobs_, 1);
  layout->addLayout(bar);
  connect(job_cancel_, &QToolButton::clicked, this, [this] {
    std::vector<int> chosen;
    for (const QModelIndex& index : jobs_->selectionModel()->selectedRows())
      chosen.push_back(jobs_model_->jobAt(index.row()));
    for (const int job : chosen) context_.workspace.jobs().cancel(job);
  });
  connect(jobs_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &RelaxationPanel::refreshJobs);
  return page;
}

QWidget* RelaxationPanel::makeLog() {
  log_ = new QPlainTextEdit(this);
  log_->setObjectName("relax-log");
  log_->setAccessibleName("Events of the relaxation");
  log_->setReadOnly(true);
  log_->setFrameShape(QFrame::NoFrame);
  log_->setMaximumBlockCount(5000);
  log_->setPlaceholderText("Every event of every step is written here while a relaxation runs.");
  return log_;
}

void RelaxationPanel::run() {
  JobRequest request;
  request.operation = operations().find("relax");
  request.preset = preset_->currentText();
  request.ask = true;
  request.title = "Relax all scans (" + request.preset + ")";
  const LastParameters last = context_.workspace.preferences().lastParameters("relax");
  if (last.preset == request.preset) request.values = last.values;
  request.values.erase("threads");
  (void)context_.workspace.start(request);
}

void RelaxationPanel::refresh() {
  const Workspace& workspace = context_.workspace;
  const SnapshotPtr snapshot = workspace.snapshot();
  const bool running = relaxation_.isRunning(), paused = relaxation_.isPaused();
  run_->setEnabled(workspace.session().isWritable() && snapshot && snapshot->scans().size() > 1);
  run_->setText(workspace.jobs().busy() ? "Queue" : "Relax");
  pause_->setEnabled(running);
  pause_->setText(paused ? "Go on" : "Pause");
  pause_->setAccessibleName(pause_->text());
  step_->setEnabled(paused);
  cancel_->setEnabled(running);
  const JobStatus* job = relaxation_.job();
  QString state = snapshot && snapshot->scans().size() < 2 ? "There are fewer than two scans to relax."
                                                           : "Nothing runs. Choose a preset and relax.";
  if (running) {
    state = relaxation_.step() > 0 ? QString("Step %1").arg(relaxation_.step()) : "Preparing";
    if (!relaxation_.method().isEmpty()) state += ", " + relaxation_.method();
    if (paused) state += relaxation_.isHolding() ? ": paused" : ": pausing";
    if (!paused && job && job->left_s) state += ", " + durationText(*job->left_s) + " left";
  } else if (relaxation_.isProposal()) {
    state = QString("Done after %1 steps: accept or discard").arg(relaxation_.step());
  } else if (job && job->over()) {
    state = sentence(jobPhaseName(job->phase));
    state += job->phase == JobPhase::Accepted ? QString(" and stored, %1 steps").arg(relaxation_.step())
                                              : "; the project is as it was";
  }
  if (const int queued = workspace.jobs().queued(); queued > 0) state += QString(" (%1 waiting)").arg(queued);
  state_->setText(state);
  state_->setToolTip(state);
  QString doing = relaxation_.doing();
  if (running && doing.isEmpty() && job) doing = job->message;
  doing_->setText(sentence(doing));
  doing_->setToolTip(doing);
  progress_->setVisible(running);
  progress_->setValue(job ? static_cast<int>(1000.0 * job->fraction) : 0);
  decision_->setVisible(relaxation_.isProposal());
  decision_text_->setText("A proposal: nothing is stored yet. Its figures stand over the table.");
  const ProposalCompare compared = workspace.display().proposalCompare();
  before_->setChecked(relaxation_.showsBefore());
  after_->setChecked(!relaxation_.showsBefore() && compared == ProposalCompare::Off);
  wipe_->setChecked(compared == ProposalCompare::Wipe);
  blink_->setChecked(compared == ProposalCompare::Blink);
  for (const int column : {RelaxationTableModel::ErrorBefore, RelaxationTableModel::ErrorAfter})
    table_->setColumnHidden(column, !model_->truthKnown());
  const QString summary = model_->summary();
  summary_->setText(model_->title() + (summary.isEmpty() ? "." : ". " + summary + "."));
  refreshJobs();
}

void RelaxationPanel::refreshJobs() {
  bool any = false;
  for (const QModelIndex& index : jobs_->selectionModel()->selectedRows())
    any |= jobs_model_->phaseAt(index.row()) <= JobPhase::Waiting;
  job_cancel_->setEnabled(any);
  const int waiting = context_.workspace.jobs().queued();
  tabs_->setTabText(2, waiting > 0 ? QString("&Jobs (%1)").arg(waiting) : "&Jobs");
}

void RelaxationPanel::takeSelection() {
  if (following_) return;
  following_ = true;
  std::vector<ScanId> scans;
  for (const QModelIndex& index : table_->selectionModel()->selectedRows())
    scans.push_back(model_->scanAt(index.row()));
  const QModelIndex current = table_->currentIndex();
  context_.workspace.selection().setScans(
      std::move(scans), current.isValid() ? std::optional(model_->scanAt(current.row())) : std::nullopt);
  following_ = false;
}

void RelaxationPanel::showSelection() {
  if (following_) return;
  following_ = true;
  QItemSelection rows;
  for (const ScanId scan : context_.workspace.selection().scans())
    if (const int row = model_->rowOf(scan); row >= 0)
      rows.select(model_->index(row, 0), model_->index(row, model_->columnCount() - 1));
  table_->selectionModel()->select(rows, QItemSelectionModel::ClearAndSelect);
  following_ = false;
}

}  // namespace tiltmap::ui
