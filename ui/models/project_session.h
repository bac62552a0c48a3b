// The open project of one window: its only writer, and the place where everyone hears of changes.
#pragma once

#include <QObject>
#include <QString>
#include <memory>
#include <optional>

#include "core/project/job.h"
#include "core/project/project.h"

namespace tiltmap::ui {

// Lives on the window's thread. Whatever fails leaves project and snapshot as they were; the error is
// returned and also told by failed(), so that callers with nothing to add may ignore it.
class ProjectSession : public QObject {
  Q_OBJECT

 public:
  explicit ProjectSession(QObject* parent = nullptr);
  ~ProjectSession() override;

  bool isOpen() const { return project_ != nullptr; }
  bool isWritable() const;
  // Of a project that is open for reading: why it is not for writing.
  const std::optional<Error>& whyReadOnly() const { return why_read_only_; }
  QString path() const;
  QString name() const;  // "demo", without folder and extension; empty with no project
  SnapshotPtr snapshot() const { return snapshot_; }  // nothing with no project

  // These close what was open before, once the new one is there. A project that another program writes, or
  // that lies where nothing can be written, is opened for reading, and opened() says so by isWritable().
  Status open(const QString& path);
  Status create(const QString& path);
  void close();
  // Writes the whole project elsewhere and goes on in the copy.
  Status saveAs(const QString& path);
  // Writes the whole project elsewhere and goes on in this one.
  Status saveCopy(const QString& path);
  Result<CompactReport> compact();
  Status verify();
  // For a project opened for reading: what its writer has stored since.
  Status refresh();

  Status apply(const ProjectEdit& edit);
  // Stores what a running job has asked for (Job::serve).
  void serve(Job& job);
  // Stores what a finished job found.
  Status accept(Job& job);
  Status undo();
  Status redo();
  // Undoes or redoes until `done` entries of the history are in effect.
  Status goTo(int done);
  bool canUndo() const { return isWritable() && snapshot_->canUndo(); }
  bool canRedo() const { return isWritable() && snapshot_->canRedo(); }
  QString undoTitle() const;  // what undo() would take back; empty where nothing
  QString redoTitle() const;

 Q_SIGNALS:
  void aboutToClose();  // the project is still there
  void opened();
  void closed();
  void changed(const tiltmap::Change& change);  // by an edit, undo or redo; snapshot() is the new one
  // After each of opened, closed and changed: for those who just read everything again.
  void snapshotReplaced();
  void failed(const tiltmap::Error& error);

 private:
  Status adopt(Result<std::unique_ptr<Project>> project, std::optional<Error> why_read_only = {});
  Status refused(Error error);
  Status settle(const Result<Change>& change);

  std::unique_ptr<Project> project_;
  SnapshotPtr snapshot_;
  std::optional<Error> why_read_only_;
};

}  // namespace tiltmap::ui
