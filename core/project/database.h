// A thin layer over SQLite, for core/project only: connections, statements, transactions.
//
// Inside the project's store a failure travels as StoreFailure, because nearly every line of it can fail in
// the same few ways; the public functions of Project turn it into a Result (attempt() below) and nothing else
// sees it.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace tiltmap {

class StoreFailure : public std::exception {
 public:
  explicit StoreFailure(Error error) : error_(std::move(error)) {}
  StoreFailure(std::string what, std::string where, std::string remedy)
      : error_{std::move(what), std::move(where), std::move(remedy)} {}
  const char* what() const noexcept override { return error_.what.c_str(); }
  const Error& error() const { return error_; }

 private:
  Error error_;
};

// Runs the function, its result or the failure it threw as a Result.
template <class Function>
auto attempt(Function&& function) -> Result<std::invoke_result_t<Function>> {
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<Function>>) {
      function();
      return {};
    } else {
      return function();
    }
  } catch (const StoreFailure& failure) {
    return fail(failure.error());
  }
}

// The value of a Result, or its error thrown on.
template <class T>
T orThrow(Result<T> result) {
  if (!result) throw StoreFailure(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

using Bytes = std::span<const unsigned char>;

template <class T>
Bytes bytesOf(const T* first, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const unsigned char*>(first), count * sizeof(T)};
}

// A prepared statement. Parameters count from 1, columns from 0.
class Statement {
 public:
  Statement(sqlite3* database, const std::filesystem::path& path, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Binds all parameters, from the first on.
  template <class... Values>
  Statement& bind(const Values&... values) {
    reset();
    int index = 0;
    (bindOne(++index, values), ...);
    return *this;
  }
  // True while there is a row.
  bool step();
  // bind and step to the end.
  template <class... Values>
  void run(const Values&... values) {
    bind(values...);
    while (step()) {
    }
    reset();
  }

  bool isNull(int column) const;
  std::int64_t integer(int column) const;
  int number(int column) const;  // an int; a value that does not fit means damage
  double real(int column) const;
  std::string text(int column) const;
  Bytes blob(int column) const;  // valid until the next step

 private:
  void reset();
  void check(int code) const;
  void bindNull(int index);
  void bindInteger(int index, std::int64_t value);
  void bindReal(int index, double value);
  void bindText(int index, std::string_view value);
  void bindBlob(int index, Bytes value);

  template <std::integral T>
  void bindOne(int index, T value) {
    bindInteger(index, static_cast<std::int64_t>(value));
  }
  // SQLite has no NaN; NULL stands for it.
  void bindOne(int index, double value) { std::isnan(value) ? bindNull(index) : bindReal(index, value); }
  void bindOne(int index, std::string_view value) { bindText(index, value); }
  void bindOne(int index, const std::string& value) { bindText(index, value); }
  void bindOne(int index, const char* value) { bindText(index, value); }
  void bindOne(int index, Bytes value) { bindBlob(index, value); }
  template <class T>
  void bindOne(int index, const std::optional<T>& value) {
    value ? bindOne(index, *value) : bindNull(index);
  }

  sqlite3* database_;
  const std::filesystem::path& path_;
  sqlite3_stmt* statement_ = nullptr;
};

class Database {
 public:
  enum class Mode {
    Create,     // a new file
    Write,      // the one writer
    Read,       // never writes rows; may take part in SQLite's own housekeeping
    ReadOnly,   // touches nothing; needs the writer's shared memory where there is a log
    Immutable,  // touches nothing, looks for no log and no locks: for media that cannot be written
  };
  Database(std::filesystem::path path, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  const std::filesystem::path& path() const { return path_; }
  sqlite3* handle() const { return database_; }
  Statement prepare(std::string_view sql) const { return Statement(database_, path_, sql); }
  void execute(const std::string& sql) const;  // one or several statements
  template <class... Values>
  void run(std::string_view sql, const Values&... values) const {
    prepare(sql).run(values...);
  }
  // The first column of the first row.
  template <class... Values>
  std::optional<std::int64_t> integer(std::string_view sql, const Values&... values) const {
    Statement statement = prepare(sql);
    if (!statement.bind(values...).step() || statement.isNull(0)) return std::nullopt;
    return statement.integer(0);
  }
  std::int64_t lastInsertId() const;
  bool isReadOnly() const;

 private:
  std::filesystem::path path_;
  sqlite3* database_ = nullptr;
};

// What the connection's last call failed with, in words for the user.
Error sqliteError(const Database& database, int code);

// Rolled back unless committed.
class Transaction {
 public:
  enum class Kind { Read, Write };
  Transaction(const Database& database, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace tiltmap
