// The SICK LMS-291's beam in a simulated site: footprint, noise, steps, codes and timing.
#pragma once

#include <functional>
#include <vector>

#include "core/base/random.h"
#include "core/geometry/pose.h"
#include "core/scan/range_image.h"
#include "core/scan/scanner_geometry.h"
#include "core/world/site.h"

namespace tiltmap {

// Figures of the LMS 200/211/221/291 technical description: the spot is about 16 mm wide at
// the window and grows by 11.9 mrad, so that at 10 m it is wider than the 0.5 deg between beams; 10 %
// reflectivity is seen to 20, 25, 30 or 42 m as configured, and outdoors one takes the most.
struct LmsBeam {
  double spot_m = 0.016;
  double divergence_rad = 0.0119;  // full angle
  double noise_m = 0.012;          // standard deviation of one range; 0: none
  double resolution_m = 0.01;      // ranges come in whole multiples; 0: not rounded
  double maximum_range_m = 80.0;   // further strikes give code 8183
  double pulse_m = 2.5;            // strikes nearer together than this melt into one pulse (mixed pixels)
  double sensitivity_m = 42.0;     // where a 10 % target facing the beam is just seen
  double turn_s = 0.01332;         // one turn of the mirror
  bool interlaced = true;          // a turn measures whole degrees, as the LMS 2xx; else all beams
};

// What one beam brings home: a printed range, or the code for none.
struct Echo {
  float range_m = 0.0F;  // 0 where there is none
  CellCode code = cell_code::kLmsNoSignal;
  float intensity =
      0.0F;  // reflectivity, 0 to 255 in whole steps as the scanner's byte; 0 where there is none
};

// Tilt of the scanner (as read back: before tilt_zero) at a time, radians; seconds on the clock of
// start_time_s.
using TiltFunction = std::function<double(double time_s)>;

// When a beam is fired, seconds after the start of its line. A turn of the mirror measures whole degrees;
// finer spacings take several turns, one after the other: at 0.5 deg the even beams, then 13.32 ms later the
// odd ones.
double beamDelay(const ScannerGeometry& geometry, const LmsBeam& beam, int column);
// From the first beam's turn to the last one's end.
double lineDuration(const ScannerGeometry& geometry, const LmsBeam& beam);

// One line: an echo per column, each beam cast at the tilt of its own instant. Equal arguments, equal echoes.
std::vector<Echo> castLine(const Site& site, const Pose& site_from_scan, const ScannerGeometry& geometry,
                           const TiltFunction& tilt, double start_time_s, RandomStream random,
                           const LmsBeam& beam = {});

// The pulse of a single beam without noise, rounding and drop-out: footprint, mixed strikes, received energy.
struct Pulse {
  bool any = false;
  double range_m = 0.0;       // from the mirror centre
  double reflectivity = 0.0;  // mean of what was struck
  double energy = 0.0;        // 1 at the least that is seen
};
Pulse castPulse(const Site& site, const Ray& axis, const Eigen::Vector3d& across, const LmsBeam& beam);

}  // namespace tiltmap
