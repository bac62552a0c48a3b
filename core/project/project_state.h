// What a Project is made of; for the project's own files.
#pragma once

#include <memory>
#include <mutex>

#include "core/project/image_store.h"
#include "core/project/project.h"
#include "core/project/snapshot_reader.h"

namespace tiltmap {

struct Project::State {
  std::filesystem::path path;
  Access access = Access::ReadOnly;
  // In the order of making; taken down the other way round: the lock goes last.
  std::unique_ptr<WriterLock> lock;
  std::unique_ptr<OpenFileMark> mark;
  std::unique_ptr<Database> writer;  // null for a reader
  std::shared_ptr<ImageStore> images;
  mutable std::mutex snapshot_mutex;
  SnapshotPtr snapshot;

  SnapshotPtr current() const {
    const std::lock_guard guard(snapshot_mutex);
    return snapshot;
  }
  void publish(SnapshotPtr next) {
    const std::lock_guard guard(snapshot_mutex);
    snapshot = std::move(next);
  }
  const Database& requireWriter() const {
    if (!writer)
      throw StoreFailure("the project is open for reading only", path.string(), "open it for writing");
    return *writer;
  }
  // What the writer believes is in the file must be there: a program that goes round the lock is found out
  // here.
  void requireOwnRevision(const Database& database) const {
    if (SnapshotReader::storedRevision(database) != current()->revision())
      throw StoreFailure("the project has been changed by another program", path.string(), "open it again");
  }
};

}  // namespace tiltmap
