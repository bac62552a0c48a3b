// Any bytes, read as TUM poses and as a .pose file; what is read is written and read again.
#include <cstdint>
#include <cstdlib>

#include "core/io/pose_file.h"

namespace {

void require(bool held) {
  if (!held) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tiltmap;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto poses = parsePosesTum(text, "file")) {
    const auto again = parsePosesTum(posesTumText(*poses), "file");
    require(again && again->size() == poses->size());
    for (const auto& [index, pose] : *poses)
      require(pose.isFinite() && (again->at(index).translation() - pose.translation()).norm() == 0.0);
  }
  if (const auto pose = parsePose3dtk(text, "file")) require(pose->isFinite());
  return 0;
}
