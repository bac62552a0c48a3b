#include "core/registration/cell_refinement.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/registration/moved_cells.h"
#include "core/registration/normal_equations.h"

namespace tiltmap {

namespace {

constexpr float kCellFloor_m = 0.0015F;  // no mean of cells is known better
constexpr float kGate = 16.0F;           // four deviations, squared
constexpr float kMostShort_m = 0.1F;     // that a slanted surface's range is
constexpr float kOutside_m = 0.15F;      // of its outline, a cell still lies on a patch
constexpr double kFewestCells = 1.0;
constexpr int kMostMotions = 4;

// Sums over the cells on one patch.
struct Bin {
  double x = 0.0, y = 0.0, z = 0.0, count = 0.0, variance = 0.0;
};

// Where one scan's cells are held against the other's patches.
class Binning {
 public:
  Binning(const PreparedScan& patches, const PreparedScan& cells, const Pose& patches_from_cells,
          double excess_m, const RegistrationSettings& settings)
      : elements_(patches.elements),
        discs_(patches.discs),
        raster_(*patches.raster),
        pose_(patches_from_cells),
        motion_(patches_from_cells),
        noise_square_(static_cast<float>(settings.patch_noise_m * settings.patch_noise_m)),
        excess_square_(static_cast<float>(excess_m * excess_m)),
        spot_square_(static_cast<float>(cells.spot_rad * cells.spot_rad)),
        most_square_(2.0F * (kGate * (noise_square_ + kCellFloor_m * kCellFloor_m + excess_square_) +
                             kMostShort_m * kMostShort_m)),
        bins_(patches.discs.size()) {}

  void add(const CellSamples& cells) {
    MovedCells moved;
    for (std::size_t begin = 0; begin < cells.size(); begin += MovedCells::kMost) {
      const std::size_t count = std::min(MovedCells::kMost, cells.size() - begin);
      moveCells(cells, begin, count, motion_, moved);
      for (std::size_t i = 0; i < count; ++i) give(cells, begin + i, moved, i);
    }
  }

  void appendTo(std::vector<CellsOnPatch>& out, bool of_fixed) const {
    const Eigen::Matrix3d rotation = pose_.rotation();
    for (std::size_t patch = 0; patch < bins_.size(); ++patch) {
      const Bin& bin = bins_[patch];
      if (bin.count < kFewestCells) continue;
      const double share = 1.0 / bin.count;
      CellsOnPatch on{static_cast<std::uint32_t>(patch), of_fixed, bin.count,
                      share * Eigen::Vector3d(bin.x, bin.y, bin.z), share * share * bin.variance};
      const PatchShape& shape = elements_.shape[patch];
      const Eigen::Vector3d& centre = elements_.position[patch];
      const Eigen::Vector3d d = rotation * on.mean + pose_.translation() - centre;
      const double u = d.dot(shape.u), v = d.dot(shape.v);
      on.normal = elements_.normal[patch];
      on.offset_m = on.normal.dot(centre);
      on.plane_variance_m2 =
          shape.offset_variance_m2 + u * u * shape.tilt_variance_u + v * v * shape.tilt_variance_v;
      on.slope_variance = 0.5 * (shape.tilt_variance_u + shape.tilt_variance_v);
      out.push_back(on);
    }
  }

 private:
  void give(const CellSamples& cells, std::size_t cell, const MovedCells& moved, std::size_t i) {
    const float x = moved.x[i], y = moved.y[i], z = moved.z[i];
    if (!(x * x + y * y + z * z > 1e-12F)) return;
    const float n = cells.count[cell];
    const float ray_x = x - motion_.m[9], ray_y = y - motion_.m[10], ray_z = z - motion_.m[11];
    const float range_square = ray_x * ray_x + ray_y * ray_y + ray_z * ray_z;
    raster_.aroundIndex(moved.place[i], 1, [&](std::uint32_t patch) {
      const PatchDisc& disc = discs_[patch];
      const float dx = x - disc.x, dy = y - disc.y, dz = z - disc.z;
      // Most of what is on another surface is told by this alone.
      const float across = dx * disc.nx + dy * disc.ny + dz * disc.nz;
      if (across * across > most_square_ + 2.0F * kGate * disc.offset_variance) return true;
      const float u = std::abs(dx * disc.ux + dy * disc.uy + dz * disc.uz);
      const float v = std::abs(dx * disc.vx + dy * disc.vy + dz * disc.vz);
      if (u > disc.reach_u + kOutside_m || v > disc.reach_v + kOutside_m) return true;
      const float towards = ray_x * disc.nx + ray_y * disc.ny + ray_z * disc.nz;
      if (!(towards < 0.0F)) return true;
      const float cos_square = towards * towards / range_square;
      const float variance = noise_square_ * cos_square + kCellFloor_m * kCellFloor_m;
      // How much too short a slanted surface's range is (see shortRange), as a share of it.
      const float share = spot_square_ > 0.0F ? spot_square_ * (1.0F - cos_square) / cos_square : 0.0F;
      const float off = across + share * towards;
      if (off * off > kGate * (variance / n + excess_square_ + disc.offset_variance)) return true;
      Bin& bin = bins_[patch];
      const double w = static_cast<double>(n) * (1.0 + static_cast<double>(share));
      bin.x += w * static_cast<double>(cells.x[cell]);
      bin.y += w * static_cast<double>(cells.y[cell]);
      bin.z += w * static_cast<double>(cells.z[cell]);
      bin.count += static_cast<double>(n);
      bin.variance += static_cast<double>(n * variance);
      return false;
    });
  }

  const SurfaceElements& elements_;
  std::span<const PatchDisc> discs_;
  const PatchRaster& raster_;
  Pose pose_;
  FloatPose motion_;
  float noise_square_, excess_square_, spot_square_;
  float most_square_;  // across, whatever the incidence, but for the patch's own variance
  std::vector<Bin> bins_;
};

bool canRefine(const PreparedScan& fixed, const PreparedScan& moving) {
  return fixed.raster && moving.raster && !fixed.discs.empty() && !moving.discs.empty();
}

}  // namespace

std::vector<CellsOnPatch> cellsOnPatches(const PreparedScan& fixed, const PreparedScan& moving,
                                         const Pose& fixed_from_moving, double excess_m,
                                         const RegistrationSettings& settings) {
  std::vector<CellsOnPatch> cells;
  if (!canRefine(fixed, moving)) return cells;
  cells.reserve(fixed.discs.size() + moving.discs.size());
  Binning on_fixed(fixed, moving, fixed_from_moving, excess_m, settings);
  on_fixed.add(moving.cells);
  on_fixed.appendTo(cells, true);
  Binning on_moving(moving, fixed, fixed_from_moving.inverse(), excess_m, settings);
  on_moving.add(fixed.cells);
  on_moving.appendTo(cells, false);
  return cells;
}

void lineariseCells(const Pose& fixed_from_moving, const std::vector<CellsOnPatch>& cells, double excess_m,
                    double deviations, LinearSystem& system) {
  const Eigen::Matrix3d rotation = fixed_from_moving.rotation();
  const Eigen::Vector3d shift = fixed_from_moving.translation();
  const double excess = excess_m * excess_m, square_of_loss = deviations * deviations;
  NormalEquations sums;
  for (const CellsOnPatch& on : cells) {
    // A motion of the moving scan moves the cells, or the patch: the second is the negative of the first.
    Eigen::Vector3d normal, p;
    double r = 0.0;
    if (on.of_fixed) {
      p = rotation * on.mean + shift;
      normal = on.normal;
      r = normal.dot(p) - on.offset_m;
    } else {
      p = on.mean;
      normal = -(rotation * on.normal);
      r = normal.dot(shift - p) - on.offset_m;
    }
    const double variance = on.variance_m2 + on.plane_variance_m2 + excess;
    const double loss = gemanMcClureWeight(r * r, square_of_loss * variance);
    const double w = 0.5 * loss / variance;
    sums.add(p.cross(normal), normal, w, r);
    system.loss_weight += w;
    system.loss_square_m2 += w * r * r;
    system.plane_weight += w;
    system.moment += w * p;
    system.square_moment += w * p.squaredNorm();
    system.slope_noise += w * on.slope_variance;
  }
  system.pairs += cells.size();
  sums.addTo(system);
}

Refined refined(const PreparedScan& fixed, const PreparedScan& moving, const Pose& fixed_from_moving,
                double excess_m, const RegistrationSettings& settings) {
  Refined result;
  result.fixed_from_moving = fixed_from_moving;
  const std::vector<CellsOnPatch> cells =
      cellsOnPatches(fixed, moving, fixed_from_moving, excess_m, settings);
  result.patches = cells.size();
  for (const CellsOnPatch& on : cells) result.cells += on.cells;
  for (int motion = 0; motion < kMostMotions; ++motion) {
    result.system = {};
    lineariseCells(result.fixed_from_moving, cells, excess_m, settings.refine_deviations, result.system);
    const Vector6d step = solvedStep(result.system, conditioningOf(result.system, settings.min_eigenvalue));
    result.fixed_from_moving = result.fixed_from_moving.moved(step);
    if (step.head<3>().norm() < settings.min_rotation_rad &&
        step.tail<3>().norm() < settings.min_translation_m)
      break;
  }
  return result;
}

}  // namespace tiltmap
