#include "app/cli/command.h"
#include "core/base/text.h"

namespace tiltmap::cli {

std::string parameterSummary(const ParameterInfo& info) {
  std::string text;
  if (info.kind == ParameterKind::Choice) {
    text = joined(info.choices, "|");
  } else if (info.kind == ParameterKind::Boolean) {
    text = "true|false";
  } else if (info.minimum && info.maximum) {
    text = parameterText(*info.minimum) + " to " + parameterText(*info.maximum);
    if (!info.unit.empty()) text += " " + info.unit;
  } else {
    text = "text";
  }
  const std::string standard = parameterText(info.default_value);
  return text + ", default " + (standard.empty() ? "empty" : standard);
}

namespace {

std::string typeName(const ParameterInfo& info) {
  if (!info.unit.empty()) return info.unit;
  if (info.kind == ParameterKind::Choice) return "WORD";
  return info.minimum ? "NUMBER" : "TEXT";
}

}  // namespace

std::shared_ptr<ParameterFlags> ParameterFlags::addTo(CLI::App& command,
                                                      const std::vector<ParameterInfo>& infos) {
  auto flags = std::make_shared<ParameterFlags>();
  flags->infos_ = infos;
  flags->texts_.resize(infos.size());
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const ParameterInfo& info = infos[i];
    const std::string help = info.help + " [" + parameterSummary(info) + "]";
    CLI::Option* option =
        info.kind == ParameterKind::Boolean
            ? command.add_flag("--" + info.name + "{true}", flags->texts_[i], help)
            : command.add_option("--" + info.name, flags->texts_[i], help)->type_name(typeName(info));
    option->group("Parameters");
    flags->options_.push_back(option);
  }
  return flags;
}

Result<ParameterValues> ParameterFlags::values() const {
  ParameterValues values;
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    if (options_[i]->count() == 0) continue;
    auto value = parseParameter(infos_[i], texts_[i]);
    if (!value) return fail(value.error());
    values[infos_[i].name] = *value;
  }
  return values;
}

}  // namespace tiltmap::cli
