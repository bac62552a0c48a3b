#include "core/registration/judgement_settings.h"

namespace tiltmap {

const ParameterTable<JudgementSettings>& judgementParameters() {
  using S = JudgementSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("judge");
    const char* tuned = "ours: between right and wrong poses of simulated drives, seeds above 100";
    t.real("fit-good", &S::fit_good, "", 0.0, 1.0,
           "Of the surfaces both scans could see, the share that lies on each other: less is doubted.",
           tuned);
    t.real("fit-bad", &S::fit_bad, "", 0.0, 1.0, "Less than this condemns the pair.", tuned);
    t.real(
        "through-good", &S::through_good, "", 0.0, 1.0,
        "Of the same surfaces, the share that stands where the other scan looked through: more is doubted.",
        tuned);
    t.real("through-bad", &S::through_bad, "", 0.0, 1.0, "More than this condemns the pair.", tuned);
    t.real("overlap-good", &S::overlap_good, "", 0.0, 1.0,
           "Share of one scan's surfaces that lie on the other's: less is doubted.", tuned);
    t.real("overlap-bad", &S::overlap_bad, "", 0.0, 1.0, "Less than this condemns the pair.", tuned);
    t.real("residual-good", &S::residual_good, "", 0.0, 1000.0,
           "Median distance of the surfaces that fit over what their noise makes of it: more is doubted.",
           tuned);
    t.real("residual-bad", &S::residual_bad, "", 0.0, 1000.0, "More than this condemns the pair.", tuned);
    t.real("excess-good", &S::excess_good_m, "mm", 0.0, 1000.0,
           "Deviation of the surfaces beyond what their noise explains: more is doubted.",
           "ours: real outdoor surfaces show up to 20 mm", 0.001);
    t.real("excess-bad", &S::excess_bad_m, "mm", 0.0, 1000.0, "More than this condemns the pair.",
           "ours: as far as registration takes surfaces for the same", 0.001);
    t.real("weak-good", &S::weak_good_m, "mm", 0.0, 1e5,
           "Two deviations of the place in the direction that is held least: more is doubted.",
           "ours: three cells of the scanner's own resolution", 0.001);
    t.real("weak-bad", &S::weak_bad_m, "mm", 0.0, 1e5, "More than this condemns the pair.", "ours", 0.001);
    t.angle("weak-turn-good", &S::weak_good_rad, 0.0, 180.0, "The same of a turn: more is doubted.",
            "ours: 10 cm at 20 m");
    t.angle("weak-turn-bad", &S::weak_bad_rad, 0.0, 180.0, "More than this condemns the pair.", "ours");
    t.real("pull-good", &S::pull_good_m, "mm", 0.0, 1e5,
           "How far the surfaces still pull the pose: more is doubted.", tuned, 0.001);
    t.real("pull-bad", &S::pull_bad_m, "mm", 0.0, 1e5, "More than this condemns the pair.", tuned, 0.001);
    t.angle("pull-turn-good", &S::pull_good_rad, 0.0, 180.0, "The same of a turn: more is doubted.", tuned);
    t.angle("pull-turn-bad", &S::pull_bad_rad, 0.0, 180.0, "More than this condemns the pair.", tuned);
    t.real("moved-good", &S::moved_good_m, "m", 0.0, 1000.0,
           "How far the pose lies from where registration started: more is doubted.",
           "ours: odometry is rarely further off between two stops");
    t.angle("moved-turn-good", &S::moved_good_rad, 0.0, 180.0, "The same of a turn: more is doubted.",
            "ours");
    t.real(
        "others-good", &S::others_good, "", 0.0, 1000.0,
        "How far a link contradicts the other links, over what they are uncertain by (1 where all is well): "
        "more is doubted.",
        "Baarda 1968: outliers by their normalised residual; 2.5 over 6 degrees of freedom is 1 in 1,000,000 "
        "by "
        "chance");
    t.real("others-bad", &S::others_bad, "", 0.0, 1000.0, "More than this condemns the link.", "ours");
    t.real("others-least", &S::others_least_m, "mm", 0.0, 1e5,
           "A contradiction of less than this, and of a turn of less than the next, is none.",
           "ours: below the 20 mm within which a registration is called right", 0.001);
    t.angle("others-least-turn", &S::others_least_rad, 0.0, 180.0, "The same of a turn.",
            "ours: below the 0.2 deg within which a registration is called right");
    t.real("others-floor", &S::others_floor_m, "mm", 0.0, 1e5,
           "Deviation of every link beside what its registration knows of, where links are compared.",
           "ours: the scanner's systematic error within its specification of 35 mm is shared by both scans "
           "but for a "
           "few mm",
           0.001);
    t.angle("others-floor-turn", &S::others_floor_rad, 0.0, 180.0, "The same of a turn.",
            "ours: 7 mm at 20 m");
    t.real("covariance-cells", &S::covariance_cells, "", 0.01, 1000.0,
           "Covariance of a pose over the inverse of its information, where cells were held against patches.",
           "ours: mean normalised error squared 5.6 of 6 for 366 good pairs of simulated drives, seeds 101 "
           "to 103, "
           "so that nothing is taken off");
    t.real("covariance-patches", &S::covariance_patches, "", 0.01, 1000.0,
           "The same where patches were held against patches.",
           "ours: normalised error squared of simulated drives, seeds 101 to 103, rounded up");
    t.real("covariance-overlap", &S::covariance_overlap, "", 0.0, 1.0,
           "Below this overlap the covariance is multiplied by it over the overlap.",
           "ours: normalised error squared of simulated drives by overlap, seeds 101 to 106: 6.0 of 6 below it");
    return t;
  }();
  return table;
}

}  // namespace tiltmap
