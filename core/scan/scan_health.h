// Whether a sweep saw what it should have: cells without an answer, a dirty window, things that stand in the
// way.
#pragma once

#include <string>
#include <vector>

#include "core/scan/range_image.h"

namespace tiltmap {

struct ScanHealthSettings {
  double sector_rad = 10.0 * kDegree;  // of the beams' azimuth
  double short_m = 0.4;                // nearer is the window or the machine itself, not the site
  double near_m = 2.5;                 // nearer hides the view
  double level_rad = 10.0 * kDegree;   // the view: beams within this of the scan frame's horizon
  // A sector is bad where more than this share of its beams is short or without an answer.
  double most_bad_beams = 0.5;
  // A scan is bad where more of all its beams are without an answer.
  double most_dead = 0.15;
  // And where more of the view is hidden.
  double most_hidden = 0.6;
};

// Of the beams of one sector, or of all: shares 0 to 1. Masked cells (the machine's own body) count nowhere.
struct BeamShares {
  double dead = 0.0;     // missing, dazzled or line not scanned
  double dazzled = 0.0;  // of those, by light
  double too_short = 0.0;
  double silent =
      0.0;  // of the beams that look down by at least level_rad: nothing came back, though there is ground
};

struct SectorHealth {
  double from_rad = 0.0, to_rad = 0.0;  // azimuth: 0 right, pi left
  BeamShares shares;
  bool bad = false;
};

struct ScanHealth {
  BeamShares shares;
  std::vector<SectorHealth> sectors;  // from right to left; empty where the scan is no regular matrix
  double hidden = 0.0;                // share of the view that ends nearer than near_m
  int lines = 0;                      // scanned
  bool good = true;
  std::string reason;  // where it is not good: what is wrong, and what to do
};

// `image` may be part of a sweep: only scanned lines count then, unless `whole`.
ScanHealth scanHealth(const RangeImage& image, const ScannerGeometry& geometry, bool whole = true,
                      const ScanHealthSettings& settings = {});

}  // namespace tiltmap
