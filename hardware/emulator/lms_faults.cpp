// Faults by name, for the control line of `tiltmap emulate` and for tests.
#include <functional>
#include <map>

#include "core/base/text.h"
#include "hardware/emulator/lms_emulator.h"

namespace tiltmap {

namespace {

using Apply = std::function<void(LmsEmulator&, double)>;
struct NamedFault {
  double usual;  // where no value is given
  double most;
  Apply apply;
};

int countOf(double value) {
  return static_cast<int>(value);
}

const std::map<std::string, NamedFault>& named() {
  static const std::map<std::string, NamedFault> all{
      {"lose-byte", {0.001, 1.0, [](LmsEmulator& e, double v) { e.faults().lose_byte = v; }}},
      {"flip-bit", {0.001, 1.0, [](LmsEmulator& e, double v) { e.faults().flip_bit = v; }}},
      {"duplicate-byte", {0.001, 1.0, [](LmsEmulator& e, double v) { e.faults().duplicate_byte = v; }}},
      {"insert-byte", {0.001, 1.0, [](LmsEmulator& e, double v) { e.faults().insert_byte = v; }}},
      {"split", {0.01, 1.0, [](LmsEmulator& e, double v) { e.faults().split = v; }}},
      {"merge", {0.016, 1.0, [](LmsEmulator& e, double v) { e.faults().merge_s = v; }}},
      {"lose-acknowledge",
       {1, 1e6, [](LmsEmulator& e, double v) { e.faults().lose_acknowledge = countOf(v); }}},
      {"refuse-checksum",
       {1, 1e6, [](LmsEmulator& e, double v) { e.faults().refuse_checksum = countOf(v); }}},
      {"miss-request", {1, 1e6, [](LmsEmulator& e, double v) { e.faults().miss_request = countOf(v); }}},
      {"cut-telegram", {1, 1e6, [](LmsEmulator& e, double v) { e.faults().cut_telegrams = countOf(v); }}},
      {"late-answer",
       {2.0, 60.0,
        [](LmsEmulator& e, double v) {
          e.faults().late_answers = 1;
          e.faults().late_s = v;
        }}},
      {"refuse-configuration",
       {1, 1, [](LmsEmulator& e, double v) { e.faults().refuse_configuration = v > 0.0; }}},
      {"refuse-variant", {1, 1, [](LmsEmulator& e, double v) { e.faults().refuse_variant = v > 0.0; }}},
      {"dirty-window", {1, 1, [](LmsEmulator& e, double v) { e.faults().dirty_window = v > 0.0; }}},
      {"dazzled", {1, 1, [](LmsEmulator& e, double v) { e.faults().dazzled = v > 0.0; }}},
      {"power-cut", {1.0, 3600.0, [](LmsEmulator& e, double v) { e.cutPower(durationOf(v)); }}},
      {"wrong-rate", {19200, 500000, [](LmsEmulator& e, double v) { e.setBaud(countOf(v)); }}},
      {"silent", {1, 1, [](LmsEmulator& e, double v) { e.faults().silent = v > 0.0; }}},
  };
  return all;
}

}  // namespace

std::vector<std::string> LmsEmulator::faultNames() {
  std::vector<std::string> names;
  for (const auto& [name, fault] : named()) names.push_back(name);
  names.emplace_back("none");
  return names;
}

Status LmsEmulator::applyFault(const std::string& text) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  if (name == "none") {
    faults_ = {};
    return {};
  }
  const auto found = named().find(name);
  if (found == named().end()) {
    const auto nearest = nearestName(name, faultNames());
    return fail(
        "the scanner has no fault `" + name + "`", text,
        (nearest ? "did you mean " + *nearest + "? " : "") + "there are " + joined(faultNames(), ", "));
  }
  double value = found->second.usual;
  if (equals != std::string::npos) {
    const auto given = parseReal(text.substr(equals + 1));
    if (!given || !(*given >= 0.0 && *given <= found->second.most))
      return fail("`" + text.substr(equals + 1) + "` is no value for it", text,
                  "give a number from 0 to " + shortestReal(found->second.most));
    value = *given;
  }
  found->second.apply(*this, value);
  return {};
}

}  // namespace tiltmap
