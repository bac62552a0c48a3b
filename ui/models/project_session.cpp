#include "ui/models/project_session.h"

#include <QFileInfo>
#include <algorithm>

#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

Error nothingOpen() {
  return {"no project is open", "", "open or make a project first"};
}

}  // namespace

ProjectSession::ProjectSession(QObject* parent) : QObject(parent) {}

ProjectSession::~ProjectSession() = default;

bool ProjectSession::isWritable() const {
  return project_ && project_->access() == Access::ReadWrite;
}

QString ProjectSession::path() const {
  return project_ ? qt(project_->path()) : QString();
}

QString ProjectSession::name() const {
  return project_ ? QFileInfo(path()).completeBaseName() : QString();
}

Status ProjectSession::refused(Error error) {
  Q_EMIT failed(error);
  return fail(std::move(error));
}

Status ProjectSession::adopt(Result<std::unique_ptr<Project>> project, std::optional<Error> why_read_only) {
  if (!project) return refused(project.error());
  if (project_) close();
  project_ = std::move(*project);
  why_read_only_ = std::move(why_read_only);
  snapshot_ = project_->snapshot();
  Q_EMIT opened();
  Q_EMIT snapshotReplaced();
  return {};
}

Status ProjectSession::open(const QString& path) {
  if (project_ && QFileInfo(path) == QFileInfo(this->path())) return {};
  auto writable = Project::open(pathOf(path), Access::ReadWrite);
  if (writable) return adopt(std::move(writable));
  const Error why = writable.error();
  auto readable = Project::open(pathOf(path), Access::ReadOnly);
  // Why it cannot be written tells more than why it cannot be read, unless both fail.
  return readable ? adopt(std::move(readable), why) : refused(why);
}

Status ProjectSession::create(const QString& path) {
  return adopt(Project::create(pathOf(path)));
}

void ProjectSession::close() {
  if (!project_) return;
  Q_EMIT aboutToClose();
  project_.reset();
  snapshot_.reset();
  Q_EMIT closed();
  Q_EMIT snapshotReplaced();
}

Status ProjectSession::saveAs(const QString& path) {
  if (!project_) return refused(nothingOpen());
  return adopt(project_->saveAs(pathOf(path)));
}

Status ProjectSession::saveCopy(const QString& path) {
  if (!project_) return refused(nothingOpen());
  Status status = project_->saveCopy(pathOf(path));
  return status ? status : refused(status.error());
}

Result<CompactReport> ProjectSession::compact() {
  if (!project_) return fail(nothingOpen());
  auto report = project_->compact();
  if (!report) {
    Q_EMIT failed(report.error());
    return report;
  }
  const SnapshotPtr before = snapshot_;
  snapshot_ = project_->snapshot();
  Q_EMIT changed(changeBetween(*before, *snapshot_));
  Q_EMIT snapshotReplaced();
  return report;
}

Status ProjectSession::verify() {
  if (!project_) return refused(nothingOpen());
  Status status = project_->verify();
  return status ? status : refused(status.error());
}

Status ProjectSession::refresh() {
  if (!project_) return refused(nothingOpen());
  const auto any = project_->refresh();
  if (!any) return refused(any.error());
  if (!*any) return {};
  const SnapshotPtr before = snapshot_;
  snapshot_ = project_->snapshot();
  Q_EMIT changed(changeBetween(*before, *snapshot_));
  Q_EMIT snapshotReplaced();
  return {};
}

Status ProjectSession::settle(const Result<Change>& change) {
  if (!change) return refused(change.error());
  const SnapshotPtr before = snapshot_;
  snapshot_ = project_->snapshot();
  if (snapshot_ == before) return {};  // an edit that changed nothing
  Q_EMIT changed(*change);
  Q_EMIT snapshotReplaced();
  return {};
}

Status ProjectSession::apply(const ProjectEdit& edit) {
  return project_ ? settle(project_->apply(edit)) : refused(nothingOpen());
}

void ProjectSession::serve(Job& job) {
  if (!project_ || !job.serve(*project_)) return;
  const SnapshotPtr before = snapshot_;
  snapshot_ = project_->snapshot();
  if (snapshot_ == before) return;
  Q_EMIT changed(changeBetween(*before, *snapshot_));
  Q_EMIT snapshotReplaced();
}

Status ProjectSession::accept(Job& job) {
  return project_ ? settle(job.accept(*project_)) : refused(nothingOpen());
}

Status ProjectSession::undo() {
  return project_ ? settle(project_->undo()) : refused(nothingOpen());
}

Status ProjectSession::redo() {
  return project_ ? settle(project_->redo()) : refused(nothingOpen());
}

Status ProjectSession::goTo(int done) {
  if (!project_) return refused(nothingOpen());
  const auto inEffect = [this] {
    return static_cast<int>(
        std::ranges::count(snapshot_->history(), false, [](const HistoryEntry& e) { return e.undone; }));
  };
  while (inEffect() > done)
    if (Status status = undo(); !status) return status;
  while (inEffect() < done)
    if (Status status = redo(); !status) return status;
  return {};
}

QString ProjectSession::undoTitle() const {
  if (!canUndo()) return {};
  const auto& history = snapshot_->history();
  const auto last = std::find_if(history.rbegin(), history.rend(), [](const auto& e) { return !e.undone; });
  return last == history.rend() ? QString() : qt(last->title);
}

QString ProjectSession::redoTitle() const {
  if (!canRedo()) return {};
  const auto& history = snapshot_->history();
  const auto next = std::ranges::find_if(history, [](const auto& e) { return e.undone; });
  return next == history.end() ? QString() : qt(next->title);
}

}  // namespace tiltmap::ui
