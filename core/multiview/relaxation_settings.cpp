#include "core/multiview/relaxation_settings.h"

namespace tiltmap {

namespace {

using S = RelaxationSettings;
using Table = ParameterTable<RelaxationSettings>;

void addJoint(Table& t) {
  t.real("cell", &S::cell_m, "m", 0.1, 100.0,
         "Joint: edge of the cubes of the world by which scans that may overlap are found.", "ours");
  t.real("min-shared-cells", &S::min_shared_cells, "", 0.0, 1.0,
         "Joint: scans that share a smaller part of their cubes are not tried as a pair.", "ours");
  t.integer("max-links", &S::max_links_per_scan, "", 1, 100000,
            "Joint: pairs a scan takes part in, the best by shared cubes. Fewer are faster, more hold a loop "
            "better.",
            "ours");
}

void addActiveSet(Table& t) {
  t.integer("neighbour-pairs", &S::neighbour_pairs, "", 0, 1000000,
            "Active-set: two scans are neighbours when more pairs of points lie close together.",
            "thesis 6.2: 500");
  t.real("neighbour-distance", &S::neighbour_distance_m, "m", 0.001, 100.0,
         "Active-set: how close, by distance alone.", "thesis 6.2: 0.5 m");
  t.real("requeue-translation", &S::requeue_translation_m, "m", 0.0, 100.0,
         "Active-set: a scan that moves further, or turns more than requeue-rotation, queues its neighbours. "
         "Small values may never settle.",
         "thesis 6.2: 0.5 m");
  t.angle("requeue-rotation", &S::requeue_rotation_rad, 0.0, 180.0, "Active-set: see requeue-translation.",
          "thesis 6.2: 0.5 deg");
  t.integer("max-visits", &S::max_visits, "", 1, 1000000,
            "Active-set: how often one scan may come up in the queue, which might otherwise never end.",
            "ours");
}

}  // namespace

RegistrationSettings jointRegistrationSettings() {
  RegistrationSettings s;
  s.patch_drop_edges = true;
  s.patch_spot_rad = 0.16 * kDegree;
  s.loss_start_m = 0.5;
  s.loss_factor = 0.5;
  s.min_translation_m = 1e-4;
  s.min_rotation_rad = 1e-5;
  s.min_overlap = 0.2;
  s.min_agreement = 0.5;
  return s;
}

RelaxationSettings thesisRelaxationSettings() {
  RelaxationSettings s;
  s.method = RelaxationMethod::ActiveSet;
  s.registration = thesisSettings();
  return s;
}

Status checkSettings(const RelaxationSettings& s) {
  if (Status status = checkSettings(s.registration); !status) return status;
  if (s.method == RelaxationMethod::Joint && s.registration.motion != MotionMethod::PointToPlane &&
      s.registration.motion != MotionMethod::PlaneToPlane)
    return fail("the closed forms move one scan at a time, so they cannot solve for all scans together",
                "relax",
                "choose motion plane-to-plane or point-to-plane, or method active-set or sequential");
  if (s.method == RelaxationMethod::Joint && s.registration.statistics)
    return fail("statistics keep one distance bound for a single pair of scans", "relax",
                "turn statistics off, or choose method active-set or sequential");
  return {};
}

const ParameterTable<RelaxationSettings>& relaxationParameters() {
  static const Table table = [] {
    Table t("relax");
    t.choice("method", &S::method,
             {{"joint", RelaxationMethod::Joint},
              {"active-set", RelaxationMethod::ActiveSet},
              {"sequential", RelaxationMethod::Sequential}},
             "All overlapping pairs of scans in one least-squares problem, or scan after scan with the "
             "thesis' active set and queue, or each scan onto the union of those before it (the baseline).",
             "joint ours; thesis 6.2, Pulli 1999; Chen and Medioni 1992");
    addJoint(t);
    addActiveSet(t);
    t.preset("thesis", "the method as printed, for teaching and comparison", thesisRelaxationSettings());
    RelaxationSettings sequential;
    sequential.method = RelaxationMethod::Sequential;
    sequential.registration = RegistrationSettings();
    t.preset("sequential", "each scan onto the union of those before it: accumulates error, the baseline",
             sequential);
    t.include(registrationParameters(), &S::registration);
    return t;
  }();
  return table;
}

}  // namespace tiltmap
