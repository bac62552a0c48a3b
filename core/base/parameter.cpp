#include "core/base/parameter.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap {

std::string parameterKindName(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::Boolean:
      return "boolean";
    case ParameterKind::Integer:
      return "integer";
    case ParameterKind::Real:
      return "real";
    case ParameterKind::Choice:
      return "choice";
    case ParameterKind::Text:
      return "text";
  }
  throw std::logic_error("parameterKindName: no such kind");
}

std::string parameterText(const ParameterValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const long long* number = std::get_if<long long>(&value)) return std::to_string(*number);
  if (const double* number = std::get_if<double>(&value)) {
    // Degrees that were radians inside come back as 19.999999999999996; ten digits say what was meant.
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.10g", *number);
    return buffer;
  }
  return std::get<std::string>(value);
}

namespace {

std::string rangeText(const ParameterInfo& info) {
  const std::string unit = info.unit.empty() ? "" : " " + info.unit;
  if (info.kind == ParameterKind::Choice) return "one of " + joined(info.choices, ", ");
  if (info.kind == ParameterKind::Boolean) return "true or false";
  const std::string noun = info.kind == ParameterKind::Integer ? "a whole number" : "a number";
  if (info.minimum && info.maximum)
    return noun + " from " + parameterText(*info.minimum) + " to " + parameterText(*info.maximum) + unit;
  return noun + unit;
}

// Degrees that were radians inside may come back a hair beyond the end of their range: the end is meant.
double withoutRounding(const ParameterInfo& info, double number) {
  for (const auto& end : {info.minimum, info.maximum})
    if (end && std::abs(number - *end) <= 1e-12 * std::abs(*end)) return *end;
  return number;
}

tl::unexpected<Error> refused(const ParameterInfo& info, const std::string& text) {
  return fail("\"" + text + "\" is not allowed for parameter " + info.name, "--" + info.name,
              "give " + rangeText(info));
}

}  // namespace

Result<ParameterValue> checkParameter(const ParameterInfo& info, const ParameterValue& value) {
  const auto inRange = [&](double number) {
    return std::isfinite(number) && (!info.minimum || number >= *info.minimum) &&
           (!info.maximum || number <= *info.maximum);
  };
  switch (info.kind) {
    case ParameterKind::Boolean:
      if (std::holds_alternative<bool>(value)) return value;
      break;
    case ParameterKind::Integer:
      if (const auto* number = std::get_if<long long>(&value);
          number && inRange(static_cast<double>(*number)))
        return value;
      break;
    case ParameterKind::Real: {
      const auto* whole = std::get_if<long long>(&value);
      const auto* real = std::get_if<double>(&value);
      if (!whole && !real) break;
      const double number = withoutRounding(info, whole ? static_cast<double>(*whole) : *real);
      if (inRange(number)) return ParameterValue(number);
      break;
    }
    case ParameterKind::Choice:
      if (const auto* word = std::get_if<std::string>(&value))
        for (const std::string& choice : info.choices)
          if (choice == *word) return value;
      break;
    case ParameterKind::Text:
      if (std::holds_alternative<std::string>(value)) return value;
      break;
  }
  return refused(info, parameterText(value));
}

Result<ParameterValue> parseParameter(const ParameterInfo& info, const std::string& text) {
  switch (info.kind) {
    case ParameterKind::Boolean:
      if (text == "true" || text == "yes" || text == "on" || text == "1") return ParameterValue(true);
      if (text == "false" || text == "no" || text == "off" || text == "0") return ParameterValue(false);
      break;
    case ParameterKind::Integer:
      if (const auto number = parseInteger(text)) return checkParameter(info, ParameterValue(*number));
      break;
    case ParameterKind::Real:
      if (const auto number = parseReal(text)) return checkParameter(info, ParameterValue(*number));
      break;
    case ParameterKind::Choice:
    case ParameterKind::Text:
      return checkParameter(info, ParameterValue(text));
  }
  return refused(info, text);
}

Error unknownParameter(const std::string& name, const std::vector<std::string>& known,
                       const std::string& operation) {
  const auto nearest = nearestName(name, known);
  return {"there is no parameter \"" + name + "\"", "operation " + operation,
          (nearest ? "did you mean " + *nearest + "? " : std::string()) + "`tiltmap parameters " + operation +
              "` lists them all"};
}

}  // namespace tiltmap
