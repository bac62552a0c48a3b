// What an operation gives back when it may fail in an expected way.
//
// Three kinds of failure (CONTRIBUTING.md): a broken contract throws std::logic_error; an expected failure is
// a Result that holds an Error; an imperfect success carries warnings beside its value. Never identity, an
// empty cloud or NaN to mean failure.
#pragma once

#include <string>

#include <tl/expected.hpp>

namespace tiltmap {

// An expected failure, in words for the person at the screen.
struct Error {
  std::string what;    // what happened: "the file ends in the middle of line 12"
  std::string where;   // file, line, record, scan or parameter it happened at; may be empty
  std::string remedy;  // what the user can do about it

  bool operator==(const Error&) const = default;
};

template <class T>
using Result = tl::expected<T, Error>;

using Status = Result<void>;

// Shorthand: `return fail("...", "...", "...");` in a function that returns a Result.
inline tl::unexpected<Error> fail(std::string what, std::string where, std::string remedy) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(remedy)});
}
inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

}  // namespace tiltmap
