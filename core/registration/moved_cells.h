// Many cells or patches brought into the frame of another scan at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/geometry/pose.h"
#include "core/registration/cell_samples.h"

namespace tiltmap {

// A pose in the numbers of the loop below.
struct FloatPose {
  std::array<float, 12> m;  // rotation by rows, then the translation, m

  explicit FloatPose(const Pose& pose);
};

struct MovedCells {
  static constexpr std::size_t kMost = 256;
  std::array<float, kMost> x, y, z;       // m
  std::array<std::int32_t, kMost> place;  // in the raster of the other scan (PatchRaster::indexOf)
};

struct MovedPatches {
  static constexpr std::size_t kMost = 256;
  std::array<float, kMost> x, y, z, nx, ny, nz;  // centre, m, and normal
  std::array<std::int32_t, kMost> place;         // as of cells
};

// `count` cells from `begin` on, at most kMost, all finite.
void moveCells(const CellSamples& cells, std::size_t begin, std::size_t count, const FloatPose& pose,
               MovedCells& out);
// The first `count` of them, at most kMost, all finite, in their place.
void movePatches(std::size_t count, const FloatPose& pose, MovedPatches& patches);

}  // namespace tiltmap
