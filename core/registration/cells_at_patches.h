// Whether cells lie on patches: many side by side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/registration/moved_cells.h"
#include "core/registration/patch_disc.h"

namespace tiltmap {

// What a cell on a patch must keep; squares of metres.
struct CellRule {
  float noise_square = 0.0F;        // along the beam
  float floor_square = 0.0F;        // no mean of cells is known better
  float excess_square = 0.0F;       // of surfaces, beyond what their patches tell
  float spot_square = 0.0F;         // rad^2, of the cells' light (patch_spot_rad)
  float most_spread_square = 0.0F;  // m^2, of the strikes of that light along the beam
  float gate_square = 0.0F;         // so many deviations, squared
  float outside_m = 0.0F;           // of a patch's outline, a cell still lies on it
  std::array<float, 3> origin{};    // of the cells' beams, frame of the patches, m
};

// Cells, each with a patch that it is held against. One cell may stand here several times.
struct CellsAtPatches {
  static constexpr std::size_t kMost = 5 * MovedCells::kMost;
  std::array<float, kMost> x, y, z;       // frame of the patches, m
  std::array<float, kMost> count;         // of cells whose mean it is; 0: it is held against nothing
  std::array<std::int32_t, kMost> patch;  // any that exists where it is held against nothing
  std::array<std::uint32_t, kMost> cell;  // whose it is; for the caller
  // The answers: 1 where it lies there and sees the patch's front, else 0; how much too short its range is,
  // as a share of it (shortRange); the variance of one cell along the patch's normal, m^2.
  std::array<float, kMost> lies, share, variance;
};

// Those from `begin` up to `end`, at most kMost, all finite.
void testCells(const PatchDisc* discs, std::size_t begin, std::size_t end, const CellRule& rule,
               CellsAtPatches& cells);

// The first that is painted of the cell at a place of the raster and those around it (PatchRaster::kAround),
// or PatchRaster::kNone.
void firstPainted(const std::uint32_t* raster, const std::int32_t* place, std::size_t count,
                  std::uint32_t* patch);
// Gives the first `count` cells these patches, or nothing where there is none.
void holdAgainst(const std::uint32_t* patch, std::size_t count, CellsAtPatches& cells);

}  // namespace tiltmap
