// The project file NAME.tiltmap, and the one thread that writes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/project/project_edit.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

enum class Access { ReadOnly, ReadWrite };

// One line as the scanner delivers it; vectors of `columns` entries.
struct ScanLine {
  double tilt_rad = 0.0;
  double time_s = 0.0;  // since the Unix epoch, at the end of the line
  std::vector<float> range_m;
  std::vector<CellCode> code;
  std::vector<float> intensity;  // empty, or as wide as the line; the same choice for every line of a scan
};

struct CompactReport {
  std::uintmax_t bytes_before = 0;
  std::uintmax_t bytes_after = 0;
  int matrices_dropped = 0;
};

// One SQLite file. Whatever kills the program or the machine, the file opens again with every edit whose
// apply() had returned (write-ahead log, synchronous=FULL). One writer at a time over all processes; any
// number of readers beside it. The schema is described in resources/manual/project-file.md.
//
// One thread owns a Project; snapshot() alone may be called from any thread, and snapshots outlive the
// project.
class Project {
 public:
  // A new, empty project, open for writing. Refuses a path where something is already.
  static Result<std::unique_ptr<Project>> create(const std::filesystem::path& path);
  // Refuses, without changing them: what is not a project, what a newer program wrote, what is damaged, and,
  // for writing, a project that is being written by another process or lies where nothing can be written.
  static Result<std::unique_ptr<Project>> open(const std::filesystem::path& path, Access access);
  ~Project();
  Project(const Project&) = delete;
  Project& operator=(const Project&) = delete;

  const std::filesystem::path& path() const;
  Access access() const;
  SnapshotPtr snapshot() const;
  // Reads what another process has written since; true when there was anything. A writer never needs it.
  Result<bool> refresh();

  // Stored when it returns. On failure neither file nor snapshot have changed. An empty edit changes nothing.
  Result<Change> apply(const ProjectEdit& edit);
  // One step back or forth in history(); fails when there is none.
  Result<Change> undo();
  Result<Change> redo();
  std::vector<HistoryEntry> history() const;

  // A line of a scan that an edit has started (AddScan without an image): durable when it returns, not an
  // undoable edit of its own, and never overwritten. The snapshot follows.
  Status appendLine(ScanId scan, int row, const ScanLine& line);

  // The whole project, history included, as a new file; refuses a path where something is already. The copy
  // appears under its name when it is complete.
  Status saveCopy(const std::filesystem::path& path) const;
  // The same, and opens the copy for writing.
  Result<std::unique_ptr<Project>> saveAs(const std::filesystem::path& path) const;
  // Drops what only undo needs (deleted scans' matrices among it; history keeps its titles) and gives the
  // space back.
  Result<CompactReport> compact();
  // Reads every page: SQLite's integrity and foreign key checks, then every matrix. The error tells what is
  // damaged.
  Status verify() const;

 private:
  struct State;
  explicit Project(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tiltmap
