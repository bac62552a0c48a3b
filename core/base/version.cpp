#include "core/base/version.h"

namespace tiltmap {

const std::string& programVersion() {
  static const std::string version = TILTMAP_VERSION;
  return version;
}

}  // namespace tiltmap
