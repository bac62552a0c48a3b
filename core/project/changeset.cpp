#include "core/project/changeset.h"

#include <new>

// Debian builds SQLite with the session extension; the header shows it on demand.
#define SQLITE_ENABLE_SESSION 1
#define SQLITE_ENABLE_PREUPDATE_HOOK 1
#include <sqlite3.h>

#include "core/project/schema.h"

namespace tiltmap {

namespace {

void checked(int code, const Database& database) {
  if (code == SQLITE_NOMEM) throw std::bad_alloc();
  if (code != SQLITE_OK) throw StoreFailure(sqliteError(database, code));
}

Changeset taken(int size, void* data) {
  const auto* first = static_cast<const unsigned char*>(data);
  Changeset bytes(first, first + size);
  sqlite3_free(data);
  return bytes;
}

int abortOnConflict(void*, int, sqlite3_changeset_iter*) {
  return SQLITE_CHANGESET_ABORT;
}

}  // namespace

ChangeRecorder::ChangeRecorder(const Database& database) : database_(database) {
  sqlite3_session* session = nullptr;
  checked(sqlite3session_create(database.handle(), "main", &session), database);
  session_ = session;
  for (const char* table : recordedTables()) {
    const int code = sqlite3session_attach(session, table);
    if (code != SQLITE_OK) {
      sqlite3session_delete(session);
      checked(code, database);
    }
  }
}
ChangeRecorder::~ChangeRecorder() {
  sqlite3session_delete(static_cast<sqlite3_session*>(session_));
}

Changeset ChangeRecorder::changes() const {
  int size = 0;
  void* data = nullptr;
  checked(sqlite3session_changeset(static_cast<sqlite3_session*>(session_), &size, &data), database_);
  return taken(size, data);
}

void replay(const Database& database, const Changeset& changeset, Direction direction) {
  Changeset inverted;
  if (direction == Direction::Back) {
    int size = 0;
    void* data = nullptr;
    checked(sqlite3changeset_invert(static_cast<int>(changeset.size()), changeset.data(), &size, &data),
            database);
    inverted = taken(size, data);
  }
  const Changeset& bytes = direction == Direction::Back ? inverted : changeset;
  // The interface takes a pointer to mutable bytes and only reads them.
  const int code =
      sqlite3changeset_apply(database.handle(), static_cast<int>(bytes.size()),
                             const_cast<unsigned char*>(bytes.data()), nullptr, abortOnConflict, nullptr);
  if (code == SQLITE_ABORT)
    throw StoreFailure("the journal does not fit the project's state", database.path().string(),
                       "the project is as it was before; it has been changed by something else than Tiltmap");
  checked(code, database);
}

}  // namespace tiltmap
