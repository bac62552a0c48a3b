// The tilt of each beam of lines that were measured while the tilt moved on.
//
// A line takes one turn of the mirror, or several: an LMS measures whole degrees in a turn, so that at 0.5
// deg the odd beams are fired a turn (13.32 ms) after the even ones. Where the tilt moves steadily, a beam's
// tilt is
//
//   tilt at the end of the line + way in a turn * (turns from the line's begin to the beam - turns of the
//   line)
//
// RangeImageData::line_tilt_rad then has twice as many entries as there are rows: behind the tilts at the end
// of each line, its way in a turn (radians, positive up; 0 for lines that were measured standing still).
#pragma once

#include <vector>

#include "core/scan/range_image.h"

namespace tiltmap {

// By the spacing of the beams: 1 for whole degrees, 2 for half and 4 for quarter ones. That is how an LMS 2xx
// does it, which sees half a circle at most; scanners that see more fire all beams in one turn.
int mirrorTurns(const ScannerGeometry& geometry);
// When a beam is fired, in turns of the mirror since its line began.
double beamTurns(const ScannerGeometry& geometry, int column);

bool tiltMoved(const RangeImage& image);
// 0 where the tilt stood.
double lineTurnTilt(const RangeImage& image, int row);
// As lineTilt(), before tilt_zero, but of one beam.
double beamTilt(const RangeImage& image, const ScannerGeometry& geometry, int row, int column);

// Ways in a turn for all rows of data whose line tilts are there already.
void setTurnTilts(RangeImageData& data, const std::vector<double>& turn_tilt_rad);
// The same ranges with every beam of a line at the tilt of the line's middle: what the lines would be taken
// for if nobody knew that the tilt moved.
Result<RangeImagePtr> withoutBeamTilts(const RangeImage& image, const ScannerGeometry& geometry);

// Cosines and sines of the whole tilts (with tilt_zero) of the beams, row by row.
class BeamTilts {
 public:
  BeamTilts(const RangeImage& image, const ScannerGeometry& geometry);
  void setRow(int row);
  double cosine(std::size_t column) const { return cosine_[column]; }
  double sine(std::size_t column) const { return sine_[column]; }

 private:
  const RangeImage& image_;
  double tilt_zero_rad_;
  std::vector<double> turns_;  // of each column, counted back from the end of the line
  double way_rad_ = 0.0;       // that the next two are for
  std::vector<double> offset_cosine_, offset_sine_;
  std::vector<double> cosine_, sine_;
};

}  // namespace tiltmap
