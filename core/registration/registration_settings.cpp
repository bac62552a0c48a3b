#include "core/registration/registration_settings.h"

#include <numbers>

namespace tiltmap {

namespace {

using S = RegistrationSettings;
using Table = ParameterTable<RegistrationSettings>;

void addPreparation(Table& t) {
  t.choice(
      "filter", &S::filter,
      {{"none", MedianWindow::None}, {"median", MedianWindow::Square}, {"planar", MedianWindow::Line}},
      "Median filter on the range matrix: 3 x 3 cells, or 7 neighbours of one line. Plane patches need none.",
      "thesis 4.2.2.1");
  t.real("filter-threshold", &S::filter_threshold_m, "m", 0.0, 1000.0,
         "A cell is replaced when it differs from the window's median by more.", "thesis 4.2.2.1");
  t.boolean("filter-one-sided", &S::filter_one_sided,
            "Replace only cells that are further away than the median.",
            "thesis 4.2.2.1 (its wording differs in two places)");
  t.boolean("filter-centre", &S::filter_include_centre, "The cell itself votes too.",
            "thesis 4.2.2.1 (window or neighbourhood)");
  t.boolean("filter-no-return-votes", &S::filter_no_return_votes, "Cells without a return vote as 81.89 m.",
            "thesis 4.2.2");
  t.choice("reduction", &S::reduction,
           {{"none", Reduction::None},
            {"line", Reduction::Line},
            {"voxel", Reduction::Voxel},
            {"patches", Reduction::Patches}},
           "What is registered: all points, points merged along the lines, points merged in cubes, or plane "
           "patches.",
           "thesis 4.2.2.3; patches ours");
  t.real("reduction-distance", &S::reduction_distance_m, "m", 0.01, 10.0,
         "Neighbours nearer than this are merged (line), or the edge of the cubes (voxel).",
         "thesis 4.2.2.3");
  t.integer("normal-neighbours", &S::normal_neighbours, "", 3, 100,
            "Points that a normal is taken from where a scan is no matrix.", "ours");
  t.choice(
      "patch-grouping", &S::patch_grouping,
      {{"auto", PatchGrouping::Auto}, {"cubes", PatchGrouping::Cubes}, {"blocks", PatchGrouping::Blocks}},
      "What plane patches are made of: cubes of space, or blocks of the matrix's cells (faster and finer, "
      "but "
      "weak where most surfaces are near); auto takes blocks where a matrix mostly looks further than "
      "patch-near.",
      "ours");
  t.real(
      "patch-near", &S::patch_near_m, "m", 0.0, 1000.0,
      "Median range from which auto takes blocks: nearer, the many small patches of near surfaces outweigh "
      "all others.",
      "ours");
  t.real("patch-size", &S::patch_size_m, "m", 0.1, 20.0, "Edge of the cubes.", "ours");
  t.real("patch-block", &S::patch_block_m, "m", 0.1, 20.0,
         "Longest side of a block. Larger ones bridge the bends of the ground.", "ours");
  t.integer("patch-rows", &S::patch_rows, "cells", 1, 1000, "Height of the smallest blocks.", "ours");
  t.integer("patch-columns", &S::patch_columns, "cells", 1, 1000, "Width of the smallest blocks.", "ours");
  t.boolean(
      "patch-drop-edges", &S::patch_drop_edges,
      "Blocks leave out cells where 1/range bends, as at edges and in leaves; thin objects go with them.",
      "ours");
  t.integer("patch-splits", &S::patch_splits, "", 0, 10,
            "How often a group of points that is not planar is halved.", "ours");
  t.integer("patch-min-points", &S::patch_min_points, "", 4, 1000, "Smaller patches are dropped.", "ours");
  t.real("patch-noise", &S::patch_noise_m, "mm", 0.0, 1000.0,
         "Range noise: a group is split while its residual is above sqrt(2) sqrt((noise cos incidence)^2 + "
         "floor^2).",
         "ours; 12 mm is the LMS-291", 0.001);
  t.real("patch-floor", &S::patch_floor_m, "mm", 0.0, 1000.0, "The floor in the same bound.", "ours", 0.001);
  t.real("patch-rough-noise", &S::patch_rough_noise_m, "mm", 0.0, 1000.0,
         "What cannot be split further is kept while its residual is below the same bound with this noise.",
         "ours", 0.001);
  t.real("patch-rough-floor", &S::patch_rough_floor_m, "mm", 0.0, 1000.0,
         "And with this floor. Too small a value drops rough ground and facades.", "ours", 0.001);
  t.real("patch-prior", &S::patch_prior, "cells", 0.0, 1000.0,
         "Blocks: how many cells the noise model (patch-noise) counts for beside a block's own residual, "
         "which a few cells tell only roughly.",
         "ours");
  t.angle(
      "patch-spot", &S::patch_spot_rad, 0.0, 5.0,
      "Blocks of a scanner's regular matrix: deviation of the light across the beam. The near side of a "
      "slanted spot returns more, so ranges come out short, and far ground too high; surfaces are set back "
      "by it, or dropped where the spot is drawn out too long. 0: a thin beam.",
      "ours; 0.16 deg goes with the LMS-291's 11.9 mrad");
  t.choice("sampling", &S::sampling,
           {{"all", Sampling::All},
            {"uniform", Sampling::Uniform},
            {"random", Sampling::Random},
            {"normal-space", Sampling::NormalSpace}},
           "Which points or patches are paired: all, every n-th, a random share, or evenly over the normals.",
           "thesis 4.2.4; Rusinkiewicz and Levoy 2001");
  t.integer("sampling-step", &S::sampling_step, "", 1, 10000, "One in so many is paired (not with all).",
            "ours: the thesis gives no number");
  t.integer("seed", &S::seed, "", 0, 2147483647,
            "Of the random samplings; the same seed gives the same result.", "ours");
}

void addPairing(Table& t) {
  t.choice(
      "pair-choice", &S::pair_choice,
      {{"best-normal", PairChoice::BestNormalInLeaf},
       {"nearest", PairChoice::Nearest},
       {"normal-shooting", PairChoice::NormalShooting},
       {"projective", PairChoice::Projective}},
      "Partner: the best normal in the tree's leaf of the nearest point, the nearest, the nearest to the "
      "line "
      "along the normal, or the nearest with a fitting normal in about the same direction from the scanner.",
      "thesis 4.2.4; Besl and McKay 1992; Chen and Medioni 1991; ours");
  t.real("wide-search-above", &S::wide_search_above_m, "m", 0.0, 1000.0,
         "The projective choice looks in a three times wider field while the loss scale is above this.",
         "ours");
  t.integer(
      "wide-step", &S::wide_step, "", 1, 100,
      "While it does, and for blocks until the data's own scale is taken, one patch in so many is paired: "
      "they are soon paired again.",
      "ours");
  t.boolean("both-directions", &S::both_directions,
            "Pair the fixed scan's elements with the moving scan's too.", "ours");
  t.real("both-directions-below", &S::both_directions_below_m, "m", 0.0, 100.0,
         "Both directions only while the loss scale is below this.", "ours");
  addRejectionParameters(t);
}

void addEstimation(Table& t) {
  t.choice(
      "motion", &S::motion,
      {{"svd", MotionMethod::Svd},
       {"orthonormal", MotionMethod::Orthonormal},
       {"quaternion", MotionMethod::Quaternion},
       {"dual-quaternion", MotionMethod::DualQuaternion},
       {"point-to-plane", MotionMethod::PointToPlane},
       {"plane-to-plane", MotionMethod::PlaneToPlane}},
      "How the motion is found from the pairs: four closed forms on points, or one Gauss-Newton step on the "
      "distances along one or both surfaces' normals.",
      "thesis 4.2.5; Chen and Medioni 1991; Segal et al. 2009");
  t.real("gicp-epsilon", &S::gicp_epsilon, "", 1e-6, 1.0,
         "Variance across a point's surface relative to along it (plane-to-plane on points).",
         "Segal et al. 2009");
  t.choice("loss", &S::loss,
           {{"none", Loss::None}, {"geman-mcclure", Loss::GemanMcClure}, {"annealed", Loss::Annealed}},
           "How pairs that do not fit lose their weight: not at all, at a fixed scale, or at a scale that "
           "starts wide "
           "and ends at the data's own.",
           "Geman and McClure 1985; annealing ours");
  t.real("loss-scale", &S::loss_scale_m, "m", 0.0001, 100.0, "The fixed scale.", "ours");
  t.real("loss-start", &S::loss_start_m, "m", 0.001, 100.0,
         "First scale of the annealing; too small a value misses far starts.", "ours");
  t.real("loss-factor", &S::loss_factor, "", 0.05, 0.95,
         "The scale's factor each step; small values lose pairs.", "ours");
  t.real("loss-follow", &S::loss_follow, "", 1.0, 1000.0,
         "Nor is the scale ever above so many median residuals: a good start need not wait for it.", "ours");
  t.real("loss-end", &S::loss_end_m, "mm", 0.1, 10000.0,
         "Where the annealing ends; the scale is then taken from the data.", "ours", 0.001);
  t.real("loss-deviations", &S::loss_deviations, "", 0.5, 100.0,
         "Patches: the scale in the end, in deviations of each pair's residual (what its patches and all "
         "residuals "
         "together tell of it).",
         "ours; Mandel and Paule 1970");
  t.real("loss-minimum", &S::loss_minimum_m, "mm", 0.01, 10000.0,
         "Points: the scale is the median residual in the end, but never below.", "ours", 0.001);
}

void addEnd(Table& t) {
  t.boolean(
      "refine", &S::refine,
      "At last hold each scan's cells against the other's patches, all that lie on one together (blocks "
      "of a matrix only).",
      "ours");
  t.real("refine-whole", &S::refine_whole_m, "m", 0.0, 100.0,
         "The cells of a tile smaller than this count as one point there.", "ours");
  t.real("refine-deviations", &S::refine_deviations, "", 0.5, 100.0,
         "Patches whose cells are further off than so many deviations lose their weight there (Geman and "
         "McClure).",
         "ours");
  t.integer("max-iterations", &S::max_iterations, "", 1, 10000, "Steps at most.", "ours");
  t.real("min-change", &S::min_change, "%", 0.0, 100.0,
         "Converged when the mean squared residual changes by less in one step.",
         "thesis 4.2.1 step 8; value ours", 0.01);
  t.real("min-translation", &S::min_translation_m, "mm", 0.0, 1000.0,
         "Ends when a step moves less than this and turns less than min-rotation.", "ours", 0.001);
  t.angle("min-rotation", &S::min_rotation_rad, 0.0, 10.0, "See min-translation.", "ours");
  t.integer("min-pairs", &S::min_pairs, "", 3, 1000000, "With fewer pairs the registration fails.", "ours");
  t.real("min-overlap", &S::min_overlap, "", 0.0, 1.0,
         "With a smaller share of the moving scan fitting, the registration fails as without overlap.",
         "ours");
  t.real(
      "min-agreement", &S::min_agreement, "", 0.0, 1.0,
      "With a smaller share of the pairs within three deviations, the registration fails as without overlap.",
      "ours");
  t.real("retry-agreement", &S::retry_agreement, "", 0.0, 1.0,
         "With a smaller share of the pairs within three deviations, the pair is registered again from other "
         "headings "
         "and the result that fits most is kept; 0 never does.",
         "ours: right results on simulated drives had 0.61 or more, a wrong one 0.47");
  t.real(
      "retry-deviation", &S::retry_deviation_m, "mm", 0.0, 10000.0,
      "A result that failed, agrees too little or has a direction with a larger standard deviation is tried "
      "again with cubes where patch-grouping auto took blocks: cubes catch small things better, such as "
      "poles "
      "along a street.",
      "ours", 0.001);
  t.angle("retry-heading", &S::retry_heading_rad, 0.1, 60.0,
          "Other headings lie this and twice this to either side of the start.",
          "ours: a turn measured by eye is off by ten degrees");
  t.real("min-eigenvalue", &S::min_eigenvalue, "", 0.0, 1.0,
         "Directions whose normalised information is below are left as at the start, and the result is "
         "degenerate.",
         "ours; Gelfand et al. 2003");
  t.real("max-correction", &S::max_correction_m, "m", 0.01, 10000.0,
         "Further from the start than this the registration has diverged.", "ours");
  t.angle("max-correction-angle", &S::max_correction_rad, 0.1, 180.0, "The same for the turn.", "ours");
}

bool isClosedForm(MotionMethod motion) {
  return motion != MotionMethod::PointToPlane && motion != MotionMethod::PlaneToPlane;
}

}  // namespace

RegistrationSettings thesisSettings() {
  RegistrationSettings s;
  s.filter = MedianWindow::Square;
  s.filter_no_return_votes = true;
  s.reduction = Reduction::Line;
  s.reduction_distance_m = 0.5;
  s.sampling = Sampling::Uniform;
  s.sampling_step = 4;
  s.pair_choice = PairChoice::BestNormalInLeaf;
  s.both_directions = false;
  s.max_distance_m = 5.0;
  s.max_angle_rad = 20.0 * kDegree;
  s.statistics = true;
  s.statistics_distance_m = 0.5;
  s.motion = MotionMethod::Svd;
  s.loss = Loss::None;
  s.max_iterations = 100;
  s.min_change = 1e-3;
  s.retry_agreement = 0.0;
  return s;
}

Status checkSettings(const RegistrationSettings& s) {
  const auto refuse = [](const char* what, const char* remedy) { return fail(what, "register", remedy); };
  if (s.reduction == Reduction::Patches && isClosedForm(s.motion))
    return refuse(
        "the centres of plane patches are not the same points in two scans, so no closed form applies",
        "choose motion point-to-plane or plane-to-plane, or reduction none, line or voxel");
  if (s.reduction == Reduction::Patches && s.pair_choice == PairChoice::BestNormalInLeaf)
    return refuse("best-normal looks among neighbouring points of one leaf, which plane patches do not have",
                  "choose pair-choice projective, nearest or normal-shooting, or another reduction");
  if (s.statistics && s.loss == Loss::Annealed)
    return refuse("statistics and an annealed loss both set how far a pair may be off, against each other",
                  "turn statistics off, or choose loss none or geman-mcclure");
  if (s.loss == Loss::Annealed && (s.loss_start_m < s.loss_end_m || s.loss_end_m < s.loss_minimum_m))
    return refuse("the annealed loss must start at its widest scale and end above its minimum",
                  "give loss-start >= loss-end >= loss-minimum");
  if (s.statistics && s.max_distance_m <= 0.0)
    return refuse("statistics need a distance bound to start from",
                  "give a max-distance above 0, such as 5 m");
  return {};
}

const ParameterTable<RegistrationSettings>& registrationParameters() {
  static const Table table = [] {
    Table t("register");
    addPreparation(t);
    addPairing(t);
    addEstimation(t);
    addEnd(t);
    t.preset("thesis", "the method as printed, for teaching and comparison", thesisSettings());
    return t;
  }();
  return table;
}

}  // namespace tiltmap
