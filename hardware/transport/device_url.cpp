#include "hardware/transport/device_url.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "hardware/transport/channel_opener.h"

namespace tiltmap {

namespace {

std::vector<std::string> schemeNames(const std::vector<DeviceScheme>& known) {
  std::vector<std::string> names;
  for (const DeviceScheme& scheme : known) names.push_back(scheme.name);
  return names;
}

std::string examples(const std::vector<DeviceScheme>& known) {
  std::vector<std::string> texts;
  for (const DeviceScheme& scheme : known) texts.push_back(scheme.example);
  return joined(texts, " or ");
}

Status addOption(DeviceUrl& url, std::string_view part, const DeviceScheme& scheme,
                 const std::string& whole) {
  std::vector<std::string> names = scheme.options;
  if (scheme.has_port) names.insert(names.end(), {"baud", "log", "speed"});
  const auto equals = part.find('=');
  const std::string name(part.substr(0, equals));
  const std::string list = names.empty() ? "there are none" : "there are " + joined(names, ", ");
  if (std::ranges::find(names, name) == names.end()) {
    const auto nearest = nearestName(name, names);
    return fail("`" + name + "` is no option of " + scheme.name, whole,
                (nearest ? "did you mean " + *nearest + "? " : "") + list);
  }
  if (equals == std::string_view::npos || equals + 1 == part.size())
    return fail("the option " + name + " has no value", whole, "write " + name + "=VALUE");
  if (!url.options.emplace(name, part.substr(equals + 1)).second)
    return fail("the option " + name + " is given twice", whole, "leave one of them out");
  return {};
}

}  // namespace

const std::vector<DeviceScheme>& scannerSchemes() {
  static const std::vector<DeviceScheme> known{
      {"lms2xx", true, {"angle", "resolution", "unit", "latency"}, "lms2xx:/dev/ttyUSB0?baud=38400"},
      {"lms1xx", true, {"resolution", "frequency", "latency"}, "lms1xx:192.168.0.1", 2111},
      {"urg", true, {"intensity", "latency"}, "urg:/dev/ttyACM0", 0, 10940}};
  return known;
}

const std::vector<DeviceScheme>& tiltSchemes() {
  static const std::vector<DeviceScheme> known{
      {"mip50",
       true,
       {"profile", "axis", "level", "counts", "min", "max", "velocity", "acceleration"},
       "mip50:/dev/ttyUSB1?baud=19200"},
      {"epos",
       true,
       {"protocol", "node", "home", "encoder", "level", "counts", "min", "max"},
       "epos:/dev/ttyUSB1?level=312525"},
      {"manual", false, {"min", "max"}, "manual:"}};
  return known;
}

std::string DeviceUrl::text() const {
  std::string result = scheme + ":" + port;
  char separator = '?';
  for (const auto& [name, value] : options) {
    result += separator + name + "=" + value;
    separator = '&';
  }
  return result;
}

std::optional<std::string> DeviceUrl::option(const std::string& name) const {
  const auto found = options.find(name);
  return found == options.end() ? std::nullopt : std::optional(found->second);
}

Result<std::optional<double>> DeviceUrl::number(const std::string& name, double low, double high) const {
  const auto given = option(name);
  if (!given) return std::nullopt;
  const auto value = parseReal(*given);
  if (!value || !(*value >= low && *value <= high))
    return fail(name + "=" + *given + " is no number from " + shortestReal(low) + " to " + shortestReal(high),
                text(), "give one");
  return value;
}

Result<std::optional<int>> DeviceUrl::integer(const std::string& name, int low, int high) const {
  const auto value = number(name, low, high);
  if (!value) return fail(value.error());
  if (!*value) return std::nullopt;
  if (std::floor(**value) != **value)
    return fail(name + "=" + *option(name) + " is no whole number", text(), "give one");
  return static_cast<int>(**value);
}

Result<DeviceUrl> parseDeviceUrl(std::string_view text, const std::vector<DeviceScheme>& known) {
  const std::string whole(text);
  const auto colon = text.find(':');
  if (colon == std::string_view::npos)
    return fail("there is no colon, so the kind of instrument is missing", whole, "write " + examples(known));
  DeviceUrl url;
  url.scheme = std::string(text.substr(0, colon));
  const auto scheme = std::ranges::find(known, url.scheme, &DeviceScheme::name);
  if (scheme == known.end()) {
    const auto names = schemeNames(known);
    const auto nearest = nearestName(url.scheme, names);
    return fail("`" + url.scheme + "` is no kind of instrument for this", whole,
                (nearest ? "did you mean " + *nearest + ":? " : "") + "write " + examples(known));
  }
  url.tcp_port = scheme->tcp_port;
  url.usual_port = scheme->usual_port;
  text.remove_prefix(colon + 1);
  const auto question = text.rfind('?');
  url.port = std::string(text.substr(0, question));
  if (scheme->has_port && url.port.empty())
    return fail("the port is missing", whole, "write " + scheme->example + "; `tiltmap devices` lists ports");
  if (!scheme->has_port && !url.port.empty())
    return fail(url.scheme + ": takes no port", whole, "write " + scheme->example);
  if (question == std::string_view::npos) return url;
  for (const std::string_view part : splitAt(text.substr(question + 1), '&'))
    if (const auto added = addOption(url, part, *scheme, whole); !added) return fail(added.error());
  return url;
}

Result<std::unique_ptr<ByteChannel>> openChannel(const DeviceUrl& url, int baud, RealClock& clock) {
  return ChannelOpener(url, baud, clock).open();
}

}  // namespace tiltmap
