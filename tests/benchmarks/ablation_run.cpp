#include "tests/benchmarks/ablation_run.h"

#include <functional>

#include "core/registration/registration_settings.h"

namespace tiltmap::benchmarks {

namespace {

using S = RegistrationSettings;

struct Ablation {
  const char* name;
  std::function<void(S&)> change;
};

const std::vector<Ablation>& list() {
  static const std::vector<Ablation> all = {
      {"cubes, not blocks", [](S& s) { s.patch_grouping = PatchGrouping::Cubes; }},
      {"smallest blocks only", [](S& s) { s.patch_block_m = 0.1; }},
      {"cells at depth edges stay", [](S& s) { s.patch_drop_edges = false; }},
      {"a thin beam, no spot", [](S& s) { s.patch_spot_rad = 0.0; }},
      {"residuals without prior", [](S& s) { s.patch_prior = 0.0; }},
      {"no rough patches",
       [](S& s) {
         s.patch_rough_noise_m = s.patch_noise_m;
         s.patch_rough_floor_m = s.patch_floor_m;
       }},
      {"only one direction", [](S& s) { s.both_directions = false; }},
      {"nearest, not projective", [](S& s) { s.pair_choice = PairChoice::Nearest; }},
      {"no wide search", [](S& s) { s.wide_search_above_m = 1000.0; }},
      {"all patches from the first step", [](S& s) { s.wide_step = 1; }},
      {"any angle of normals", [](S& s) { s.max_angle_rad = 90.0 * kDegree; }},
      {"fixed normal, equal weights", [](S& s) { s.motion = MotionMethod::PointToPlane; }},
      {"no loss", [](S& s) { s.loss = Loss::None; }},
      {"loss fixed at 0.1 m", [](S& s) { s.loss = Loss::GemanMcClure; }},
      {"annealing from 0.1 m", [](S& s) { s.loss_start_m = 0.1; }},
      {"annealing not hastened", [](S& s) { s.loss_follow = 1000.0; }},
      {"annealing three times as fast", [](S& s) { s.loss_factor = 0.2; }},
      {"hardly a loss in the end", [](S& s) { s.loss_deviations = s.refine_deviations = 20.0; }},
      {"no refinement by cells", [](S& s) { s.refine = false; }},
      {"refinement cell by cell", [](S& s) { s.refine_whole_m = 0.0; }},
      {"no second try", [](S& s) { s.retry_agreement = 0.0, s.retry_deviation_m = 10.0; }},
  };
  return all;
}

}  // namespace

std::vector<PairMethod> ablations() {
  const S full = *registrationParameters().presetSettings("default");
  std::vector<PairMethod> methods = {ownMethod("default", full)};
  for (const Ablation& ablation : list()) {
    S settings = full;
    ablation.change(settings);
    methods.push_back(ownMethod(ablation.name, settings));
  }
  return methods;
}

}  // namespace tiltmap::benchmarks
