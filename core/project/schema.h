// The tables of a project file and how older files come up to them.
#pragma once

#include <span>

#include "core/project/database.h"

namespace tiltmap {

inline constexpr int kApplicationId = 0x54494C54;  // "TILT", bytes 68 to 71 of the file
inline constexpr int kPageSize = 16384;  // seven 361-cell lines a page; 4096 would hold one and waste half

// From version k to k + 1 for the k-th of them; the first makes the tables of an empty file. Changes recorded
// for undo hold values by column position: a migration may append columns to a recorded table; one that does
// anything else to it must empty the journal.
using Migration = const char*;
std::span<const Migration> migrations();
inline int schemaVersion() {
  return static_cast<int>(migrations().size());
}

// Brings the file to the last of the given versions, all steps or none. Fails for a newer one.
void migrate(const Database& database, std::span<const Migration> steps = migrations());
int storedSchemaVersion(const Database& database);
// The error for a file of a version this program does not know.
StoreFailure newerVersion(const std::filesystem::path& path, int version);

// The tables whose rows are recorded for undo. The others hold what never changes once written (matrices,
// lines, geometries, attachments) or is not part of the survey (project, edit).
std::span<const char* const> recordedTables();

}  // namespace tiltmap
