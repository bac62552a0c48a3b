#include "core/project/database.h"

#include <cctype>
#include <limits>

#include <sqlite3.h>

namespace tiltmap {

namespace {

// SQLite's codes in words for the person at the screen.
Error described(int code, const std::string& message, const std::filesystem::path& path) {
  const std::string where = path.string();
  switch (code & 0xff) {
    case SQLITE_FULL:
      return {"the disk is full", where, "make room and repeat the command; the project is as it was before"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {"the project is busy in another process", where,
              "wait until that is done and repeat the command"};
    case SQLITE_NOTADB:
      return {"the file is not a Tiltmap project", where, "give the path of a .tiltmap file"};
    case SQLITE_CORRUPT:
      return {"the project file is damaged (" + message + ")", where,
              "go back to a copy of it; keep this file, parts of it may be recovered with `sqlite3 FILE "
              ".recover`"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {"the project cannot be written", where,
              "copy it to a folder where you may write, or make it writable"};
    case SQLITE_CANTOPEN:
      return {"the project cannot be opened (" + message + ")", where,
              "check the path and your permissions for the file and its folder"};
    case SQLITE_IOERR:
      return {"reading or writing the project failed (" + message + ")", where,
              "check the disk; what had been stored before is still in the file"};
    case SQLITE_NOMEM:
      return {"there is not enough memory", where, "close other programs and repeat the command"};
    case SQLITE_TOOBIG:
      return {"a single entry is larger than a project can hold", where,
              "leave it out, or keep it outside the project"};
    default:
      return {"the project's database refused: " + message, where, "please report this as a defect"};
  }
}

[[noreturn]] void raise(sqlite3* database, int code, const std::filesystem::path& path) {
  throw StoreFailure(described(code, database ? sqlite3_errmsg(database) : sqlite3_errstr(code), path));
}

// A path as the body of a file: URI.
std::string uriPath(const std::filesystem::path& path) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string text;
  for (const char c : std::filesystem::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '/' || c == '-' || c == '_' || c == '.' || c == '~') {
      text += c;
    } else {
      text += '%';
      text += kHex[byte >> 4];
      text += kHex[byte & 15];
    }
  }
  return text;
}

}  // namespace

Statement::Statement(sqlite3* database, const std::filesystem::path& path, std::string_view sql)
    : database_(database), path_(path) {
  check(sqlite3_prepare_v2(database, sql.data(), static_cast<int>(sql.size()), &statement_, nullptr));
}
Statement::~Statement() {
  sqlite3_finalize(statement_);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) raise(database_, code, path_);
}
void Statement::reset() {
  sqlite3_reset(statement_);  // repeats the error of the last step, which has been raised already
  sqlite3_clear_bindings(statement_);
}
bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  raise(database_, code, path_);
}

void Statement::bindNull(int index) {
  check(sqlite3_bind_null(statement_, index));
}
void Statement::bindInteger(int index, std::int64_t value) {
  check(sqlite3_bind_int64(statement_, index, value));
}
void Statement::bindReal(int index, double value) {
  check(sqlite3_bind_double(statement_, index, value));
}
void Statement::bindText(int index, std::string_view value) {
  check(sqlite3_bind_text64(statement_, index, value.data() ? value.data() : "", value.size(),
                            SQLITE_TRANSIENT, SQLITE_UTF8));
}
void Statement::bindBlob(int index, Bytes value) {
  // A null pointer would bind NULL; an empty blob is not that.
  if (value.empty()) return check(sqlite3_bind_zeroblob(statement_, index, 0));
  check(sqlite3_bind_blob64(statement_, index, value.data(), value.size(), SQLITE_TRANSIENT));
}

bool Statement::isNull(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}
std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}
int Statement::number(int column) const {
  const std::int64_t value = integer(column);
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max())
    throw StoreFailure(described(SQLITE_CORRUPT, "a number is out of range", path_));
  return static_cast<int>(value);
}
double Statement::real(int column) const {
  return isNull(column) ? std::numeric_limits<double>::quiet_NaN()
                        : sqlite3_column_double(statement_, column);
}
std::string Statement::text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text ? std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
              : std::string();
}
Bytes Statement::blob(int column) const {
  const auto* data = static_cast<const unsigned char*>(sqlite3_column_blob(statement_, column));
  const int size = sqlite3_column_bytes(statement_, column);
  return data ? Bytes(data, static_cast<std::size_t>(size)) : Bytes();
}

Database::Database(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
  int flags = SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_EXRESCODE;
  std::string name = path_.string();
  switch (mode) {
    case Mode::Create:
      flags |= SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
      break;
    case Mode::Write:
    case Mode::Read:
      flags |= SQLITE_OPEN_READWRITE;
      break;
    case Mode::ReadOnly:
      flags |= SQLITE_OPEN_READONLY;
      break;
    case Mode::Immutable:
      flags |= SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
      name = "file:" + uriPath(path_) + "?immutable=1";
      break;
  }
  const int code = sqlite3_open_v2(name.c_str(), &database_, flags, nullptr);
  if (code != SQLITE_OK) {
    const std::string message = database_ ? sqlite3_errmsg(database_) : sqlite3_errstr(code);
    sqlite3_close(database_);
    throw StoreFailure(described(code, message, path_));
  }
  try {
    sqlite3_busy_timeout(database_, 10'000);
    // A file from elsewhere may carry views and triggers; they get no power here.
    execute("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA foreign_keys = ON");
    // Never less than FULL: a stored edit survives the loss of power.
    execute("PRAGMA synchronous = FULL");
    if (mode == Mode::Read) execute("PRAGMA query_only = ON");
  } catch (...) {
    sqlite3_close(database_);
    throw;
  }
}
Database::~Database() {
  sqlite3_close(database_);
}

void Database::execute(const std::string& sql) const {
  const int code = sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) raise(database_, code, path_);
}
std::int64_t Database::lastInsertId() const {
  return sqlite3_last_insert_rowid(database_);
}
bool Database::isReadOnly() const {
  return sqlite3_db_readonly(database_, "main") == 1;
}

Error sqliteError(const Database& database, int code) {
  return described(code, sqlite3_errmsg(database.handle()), database.path());
}

Transaction::Transaction(const Database& database, Kind kind) : database_(database) {
  database_.execute(kind == Kind::Write ? "BEGIN IMMEDIATE" : "BEGIN");
}
Transaction::~Transaction() {
  // SQLite may have rolled back by itself (full disk); a second time is then an error that means nothing.
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}
void Transaction::commit() {
  database_.execute("COMMIT");
  open_ = false;
}

}  // namespace tiltmap
