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
  }
  return text + ", default " + parameterText(info.default_value);
}

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
            : command.add_option("--" + info.name, flags->texts_[i], help)
                  ->type_name(info.unit.empty() ? (info.kind == ParameterKind::Choice ? "WORD" : "NUMBER")
                                                : info.unit);
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
