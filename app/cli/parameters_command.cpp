// tiltmap parameters [OPERATION]
#include "app/cli/operation_runner.h"
#include "core/base/text.h"

namespace tiltmap::cli {

namespace {

nlohmann::json valueJson(const ParameterValue& value) {
  return std::visit([](const auto& v) { return nlohmann::json(v); }, value);
}

nlohmann::json infoJson(const ParameterInfo& info) {
  nlohmann::json json = {{"name", info.name}, {"kind", parameterKindName(info.kind)},
                         {"unit", info.unit}, {"default", valueJson(info.default_value)},
                         {"help", info.help}, {"source", info.source}};
  if (info.minimum) json["minimum"] = *info.minimum;
  if (info.maximum) json["maximum"] = *info.maximum;
  if (!info.choices.empty()) json["choices"] = info.choices;
  return json;
}

std::string wrapped(const std::string& text, const std::string& indent, std::size_t width = 100) {
  std::string result, line;
  for (const std::string_view word : splitWords(text)) {
    if (!line.empty() && indent.size() + line.size() + 1 + word.size() > width) {
      result += indent + line + "\n";
      line.clear();
    }
    if (!line.empty()) line += ' ';
    line += word;
  }
  return result + indent + line + "\n";
}

std::string operationText(const Operation& operation) {
  std::string text = operation.id() + ": " + operation.title() + "\n" + wrapped(operation.help(), "  ");
  std::string presets;
  for (const ParameterPreset& preset : operation.presets())
    presets += "\n    " + preset.name + ": " + preset.help;
  if (operation.presets().size() > 1) text += "  presets" + presets + "\n";
  for (const ParameterInfo& info : operation.parameters()) {
    text += "\n  --" + info.name + "   [" + parameterSummary(info) + "]\n" + wrapped(info.help, "      ");
    text += wrapped("Source: " + info.source, "      ");
    for (const ParameterPreset& preset : operation.presets()) {
      if (preset.name == "default") continue;
      const auto values = operation.presetValues(preset.name);
      if (values && values->at(info.name) != info.default_value)
        text += "      In preset " + preset.name + ": " + parameterText(values->at(info.name)) + "\n";
    }
  }
  return text + "\n";
}

int listParameters(Context& context, const std::string& name) {
  std::vector<const Operation*> list = operations().all();
  if (!name.empty()) {
    auto operation = operations().get(name);
    if (!operation) return context.console.wrongUsage(operation.error());
    list = {*operation};
  }
  nlohmann::json json = nlohmann::json::array();
  std::string text;
  for (const Operation* operation : list) {
    nlohmann::json parameters = nlohmann::json::array();
    for (const ParameterInfo& info : operation->parameters()) parameters.push_back(infoJson(info));
    nlohmann::json presets = nlohmann::json::object();
    for (const ParameterPreset& preset : operation->presets()) {
      nlohmann::json values = nlohmann::json::object();
      if (const auto set = operation->presetValues(preset.name))
        for (const auto& [parameter, value] : *set) values[parameter] = valueJson(value);
      presets[preset.name] = {{"help", preset.help}, {"values", values}};
    }
    json.push_back({{"operation", operation->id()},
                    {"help", operation->help()},
                    {"parameters", parameters},
                    {"presets", presets}});
    text += operationText(*operation);
  }
  context.console.printJson({{"operations", json}});
  context.console.print(text);
  return kDone;
}

}  // namespace

void addParameters(CLI::App& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("parameters", "Every parameter: name, unit, range, default, meaning, source");
  auto name = std::make_shared<std::string>();
  command->add_option("operation", *name, "One operation; all unless told");
  command->callback([name, &chosen] {
    chosen.body = [name](Context& context) -> int { return listParameters(context, *name); };
  });
}

}  // namespace tiltmap::cli
