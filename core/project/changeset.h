// What an edit did to the rows of the recorded tables, as bytes that can be undone and redone.
#pragma once

#include <vector>

#include "core/project/database.h"

namespace tiltmap {

// SQLite's own changeset format (the session extension): rows before and after, values bit for bit.
using Changeset = std::vector<unsigned char>;

// Records from its making on; inside one transaction.
class ChangeRecorder {
 public:
  explicit ChangeRecorder(const Database& database);
  ~ChangeRecorder();
  ChangeRecorder(const ChangeRecorder&) = delete;
  ChangeRecorder& operator=(const ChangeRecorder&) = delete;
  // Everything so far; empty where the rows are what they were.
  Changeset changes() const;

 private:
  const Database& database_;
  void* session_ = nullptr;
};

enum class Direction { Back, Forth };

// Takes the recorded rows back to what they were, or forth again. Fails, with the rows untouched once the
// caller's transaction is rolled back, where a row is not what the record expects.
void replay(const Database& database, const Changeset& changeset, Direction direction);

}  // namespace tiltmap
