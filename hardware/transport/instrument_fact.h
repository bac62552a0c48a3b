// What an instrument says of itself, as a line of a list: "firmware", "V02.10".
#pragma once

#include <string>

namespace tiltmap {

struct InstrumentFact {
  std::string name, value;
  bool trouble = false;  // the operator should do something about it
};

}  // namespace tiltmap
