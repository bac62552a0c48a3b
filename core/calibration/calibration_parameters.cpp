#include "core/calibration/calibrate.h"

namespace tiltmap {

const ParameterTable<CalibrationSettings>& calibrationParameters() {
  using S = CalibrationSettings;
  static const ParameterTable<S> table = [] {
    ParameterTable<S> t("calibrate");
    t.boolean("tilt-zero", &S::tilt_zero,
              "Estimate what is added to every tilt angle, from the ground that the machine stood on.",
              "ours");
    t.boolean("lever-arm", &S::lever_arm, "Estimate the mirror's place off the tilt axis (y and z).", "ours");
    t.boolean("mounting", &S::mounting, "Estimate how the scanner sits turned on the tilt bracket (y and z).",
              "ours");
    t.boolean("range-offset", &S::range_offset, "Estimate what is added to every range.", "ours");
    t.real("ground-radius", &S::ground_radius_m, "m", 0.3, 5.0,
           "Ground within this of the machine's foot is what it stands on. Small: few points; large: ground "
           "that bends.",
           "ours");
    t.angle("angle-limit", &S::angle_limit_rad, 0.001, 10.0,
            "An angle that is known worse (one sigma) is reported as not told and left as it was.", "ours");
    t.real("length-limit", &S::length_limit_m, "mm", 0.1, 1000.0, "The same for lengths.", "ours", 0.001);
    return t;
  }();
  return table;
}

}  // namespace tiltmap
