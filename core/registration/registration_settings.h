// What a pairwise registration can be told. Every default stands here as a member initialiser, once.
#pragma once

#include "core/base/parameter.h"
#include "core/base/result.h"
#include "core/geometry/pose.h"
#include "core/registration/rejection.h"
#include "core/scan/filters.h"

namespace tiltmap {

// What is registered: points, thinned or not, or plane patches.
enum class Reduction {
  None,     // every point
  Line,     // disjoint neighbours of a line merged (thesis 4.2.2.3); a voxel grid where there is no matrix
  Voxel,    // the mean of each cube
  Patches,  // plane patches with their covariance
};
// What plane patches are split from.
enum class PatchGrouping {
  Auto,    // blocks of a matrix that mostly looks further than patch_near_m, else cubes
  Cubes,   // of space: the same for matrices and unordered clouds
  Blocks,  // of cells, where the scan is a matrix; faster and finer, but near surfaces outnumber all others
};
enum class Sampling { All, Uniform, Random, NormalSpace };
enum class PairChoice {
  BestNormalInLeaf,  // thesis 4.2.4
  Nearest,           // Besl and McKay 1992
  NormalShooting,    // Chen and Medioni 1991
  Projective,  // nearest with a fitting normal among what lies in about the same direction from the scanner
};
enum class MotionMethod {
  Svd,  // point to point, closed forms (thesis 4.2.5)
  Orthonormal,
  Quaternion,
  DualQuaternion,
  PointToPlane,  // one linearised Gauss-Newton step (Chen and Medioni 1991)
  PlaneToPlane,  // one Gauss-Newton step on both surfaces' covariances (GICP: Segal, Haehnel, Thrun 2009)
};
enum class Loss {
  None,
  GemanMcClure,  // with a fixed scale
  Annealed,      // Geman-McClure from a wide scale down to the data's own
};

// Plain data, SI units. Describe and set it through registrationParameters().
struct RegistrationSettings : RejectionSettings {
  // Filter (core/scan/filters.h).
  MedianWindow filter = MedianWindow::None;
  double filter_threshold_m = 2.0;
  bool filter_one_sided = false;
  bool filter_include_centre = true;
  bool filter_no_return_votes = false;

  // Reduction.
  Reduction reduction = Reduction::Patches;
  double reduction_distance_m = 0.5;  // line and voxel
  int normal_neighbours = 12;         // normals of an unordered cloud, for point methods
  PatchGrouping patch_grouping = PatchGrouping::Auto;
  double patch_near_m = 4.0;   // median range from which a matrix is cut into blocks
  double patch_size_m = 2.0;   // edge of the cubes
  double patch_block_m = 1.0;  // longest side of a block
  int patch_rows = 2;          // size of the smallest blocks, cells
  int patch_columns = 4;
  bool patch_drop_edges = true;  // blocks: leave out cells at depth edges (regular matrices)
  int patch_splits = 5;          // at most so many halvings
  int patch_min_points = 5;
  // A group is planar, and not split, when its residual is below sqrt(2) sqrt((noise cos incidence)^2 +
  // floor^2); one that cannot be split further is kept when it is below the same of the rough surfaces.
  double patch_noise_m = 0.012;
  double patch_floor_m = 0.002;
  double patch_rough_noise_m = 0.03;
  double patch_rough_floor_m = 0.02;
  double patch_prior = 10.0;  // blocks: the noise model counts as much as so many of a block's cells
  double patch_spot_rad =
      0.16 * kDegree;  // blocks of a regular matrix: deviation of the light across the beam

  // Sampling.
  Sampling sampling = Sampling::All;
  int sampling_step = 4;  // one element in so many
  int seed = 1;

  PairChoice pair_choice = PairChoice::Projective;
  double wide_search_above_m = 0.3;      // projective: three times wider while the loss scale is above
  int wide_step = 2;                     // and only one patch in so many is paired then
  bool both_directions = true;           // also pair the fixed scan's elements with the moving ones
  double both_directions_below_m = 0.1;  // only once the loss scale is below; loss none: always

  MotionMethod motion = MotionMethod::PlaneToPlane;
  double gicp_epsilon = 1e-3;  // variance across a point's surface, relative to along it

  Loss loss = Loss::Annealed;
  double loss_scale_m = 0.1;      // Geman-McClure: the scale
  double loss_start_m = 2.0;      // annealed: first scale
  double loss_factor = 0.6;       // annealed: times this each step
  double loss_follow = 5.0;       // annealed: nor above so many median residuals
  double loss_end_m = 0.02;       // annealed: down to here, then to the data's own
  double loss_deviations = 2.0;   // annealed, patches: in the end so many deviations of each pair's residual
  double loss_minimum_m = 0.002;  // annealed, points: in the end the median residual, but never below

  // Refinement: at last each scan's cells against the other's patches (blocks of a matrix only).
  bool refine = true;
  double refine_whole_m = 0.2;     // a tile smaller than this counts as one point
  double refine_deviations = 3.0;  // Geman-McClure: so many deviations

  // End of the iteration.
  int max_iterations = 60;
  double min_change = 1e-3;  // relative change of the mean squared residual
  double min_translation_m = 2e-5;
  double min_rotation_rad = 2e-6;
  int min_pairs = 12;
  double min_overlap = 0.1;        // below: the scans do not overlap, whatever the residual
  double min_agreement = 0.4;      // share of pairs that agree within three deviations; below: no overlap
  double min_eigenvalue = 3e-4;    // of the normalised information; below: degenerate
  double max_correction_m = 15.0;  // further from the start: diverged
  double max_correction_rad = 1.5707963267948966;

  // Trying again (registerPair): a result that agrees less is doubted, and other headings are started from.
  double retry_agreement = 0.5;     // 0: never
  double retry_deviation_m = 0.01;  // or one known worse than this: cubes are tried where auto took blocks
  double retry_heading_rad = 0.17453292519943295;  // 10 deg; once and twice this to either side
};

// Combinations that make no sense are refused with a message; ranges are the table's business.
Status checkSettings(const RegistrationSettings& settings);

// Descriptions, and the presets "default" and "thesis".
const ParameterTable<RegistrationSettings>& registrationParameters();
RegistrationSettings thesisSettings();

}  // namespace tiltmap
