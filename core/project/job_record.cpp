#include "core/project/job_record.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

#include <nlohmann/json.hpp>

namespace tiltmap {

std::string utcNow() {
  const auto now = std::chrono::system_clock::now();
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(
                                now - std::chrono::system_clock::from_time_t(seconds))
                                .count();
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 40> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ", static_cast<int>(milliseconds));
  return text.data();
}

std::string parametersToJson(const ParameterValues& values) {
  nlohmann::json object = nlohmann::json::object();
  for (const auto& [name, value] : values)
    std::visit([&object, &key = name](const auto& v) { object[key] = v; }, value);
  // Text that is not UTF-8 (a file's name may be anything) must not end the program.
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Result<ParameterValues> parametersFromJson(const std::string& json) {
  const auto object = nlohmann::json::parse(json, nullptr, false);
  if (!object.is_object())
    return fail("the parameters are not a JSON object", "", "give an object of names and values");
  ParameterValues values;
  for (const auto& [name, value] : object.items()) {
    if (value.is_boolean()) {
      values[name] = value.get<bool>();
    } else if (value.is_number_integer()) {
      values[name] = value.get<long long>();
    } else if (value.is_number()) {
      values[name] = value.get<double>();
    } else if (value.is_string()) {
      values[name] = value.get<std::string>();
    } else {
      return fail("parameter " + name + " is neither number, text, true nor false", "", "give one of these");
    }
  }
  return values;
}

}  // namespace tiltmap
