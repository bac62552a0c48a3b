#include "core/project/operation.h"

#include <algorithm>
#include <stdexcept>

#include "core/base/text.h"

namespace tiltmap {

namespace {

Result<const ParameterInfo*> infoOf(const Operation& operation, const std::string& name) {
  const auto& infos = operation.parameters();
  const auto found = std::ranges::find(infos, name, &ParameterInfo::name);
  if (found != infos.end()) return &*found;
  std::vector<std::string> known;
  for (const ParameterInfo& info : infos) known.push_back(info.name);
  return fail(unknownParameter(name, known, operation.id()));
}

}  // namespace

Result<ParameterValues> Operation::completed(const std::string& preset, const ParameterValues& values) const {
  auto complete = presetValues(preset);
  if (!complete) return complete;
  for (const auto& [name, value] : values) {
    const auto info = infoOf(*this, name);
    if (!info) return fail(info.error());
    auto checked = checkParameter(**info, value);
    if (!checked) return fail(checked.error());
    (*complete)[name] = std::move(*checked);
  }
  return complete;
}

Result<ParameterValues> Operation::parsed(
    const std::string& preset, const std::vector<std::pair<std::string, std::string>>& words) const {
  ParameterValues values;
  for (const auto& [name, word] : words) {
    const auto info = infoOf(*this, name);
    if (!info) return fail(info.error());
    auto value = parseParameter(**info, word);
    if (!value) return fail(value.error());
    values[name] = std::move(*value);
  }
  return completed(preset, values);
}

void OperationRegistry::add(std::unique_ptr<Operation> operation) {
  if (find(operation->id())) throw std::logic_error("two operations are called " + operation->id());
  operations_.push_back(std::move(operation));
}

std::vector<const Operation*> OperationRegistry::all() const {
  std::vector<const Operation*> list;
  for (const auto& operation : operations_) list.push_back(operation.get());
  return list;
}

const Operation* OperationRegistry::find(const std::string& id) const {
  const auto found =
      std::ranges::find_if(operations_, [&](const auto& operation) { return operation->id() == id; });
  return found == operations_.end() ? nullptr : found->get();
}

Result<const Operation*> OperationRegistry::get(const std::string& id) const {
  if (const Operation* operation = find(id)) return operation;
  std::vector<std::string> known;
  for (const auto& operation : operations_) known.push_back(operation->id());
  const auto nearest = nearestName(id, known);
  return fail(
      "there is no operation \"" + id + "\"", "",
      (nearest ? "did you mean " + *nearest + "? " : std::string()) + "there are: " + joined(known, ", "));
}

}  // namespace tiltmap
