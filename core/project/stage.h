// Where a set of poses comes from.
#pragma once

#include <array>
#include <string>

#include "core/base/result.h"

namespace tiltmap {

// In the order of processing. Truth exists for simulated sites and surveys with control only.
enum class Stage { Truth, Odometry, Pairwise, Relaxed };

inline constexpr std::array<Stage, 4> kStages = {Stage::Truth, Stage::Odometry, Stage::Pairwise,
                                                 Stage::Relaxed};

// "truth", "odometry", "pairwise", "relaxed": used in files, flags and tables alike.
const std::string& stageName(Stage stage);
Result<Stage> parseStage(const std::string& name);

}  // namespace tiltmap
