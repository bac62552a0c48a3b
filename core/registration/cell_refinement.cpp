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
      : discs_(patches.discs),
        raster_(*patches.raster),
        motion_(patches_from_cells),
        noise_square_(static_cast<float>(settings.patch_noise_m * settings.patch_noise_m)),
        excess_square_(static_cast<float>(excess_m * excess_m)),
        spot_square_(static_cast<float>(cells.spot_rad * cells.spot_rad)),
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
    for (std::size_t patch = 0; patch < bins_.size(); ++patch) {
      const Bin& bin = bins_[patch];
      if (bin.count < kFewestCells) continue;
      out.push_back({static_cast<std::uint32_t>(patch), of_fixed, bin.count,
                     Eigen::Vector3d(bin.x, bin.y, bin.z) / bin.count,
                     bin.variance / (bin.count * bin.count)});
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
      const float u = std::abs(dx * disc.ux + dy * disc.uy + dz * disc.uz);
      const float v = std::abs(dx * disc.vx + dy * disc.vy + dz * disc.vz);
      if (u > disc.reach_u + kOutside_m || v > disc.reach_v + kOutside_m) return true;
      const float towards = ray_x * disc.nx + ray_y * disc.ny + ray_z * disc.nz;
      if (!(towards < 0.0F)) return true;
      const float cos_square = towards * towards / range_square;
      const float variance = noise_square_ * cos_square + kCellFloor_m * kCellFloor_m;
      const float across = dx * disc.nx + dy * disc.ny + dz * disc.nz;
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

  std::span<const PatchDisc> discs_;
  const PatchRaster& raster_;
  FloatPose motion_;
  float noise_square_, excess_square_, spot_square_;
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

void lineariseCells(const PreparedScan& fixed, const PreparedScan& moving, const Pose& fixed_from_moving,
                    const std::vector<CellsOnPatch>& cells, double excess_m, double deviations,
                    LinearSystem& system) {
  const Eigen::Matrix3d rotation = fixed_from_moving.rotation(), rotation_back = rotation.transpose();
  const Eigen::Vector3d shift = fixed_from_moving.translation(), shift_back = -(rotation_back * shift);
  NormalEquations sums;
  for (const CellsOnPatch& on : cells) {
    const SurfaceElements& elements = on.of_fixed ? fixed.elements : moving.elements;
    const PatchShape& shape = elements.shape[on.patch];
    const Eigen::Vector3d m = on.of_fixed ? rotation * on.mean + shift : rotation_back * on.mean + shift_back;
    const Eigen::Vector3d d = m - elements.position[on.patch];
    const double u = d.dot(shape.u), v = d.dot(shape.v);
    const double variance = on.variance_m2 + shape.offset_variance_m2 + u * u * shape.tilt_variance_u +
                            v * v * shape.tilt_variance_v + excess_m * excess_m;
    const double r = elements.normal[on.patch].dot(d);
    const double loss = gemanMcClureWeight(r * r, deviations * deviations * variance);
    // A motion of the moving scan moves the cells, or the patch: the second is the negative of the first.
    const Eigen::Vector3d normal =
        on.of_fixed ? elements.normal[on.patch] : Eigen::Vector3d(-(rotation * elements.normal[on.patch]));
    const Eigen::Vector3d p = on.of_fixed ? m : on.mean;
    const double w = 0.5 * loss / variance;
    sums.add(p.cross(normal), normal, w, r);
    ++system.pairs;
    system.loss_weight += w;
    system.loss_square_m2 += w * r * r;
    system.plane_weight += w;
    system.moment += w * p;
    system.square_moment += w * p.squaredNorm();
    system.slope_noise += w * 0.5 * (shape.tilt_variance_u + shape.tilt_variance_v);
  }
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
    lineariseCells(fixed, moving, result.fixed_from_moving, cells, excess_m, settings.refine_deviations,
                   result.system);
    const Vector6d step = solvedStep(result.system, conditioningOf(result.system, settings.min_eigenvalue));
    result.fixed_from_moving = result.fixed_from_moving.moved(step);
    if (step.head<3>().norm() < settings.min_rotation_rad &&
        step.tail<3>().norm() < settings.min_translation_m)
      break;
  }
  return result;
}

}  // namespace tiltmap
