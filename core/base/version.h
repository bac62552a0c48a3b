// The program's version, as the build gives it.
#pragma once

#include <string>

namespace tiltmap {

const std::string& programVersion();  // "0.1.0"

}  // namespace tiltmap
