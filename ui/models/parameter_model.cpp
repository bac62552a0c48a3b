#include "ui/models/parameter_model.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/text.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

ParameterModel::ParameterModel(const Operation& operation, QObject* parent)
    : QObject(parent), operation_(operation) {
  setPreset(preset_);
}

const ParameterInfo& ParameterModel::info(const QString& name) const {
  const auto found = std::ranges::find(infos(), utf8(name), &ParameterInfo::name);
  if (found == infos().end()) throw std::invalid_argument("ParameterModel: no parameter " + utf8(name));
  return *found;
}

void ParameterModel::setPreset(const QString& preset) {
  auto values = operation_.presetValues(utf8(preset));
  if (!values) return;
  preset_ = preset;
  base_ = std::move(*values);
  values_ = base_;
  errors_.clear();
  Q_EMIT presetChanged();
}

QString ParameterModel::valueText(const QString& name) const {
  const auto refused = errors_.find(utf8(name));
  return refused == errors_.end() ? qt(parameterText(values_.at(utf8(name)))) : refused->second.text;
}

void ParameterModel::setValueText(const QString& name, const QString& text) {
  if (text == valueText(name)) return;
  auto value = parseParameter(info(name), utf8(text));
  if (value) return setValue(name, *value);
  errors_[utf8(name)] = {text, value.error()};
  Q_EMIT valueChanged(name);
}

void ParameterModel::setValue(const QString& name, const ParameterValue& value) {
  const auto checked = checkParameter(info(name), value);
  if (!checked) {
    errors_[utf8(name)] = {qt(parameterText(value)), checked.error()};
  } else {
    if (values_.at(utf8(name)) == *checked && !errors_.contains(utf8(name))) return;
    errors_.erase(utf8(name));
    values_[utf8(name)] = *checked;
  }
  Q_EMIT valueChanged(name);
}

std::optional<Error> ParameterModel::error(const QString& name) const {
  const auto refused = errors_.find(utf8(name));
  return refused == errors_.end() ? std::nullopt : std::optional(refused->second.error);
}

bool ParameterModel::isChanged(const QString& name) const {
  // By text: 20 degrees typed and 20 degrees come back from radians are the same to a person.
  return errors_.contains(utf8(name)) ||
         parameterText(values_.at(utf8(name))) != parameterText(base_.at(utf8(name)));
}

int ParameterModel::changedCount() const {
  return static_cast<int>(
      std::ranges::count_if(infos(), [this](const ParameterInfo& i) { return isChanged(qt(i.name)); }));
}

void ParameterModel::reset(const QString& name) {
  if (!isChanged(name)) return;
  errors_.erase(utf8(name));
  values_[utf8(name)] = base_.at(utf8(name));
  Q_EMIT valueChanged(name);
}

void ParameterModel::resetAll() {
  for (const ParameterInfo& i : infos()) reset(qt(i.name));
}

ParameterValues ParameterModel::changes() const {
  ParameterValues changed;
  for (const auto& [name, value] : values_)
    if (parameterText(value) != parameterText(base_.at(name))) changed[name] = value;
  return changed;
}

void ParameterModel::restore(const LastParameters& last) {
  if (!last.preset.isEmpty()) setPreset(last.preset);
  for (const auto& [name, value] : last.values) {
    const auto found = std::ranges::find(infos(), name, &ParameterInfo::name);
    if (found != infos().end() && checkParameter(*found, value)) setValue(qt(name), value);
  }
}

QString parameterLabel(const ParameterInfo& info) {
  QString label = qt(info.name).replace('-', ' ');
  if (!label.isEmpty()) label[0] = label[0].toUpper();
  return label;
}

QString parameterRange(const ParameterInfo& info) {
  if (!info.minimum || !info.maximum) return {};
  const QString range = qt(parameterText(*info.minimum) + " to " + parameterText(*info.maximum));
  return info.unit.empty() ? range : range + " " + qt(info.unit);
}

QString parameterTip(const ParameterInfo& info) {
  QString tip = "<p>" + qt(info.help).toHtmlEscaped() + "</p><table>";
  const auto row = [&tip](const QString& name, const QString& value) {
    if (!value.isEmpty())
      tip += QString("<tr><td style='padding-right:12px'>%1</td><td>%2</td></tr>")
                 .arg(name, value.toHtmlEscaped());
  };
  row("Range", parameterRange(info));
  const QString unit = info.unit.empty() ? QString() : " " + qt(info.unit);
  const QString standard = qt(parameterText(info.default_value));
  row("Default", standard.isEmpty() ? QString("empty") : standard + unit);
  row("Source", qt(info.source));
  row("Command line", "--" + qt(info.name));
  return tip + "</table>";
}

}  // namespace tiltmap::ui
