// What a relaxation over many scans can be told. Every default stands here as a member initialiser, once.
#pragma once

#include "core/base/parameter.h"
#include "core/base/result.h"
#include "core/registration/registration_settings.h"

namespace tiltmap {

enum class RelaxationMethod {
  Joint,       // all overlapping pairs of scans in one least-squares problem
  ActiveSet,   // thesis figure 6.1, after Pulli 1999
  Sequential,  // each scan onto the union of those before it (Chen and Medioni 1992; thesis 6.1)
};

// The registration's values that serve many scans at once. Starts are good already, so the loss begins
// narrower. What is a little wrong the same way in every pair adds up along a drive: cells on depth edges
// (mixed pixels) are left out, and the spot on slanted ground is reckoned with.
RegistrationSettings jointRegistrationSettings();

// Plain data, SI units. Describe and set it through relaxationParameters().
struct RelaxationSettings {
  RelaxationMethod method = RelaxationMethod::Joint;
  // How scans are prepared, paired and weighed. ActiveSet and Sequential run a registration with it; Joint
  // takes its pairing, loss, limits of overlap and agreement, and end of the iteration (an iteration is one
  // step of the whole problem).
  RegistrationSettings registration = jointRegistrationSettings();

  // Joint: which pairs of scans are tried. Elements fall into cubes of the world; scans that share enough of
  // them may overlap, which the measured overlap and agreement then decide.
  double cell_m = 4.0;
  double min_shared_cells = 0.15;  // of the cells of the scan that has fewer
  int max_links_per_scan = 30;     // the best ones by shared cells; a pair stays when either scan wants it

  // ActiveSet (thesis 6.2).
  int neighbour_pairs = 500;          // neighbours have more pairs than this
  double neighbour_distance_m = 0.5;  // of points at most this far apart
  double requeue_translation_m = 0.5;
  double requeue_rotation_rad = 0.5 * kDegree;
  int max_visits = 20;  // of one scan in the queue, which might otherwise never end
};

// Combinations that make no sense are refused with a message; ranges are the table's business.
Status checkSettings(const RelaxationSettings& settings);

// Descriptions (the registration's among them), and the presets "default", "thesis" and "sequential".
const ParameterTable<RelaxationSettings>& relaxationParameters();
RelaxationSettings thesisRelaxationSettings();

}  // namespace tiltmap
