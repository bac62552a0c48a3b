#include "core/registration/cell_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/registration/cells_at_patches.h"
#include "core/registration/moved_cells.h"
#include "core/registration/normal_equations.h"

namespace tiltmap {

namespace {

constexpr float kCellFloor_m = 0.0015F;  // no mean of cells is known better
constexpr float kGate = 16.0F;           // four deviations, squared
// Deviation along the beam of a slanted surface's strikes: as far as the shortness is understood
// (shortRange).
constexpr float kMostSpread_m = 0.5F;
constexpr float kOutside_m = 0.15F;  // of its outline, a cell still lies on a patch
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
        bins_(patches.discs.size()) {
    rule_.noise_square = static_cast<float>(settings.patch_noise_m * settings.patch_noise_m);
    rule_.floor_square = kCellFloor_m * kCellFloor_m;
    rule_.excess_square = static_cast<float>(excess_m * excess_m);
    rule_.spot_square = static_cast<float>(cells.spot_rad * cells.spot_rad);
    rule_.most_spread_square = kMostSpread_m * kMostSpread_m;
    rule_.gate_square = kGate;
    rule_.outside_m = kOutside_m;
    rule_.origin = {motion_.m[9], motion_.m[10], motion_.m[11]};
  }

  void add(const CellSamples& cells) {
    for (std::size_t begin = 0; begin < cells.size(); begin += MovedCells::kMost) {
      const std::size_t count = std::min(MovedCells::kMost, cells.size() - begin);
      moveCells(cells, begin, count, motion_, moved_);
      give(cells, begin, count);
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
  // First to the patch in a cell's own direction, then, where it does not lie there, to the first of those
  // around on which it does.
  void give(const CellSamples& cells, std::size_t begin, std::size_t count) {
    std::copy_n(moved_.x.begin(), count, at_.x.begin());
    std::copy_n(moved_.y.begin(), count, at_.y.begin());
    std::copy_n(moved_.z.begin(), count, at_.z.begin());
    std::copy_n(cells.count.begin() + static_cast<std::ptrdiff_t>(begin), count, at_.count.begin());
    firstPainted(raster_.data(), moved_.place.data(), count, at_.cell.data());
    holdAgainst(at_.cell.data(), count, at_);
    std::size_t held = 0;
    for (std::size_t first = 0; first < count; first += kSideBySide) {
      const std::size_t last = std::min(first + kSideBySide, count);
      // Where scans hardly overlap, most cells are where the other saw nothing.
      if (std::none_of(at_.count.begin() + static_cast<std::ptrdiff_t>(first),
                       at_.count.begin() + static_cast<std::ptrdiff_t>(last),
                       [](float cells_there) { return cells_there > 0.0F; }))
        continue;
      testCells(discs_.data(), first, last, rule_, at_);
      for (std::size_t i = first; i < last; ++i) {
        if (at_.lies[i] > 0.0F)
          lay(cells, begin + i, at_, i);
        else if (at_.count[i] > 0.0F)
          held = holdAround(i, held);
      }
    }
    testCells(discs_.data(), 0, held, rule_, around_);
    std::uint32_t laid = kNobody;
    for (std::size_t h = 0; h < held; ++h) {
      if (!(around_.lies[h] > 0.0F) || around_.cell[h] == laid) continue;
      laid = around_.cell[h];
      lay(cells, begin + laid, around_, h);
    }
  }

  // Notes the patches around the one that the cell does not lie on; without branches.
  std::size_t holdAround(std::size_t i, std::size_t held) {
    auto last = static_cast<std::uint32_t>(at_.patch[i]);
    const std::uint32_t* here = raster_.data() + moved_.place[i];
    for (const std::int32_t neighbour : PatchRaster::kAround) {
      const std::uint32_t patch = here[neighbour];
      const bool painted = patch != PatchRaster::kNone;
      around_.x[held] = at_.x[i], around_.y[held] = at_.y[i], around_.z[held] = at_.z[i];
      around_.count[held] = at_.count[i];
      around_.patch[held] = static_cast<std::int32_t>(patch);
      around_.cell[held] = static_cast<std::uint32_t>(i);
      held += painted && patch != last ? 1 : 0;
      last = painted ? patch : last;
    }
    return held;
  }

  void lay(const CellSamples& cells, std::size_t cell, const CellsAtPatches& held, std::size_t at) {
    Bin& bin = bins_[static_cast<std::size_t>(held.patch[at])];
    const auto n = static_cast<double>(cells.count[cell]);
    const double w = n * (1.0 + static_cast<double>(held.share[at]));
    bin.x += w * static_cast<double>(cells.x[cell]);
    bin.y += w * static_cast<double>(cells.y[cell]);
    bin.z += w * static_cast<double>(cells.z[cell]);
    bin.count += n;
    bin.variance += n * static_cast<double>(held.variance[at]);
  }

  const SurfaceElements& elements_;
  std::span<const PatchDisc> discs_;
  const PatchRaster& raster_;
  Pose pose_;
  FloatPose motion_;
  CellRule rule_;
  std::vector<Bin> bins_;
  static constexpr std::uint32_t kNobody = 0xffffffffU;
  static constexpr std::size_t kSideBySide = 32;
  MovedCells moved_;
  CellsAtPatches at_, around_;
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
                double excess_m, const RegistrationSettings& settings, bool strictly) {
  Refined result;
  result.fixed_from_moving = fixed_from_moving;
  const std::vector<CellsOnPatch> cells =
      cellsOnPatches(fixed, moving, fixed_from_moving, excess_m, settings);
  result.patches = cells.size();
  for (const CellsOnPatch& on : cells) result.cells += on.cells;
  for (int motion = 0; motion < kMostMotions; ++motion) {
    result.system = {};
    lineariseCells(result.fixed_from_moving, cells, excess_m, settings.refine_deviations, result.system);
    const Conditioning condition = conditioningOf(result.system, settings.min_eigenvalue);
    const Vector6d step =
        strictly ? solvedStep(result.system, condition) : solvedStepOnTheWay(result.system, condition);
    result.fixed_from_moving = result.fixed_from_moving.moved(step);
    if (step.head<3>().norm() < settings.min_rotation_rad &&
        step.tail<3>().norm() < settings.min_translation_m)
      break;
  }
  return result;
}

}  // namespace tiltmap
