// Parameters described once. Command line flag, form, project file, manual and report all come from here.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace tiltmap {

enum class ParameterKind { Boolean, Integer, Real, Choice, Text };

using ParameterValue = std::variant<bool, long long, double, std::string>;
using ParameterValues = std::map<std::string, ParameterValue>;

// One parameter, as a person sees it. Units are those of the edge (m, deg, mm), named in `unit`; the settings
// structure behind it holds SI.
struct ParameterInfo {
  std::string name;  // kebab-case; the flag is --name
  std::string help;  // one sentence: what it does, and when it hurts
  std::string unit;  // "m", "deg", ...; empty for a pure number
  ParameterKind kind = ParameterKind::Real;
  std::optional<double> minimum;     // allowed range, both ends included
  std::optional<double> maximum;
  std::vector<std::string> choices;  // for Choice
  std::string source;                // "thesis 4.2.2.1", "Zhang 1994", "ours: ..."
  ParameterValue default_value;      // read from a default-made settings structure, never written twice
};

std::string parameterKindName(ParameterKind kind);
std::string parameterText(const ParameterValue& value);
// Text (a flag's argument) to a value of the parameter's kind, its range checked.
Result<ParameterValue> parseParameter(const ParameterInfo& info, const std::string& text);
// A value's kind (an integer is welcome where a real is asked for), choice and range checked.
Result<ParameterValue> checkParameter(const ParameterInfo& info, const ParameterValue& value);
// The error for a name that no parameter has; it names the nearest.
Error unknownParameter(const std::string& name, const std::vector<std::string>& known, const std::string& operation);

// A named set of values that differs from the defaults.
struct ParameterPreset {
  std::string name;
  std::string help;
};

// Ties the descriptions to the members of a plain settings structure. Built once per structure; a name described
// twice and a default outside its own range throw std::logic_error then.
//
//   static const ParameterTable<Settings> table = [] {
//     ParameterTable<Settings> t("register");
//     t.real("max-distance", &Settings::max_distance_m, "m", 0.01, 100, "Pairs further apart ...", "thesis 4.2.4");
//     t.angle("max-angle", &Settings::max_angle_rad, 0, 90, "...", "...");    // degrees outside, radians inside
//     t.choice("motion", &Settings::motion, {{"svd", Motion::Svd}, ...}, "...", "...");
//     t.preset("thesis", "the method as printed", thesisSettings());
//     return t;
//   }();
template <class Settings>
class ParameterTable {
 public:
  explicit ParameterTable(std::string operation) : operation_(std::move(operation)) {
    presets_.push_back({{"default", "what the program does unless told otherwise"}, Settings{}});
  }

  void boolean(std::string name, bool Settings::* member, std::string help, std::string source) {
    add({std::move(name), std::move(help), "", ParameterKind::Boolean, {}, {}, {}, std::move(source), {}},
        [member](const Settings& s) { return ParameterValue(s.*member); },
        [member](Settings& s, const ParameterValue& v) { s.*member = std::get<bool>(v); });
  }
  void integer(std::string name, int Settings::* member, std::string unit, double minimum, double maximum,
               std::string help, std::string source) {
    if (minimum < std::numeric_limits<int>::min() || maximum > std::numeric_limits<int>::max())
      throw std::logic_error("the range of parameter " + name + " does not fit an int");
    add({std::move(name), std::move(help), std::move(unit), ParameterKind::Integer, minimum, maximum, {},
         std::move(source), {}},
        [member](const Settings& s) { return ParameterValue(static_cast<long long>(s.*member)); },
        [member](Settings& s, const ParameterValue& v) { s.*member = static_cast<int>(std::get<long long>(v)); });
  }
  // `si_per_unit`: what one unit of the edge is inside, e.g. 0.001 for mm.
  void real(std::string name, double Settings::* member, std::string unit, double minimum, double maximum,
            std::string help, std::string source, double si_per_unit = 1.0) {
    add({std::move(name), std::move(help), std::move(unit), ParameterKind::Real, minimum, maximum, {},
         std::move(source), {}},
        [member, si_per_unit](const Settings& s) { return ParameterValue(s.*member / si_per_unit); },
        [member, si_per_unit](Settings& s, const ParameterValue& v) {
          s.*member = std::get<double>(v) * si_per_unit;
        });
  }
  void angle(std::string name, double Settings::* member_rad, double minimum_deg, double maximum_deg,
             std::string help, std::string source) {
    real(std::move(name), member_rad, "deg", minimum_deg, maximum_deg, std::move(help), std::move(source),
         3.14159265358979323846 / 180.0);
  }
  template <class Enum>
  void choice(std::string name, Enum Settings::* member, std::vector<std::pair<std::string, Enum>> names,
              std::string help, std::string source) {
    std::vector<std::string> choices;
    for (const auto& entry : names) choices.push_back(entry.first);
    add({std::move(name), std::move(help), "", ParameterKind::Choice, {}, {}, std::move(choices),
         std::move(source), {}},
        [member, names](const Settings& s) {
          for (const auto& [text, value] : names)
            if (value == s.*member) return ParameterValue(text);
          return ParameterValue(std::string("?"));
        },
        [member, names](Settings& s, const ParameterValue& v) {
          for (const auto& [text, value] : names)
            if (text == std::get<std::string>(v)) s.*member = value;
        });
  }
  void text(std::string name, std::string Settings::* member, std::string help, std::string source) {
    add({std::move(name), std::move(help), "", ParameterKind::Text, {}, {}, {}, std::move(source), {}},
        [member](const Settings& s) { return ParameterValue(s.*member); },
        [member](Settings& s, const ParameterValue& v) { s.*member = std::get<std::string>(v); });
  }
  // Every parameter and preset of another table, whose settings are a member of these. A preset that was made
  // here already, under the same name, stays what it is.
  template <class Inner>
  void include(const ParameterTable<Inner>& inner, Inner Settings::* member) {
    for (const auto& entry : inner.entries_)
      add(inner.infos_[entry.index], [get = entry.get, member](const Settings& s) { return get(s.*member); },
          [set = entry.set, member](Settings& s, const ParameterValue& v) { set(s.*member, v); });
    for (const auto& [preset, settings] : inner.presets_) {
      const auto same = [&name = preset.name](const auto& own) { return own.first.name == name; };
      if (std::any_of(presets_.begin(), presets_.end(), same)) continue;
      Settings outer;
      outer.*member = settings;
      presets_.push_back({preset, std::move(outer)});
    }
  }
  void preset(std::string name, std::string help, Settings settings) {
    presets_.push_back({{std::move(name), std::move(help)}, std::move(settings)});
  }

  const std::string& operation() const { return operation_; }
  const std::vector<ParameterInfo>& infos() const { return infos_; }
  std::vector<ParameterPreset> presets() const {
    std::vector<ParameterPreset> list;
    for (const auto& entry : presets_) list.push_back(entry.first);
    return list;
  }
  Result<Settings> presetSettings(const std::string& name) const {
    std::vector<std::string> names;
    for (const auto& [preset, settings] : presets_) {
      if (preset.name == name) return settings;
      names.push_back(preset.name);
    }
    return fail("there is no preset \"" + name + "\"", operation_, "choose one of: " + list(names));
  }
  // Sets the named values; the settings stay as they were when any is refused.
  Status apply(const ParameterValues& values, Settings& settings) const {
    Settings changed = settings;
    for (const auto& [name, value] : values) {
      const Entry* entry = find(name);
      if (!entry) return fail(unknownParameter(name, names(), operation_));
      auto checked = checkParameter(infos_[entry->index], value);
      if (!checked) return fail(checked.error());
      entry->set(changed, *checked);
    }
    settings = std::move(changed);
    return {};
  }
  // Every value of the settings, in the units of the edge.
  ParameterValues values(const Settings& settings) const {
    ParameterValues result;
    for (const Entry& entry : entries_) result[infos_[entry.index].name] = entry.get(settings);
    return result;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& info : infos_) result.push_back(info.name);
    return result;
  }

 private:
  template <class Other>
  friend class ParameterTable;
  struct Entry {
    std::size_t index;
    std::function<ParameterValue(const Settings&)> get;
    std::function<void(Settings&, const ParameterValue&)> set;
  };
  void add(ParameterInfo info, std::function<ParameterValue(const Settings&)> get,
           std::function<void(Settings&, const ParameterValue&)> set) {
    info.default_value = get(presets_.front().second);
    if (find(info.name)) throw std::logic_error("parameter " + info.name + " is described twice");
    if (!checkParameter(info, info.default_value))
      throw std::logic_error("the default of parameter " + info.name + " lies outside its own range");
    entries_.push_back({infos_.size(), std::move(get), std::move(set)});
    infos_.push_back(std::move(info));
  }
  const Entry* find(const std::string& name) const {
    for (const Entry& entry : entries_)
      if (infos_[entry.index].name == name) return &entry;
    return nullptr;
  }
  static std::string list(const std::vector<std::string>& words) {
    std::string text;
    for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
  }

  std::string operation_;
  std::vector<ParameterInfo> infos_;
  std::vector<Entry> entries_;
  std::vector<std::pair<ParameterPreset, Settings>> presets_;
};

}  // namespace tiltmap
