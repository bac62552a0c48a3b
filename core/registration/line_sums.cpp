// In a file of its own for its compiler options: no products joined with sums, so that every instruction set
// gives the same bits, and no care for numbers that are not finite.
#include "core/registration/line_sums.h"

#include <cmath>

#include "core/base/clones.h"
#include "core/registration/patch_raster.h"

namespace tiltmap {

namespace {

constexpr float kBend_m = 0.2F;

template <std::size_t kColumns>
inline void sumTilesOf(const float* __restrict used, const double* __restrict across,
                       const double* __restrict ahead, std::size_t tiles, std::size_t columns,
                       double* __restrict sums) {
  const std::size_t width = kColumns > 0 ? kColumns : columns;
  double *n = sums, *c = n + tiles, *s = c + tiles, *cc = s + tiles, *cs = cc + tiles, *ss = cs + tiles;
  for (std::size_t t = 0; t < tiles; ++t) {
    float count = 0.0F;
    double sum_c = 0.0, sum_s = 0.0, sum_cc = 0.0, sum_cs = 0.0, sum_ss = 0.0;
    for (std::size_t j = 0; j < width; ++j) {
      const double a = across[t * width + j], b = ahead[t * width + j];
      count += used[t * width + j];
      sum_c += a, sum_s += b;
      sum_cc += a * a, sum_cs += a * b, sum_ss += b * b;
    }
    n[t] = static_cast<double>(count), c[t] = sum_c, s[t] = sum_s;
    cc[t] = sum_cc, cs[t] = sum_cs, ss[t] = sum_ss;
  }
}

}  // namespace

TILTMAP_CLONES
void invertRanges(const float* __restrict range_m, const CellCode* __restrict code, std::size_t count,
                  float offset_m, float* __restrict inverse) {
  for (std::size_t k = 0; k < count; ++k) {
    const bool has_point = cell_code::hasPoint(code[k]);
    const float range = has_point ? range_m[k] + offset_m : 1.0F;
    inverse[k] = has_point ? 1.0F / range : 0.0F;
  }
}

TILTMAP_CLONES
void chooseCells(const float* __restrict before, const float* __restrict here, const float* __restrict after,
                 std::size_t count, const BendRule& rule, float* __restrict used) {
  const float two_cos_azimuth = rule.two_cos_azimuth, two_cos_tilt = rule.two_cos_tilt;
  const float scale = 1.0F / static_cast<float>(rule.apart * rule.apart);
  const float *left = here - rule.apart, *right = here + rule.apart;
  for (std::size_t k = 0; k < count; ++k) {
    const float q = here[k];
    const float along = scale * std::abs(left[k] + right[k] - two_cos_azimuth * q);
    const float lines = std::abs(before[k] + after[k] - two_cos_tilt * q);
    // |bend| r^2 below the bound; a cell without a point fails on 0 < 0.
    const float bend = along > lines ? along : lines;
    used[k] = bend < kBend_m * q * q ? 1.0F : 0.0F;
  }
}

TILTMAP_CLONES
void placeInLine(const float* __restrict used, const float* __restrict range_m, std::size_t count,
                 double offset_m, const double* __restrict cosine, const double* __restrict sine,
                 double* __restrict across, double* __restrict ahead) {
  for (std::size_t k = 0; k < count; ++k) {
    const double range = static_cast<double>(used[k]) * (static_cast<double>(range_m[k]) + offset_m);
    across[k] = range * cosine[k];
    ahead[k] = range * sine[k];
  }
}

TILTMAP_CLONES
void placeInSpace(const double* __restrict across, const double* __restrict ahead, std::size_t count,
                  const LineFrame& frame, float* __restrict x, float* __restrict y, float* __restrict z) {
  const LineFrame f = frame;
  for (std::size_t k = 0; k < count; ++k) {
    const double a = across[k], b = ahead[k];
    x[k] = static_cast<float>(f.start[0] + a * f.across[0] + b * f.ahead[0]);
    y[k] = static_cast<float>(f.start[1] + a * f.across[1] + b * f.ahead[1]);
    z[k] = static_cast<float>(f.start[2] + a * f.across[2] + b * f.ahead[2]);
  }
}

TILTMAP_CLONES
void sumTiles(const float* used, const double* across, const double* ahead, std::size_t tiles,
              std::size_t tile_columns, double* sums) {
  if (tile_columns == 4)
    sumTilesOf<4>(used, across, ahead, tiles, tile_columns, sums);
  else
    sumTilesOf<0>(used, across, ahead, tiles, tile_columns, sums);
}

TILTMAP_CLONES
void addLineSums(const double* __restrict sums, std::size_t tiles, const LineToMoments& by, bool has_arm,
                 double* __restrict moments) {
  const double *n = sums, *c = n + tiles, *s = c + tiles, *cc = s + tiles, *cs = cc + tiles, *ss = cs + tiles;
  for (std::size_t t = 0; t < tiles; ++t) moments[t] += n[t];
  for (std::size_t m = 1; m < kTileMoments; ++m) {
    double* __restrict out = moments + m * tiles;
    const std::array<double, kLineSums> f = by[m];
    if (has_arm)
      for (std::size_t t = 0; t < tiles; ++t)
        out[t] += f[3] * cc[t] + f[4] * cs[t] + f[5] * ss[t] + (f[1] * c[t] + f[2] * s[t]) + f[0] * n[t];
    else if (m < 4)
      for (std::size_t t = 0; t < tiles; ++t) out[t] += f[1] * c[t] + f[2] * s[t];
    else
      for (std::size_t t = 0; t < tiles; ++t) out[t] += f[3] * cc[t] + f[4] * cs[t] + f[5] * ss[t];
  }
}

TILTMAP_CLONES
void placeTiles(const double* __restrict moments, std::size_t tiles, std::int32_t* __restrict place) {
  const double *n = moments, *x = n + tiles, *y = x + tiles, *z = y + tiles;
  for (std::size_t t = 0; t < tiles; ++t) {
    const float up = n[t] > 0.0 ? static_cast<float>(z[t]) : 1.0F;
    place[t] = PatchRaster::indexOf(static_cast<float>(x[t]), static_cast<float>(y[t]), up);
  }
}

}  // namespace tiltmap
