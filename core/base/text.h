// Small text helpers that readers, parameters and the command line share.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tiltmap {

// The whole of `text` as a number, or nothing: no trailing characters, no locale, no hexadecimal.
// parseReal takes "nan" and "inf" too; whether they make sense is the caller's business.
std::optional<double> parseReal(std::string_view text);
std::optional<long long> parseInteger(std::string_view text);

std::string_view trimmed(std::string_view text);
std::vector<std::string_view> splitWords(std::string_view text);               // at blanks and tabs
std::vector<std::string_view> splitAt(std::string_view text, char separator);  // keeps empty parts
std::string joined(const std::vector<std::string>& parts, std::string_view separator);

// The candidate with the smallest Levenshtein distance to `word`, where that is at most a third of the longer
// length and at least one; nothing when none is near.
std::optional<std::string> nearestName(std::string_view word, const std::vector<std::string>& candidates);

// printf-style shortest text of a number that reads back as the same double.
std::string shortestReal(double value);
// With so many places after the point, whatever the locale; never "-0.00".
std::string fixedReal(double value, int places);
std::string groupedInteger(long long value);  // "1,234,567"

// The letters of a UTF-8 text; every byte that belongs to none becomes U+FFFD, so that foreign text cannot
// break what is written from it.
std::vector<char32_t> codePointsOf(std::string_view utf8);
std::string utf8Of(char32_t code_point);

// A quoted excerpt of foreign bytes that is safe to print: control characters escaped, cut at `length`.
std::string printable(std::string_view bytes, std::size_t length = 40);

}  // namespace tiltmap
