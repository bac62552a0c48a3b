#include "ui/window/job_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>

#include "ui/models/project_words.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

// A label that gives way instead of making the window wide.
QLabel* yieldingLabel(const QString& name, QWidget* parent) {
  auto* label = new QLabel(parent);
  label->setObjectName(name);
  label->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  return label;
}

}  // namespace

JobBar::JobBar(Workspace& workspace, QWidget* parent)
    : QFrame(parent),
      workspace_(workspace),
      title_(new QLabel(this)),
      progress_(new QProgressBar(this)),
      message_(yieldingLabel("job-message", this)),
      accept_(new QPushButton("Accept", this)),
      cancel_(new QPushButton("Cancel", this)),
      project_(new QLabel(this)) {
  setObjectName("job-bar");
  setAccessibleName("Work in progress");
  title_->setObjectName("job-title");
  progress_->setObjectName("job-progress");
  progress_->setAccessibleName("Progress of the work");
  progress_->setFixedWidth(160);
  progress_->setMaximumHeight(fontMetrics().height() + 2);
  accept_->setObjectName("job-accept");
  accept_->setToolTip("Store the result in the project; undo takes it back");
  cancel_->setObjectName("job-cancel");
  cancel_->setToolTip("Stop the work; the project stays as it is (Ctrl+.)");
  project_->setObjectName("project-summary");
  project_->setToolTip("What the project holds");
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(12, 4, 12, 4);
  layout->setSpacing(8);
  layout->addWidget(title_);
  layout->addWidget(progress_);
  layout->addWidget(message_, 1);
  layout->addWidget(accept_);
  layout->addWidget(cancel_);
  layout->addWidget(project_);

  const auto stop = [this] {
    if (const JobStatus* job = workspace_.jobs().current()) workspace_.jobs().cancel(job->id);
  };
  connect(cancel_, &QPushButton::clicked, this, stop);
  connect(accept_, &QPushButton::clicked, this, [this] {
    if (const JobStatus* job = workspace_.jobs().current()) workspace_.jobs().accept(job->id);
  });
  connect(&workspace.jobs(), &JobQueue::changed, this, &JobBar::refresh);
  connect(&workspace.jobs(), &JobQueue::busyChanged, this, &JobBar::refresh);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &JobBar::refreshProject);
  refresh();
  refreshProject();
}

void JobBar::refresh() {
  const JobStatus* job = workspace_.jobs().current();
  for (QWidget* widget :
       {static_cast<QWidget*>(title_), static_cast<QWidget*>(progress_), static_cast<QWidget*>(cancel_)})
    widget->setVisible(job);
  accept_->setVisible(job && job->phase == JobPhase::Waiting);
  cancel_->setText(job && job->phase == JobPhase::Waiting ? "Discard" : "Cancel");
  if (!job) {
    message_->setText({});
    return;
  }
  title_->setText(job->title);
  progress_->setRange(0, job->fraction < 0.0 ? 0 : 1000);
  progress_->setValue(job->fraction < 0.0 ? 0 : static_cast<int>(job->fraction * 1000.0));
  QString text = job->message;
  if (job->left_s) text += QString(text.isEmpty() ? "" : ", ") + durationText(*job->left_s) + " left";
  if (const int queued = workspace_.jobs().queued(); queued > 0)
    text += QString("  (%1 more waiting)").arg(queued);
  message_->setText(text);
  message_->setToolTip(text);
}

void JobBar::refreshProject() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  project_->setText(snapshot ? projectSummary(*snapshot) : QString());
}

}  // namespace tiltmap::ui
