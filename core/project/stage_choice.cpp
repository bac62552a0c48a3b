#include "core/project/stage_choice.h"

namespace tiltmap {

Result<Stage> stageOrLatest(const ProjectSnapshot& snapshot, const std::string& name) {
  if (name.empty()) return snapshot.latestStage();
  auto stage = parseStage(name);
  if (stage && !snapshot.hasStage(*stage))
    return fail("the project has no poses of stage " + name, snapshot.path().string(),
                "run the operation that makes it first, or choose another stage (`tiltmap info` lists them)");
  return stage;
}

}  // namespace tiltmap
