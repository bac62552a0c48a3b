// Cells of one scan held against the plane patches of the other.
#include "core/registration/cell_refinement.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/registration/grid_moments.h"
#include "core/registration/registration.h"
#include "tests/support/range_images.h"
#include "tests/support/room_scene.h"

namespace tiltmap {
namespace {

using V = Eigen::Vector3d;

const Pose kApart = Pose::planar(1.0, 0.5, 0.1);

// Two views of the room; the lines of sight are thin.
struct TwoViews : ::testing::Test {
  static RegistrationSettings thin() {
    RegistrationSettings s;
    s.patch_spot_rad = 0.0;
    s.patch_grouping = PatchGrouping::Blocks;
    return s;
  }
  static PreparedScanPtr view(const Pose& from, double noise_m, const RegistrationSettings& s) {
    return prepare(test_support::sceneScan(test_support::roomScene(), from, noise_m, 4), s);
  }
  RegistrationSettings settings = thin();
  PreparedScanPtr fixed = view(Pose(), 0.0, settings), moving = view(kApart, 0.0, settings);
};

Pose off(const Pose& pose, double by_m, double by_rad) {
  Vector6d step;
  step << by_rad, -by_rad, by_rad, by_m, by_m, -by_m;
  return pose.moved(step);
}

TEST_F(TwoViews, CellsGoToThePatchTheyLieOnWhereThePoseIsRight) {
  const auto found = cellsOnPatches(*fixed, *moving, kApart, 0.0, settings);
  double cells = 0.0, close = 0.0;
  for (const CellsOnPatch& on : found) {
    cells += on.cells;
    const SurfaceElements& elements = on.of_fixed ? fixed->elements : moving->elements;
    const V p = on.of_fixed ? kApart * on.mean : kApart.inverse() * on.mean;
    const double across = std::abs(elements.normal[on.patch].dot(p - elements.position[on.patch]));
    EXPECT_LT(across, 0.05);
    if (across < 1e-3) close += on.cells;
    EXPECT_LT((p - elements.position[on.patch]).norm(), 1.5);
    EXPECT_GT(on.variance_m2, 0.0);
  }
  double all = 0.0;
  for (const PreparedScanPtr& scan : {fixed, moving})
    for (const float count : scan->cells.count) all += static_cast<double>(count);
  // In the corners some lie on the other surface's patch.
  EXPECT_GT(close, 0.95 * cells);
  EXPECT_GT(cells, 0.5 * all);
  EXPECT_LE(cells, all);
}

TEST_F(TwoViews, CellsFarOffAPatchAreLeftOut) {
  const auto count = [&](const Pose& pose) {
    double cells = 0.0;
    for (const CellsOnPatch& on : cellsOnPatches(*fixed, *moving, pose, 0.0, settings)) cells += on.cells;
    return cells;
  };
  EXPECT_LT(count(off(kApart, 0.5, 0.0)), 0.2 * count(kApart));
  // Surfaces that fit so badly may be so far off.
  double with_excess = 0.0;
  for (const CellsOnPatch& on : cellsOnPatches(*fixed, *moving, off(kApart, 0.1, 0.0), 0.1, settings))
    with_excess += on.cells;
  EXPECT_GT(with_excess, 2.0 * count(off(kApart, 0.1, 0.0)));
}

// Where a slanted spot is drawn out too long the scanner tells the range of its near end: how much too short
// is not known, and on far ground it is centimetres.
TEST_F(TwoViews, CellsOfASpotThatIsDrawnOutTooLongAreLeftOut) {
  const auto longest = [](double spot_rad) {
    RegistrationSettings s = thin();
    s.patch_spot_rad = spot_rad;
    const PreparedScanPtr a = view(Pose(), 0.0, s), b = view(kApart, 0.0, s);
    const double told_rad = 2.0 * kDegree;
    double most = 0.0;
    for (const CellsOnPatch& on : cellsOnPatches(*a, *b, kApart, 0.0, s)) {
      const V normal = on.of_fixed ? kApart.rotation().transpose() * a->elements.normal[on.patch]
                                   : V(kApart.rotation() * b->elements.normal[on.patch]);
      const double cosine = std::abs(normal.dot(on.mean.normalized()));
      most = std::max(most, told_rad * std::sqrt(1.0 - cosine * cosine) / cosine * on.mean.norm());
    }
    return most;
  };
  EXPECT_GT(longest(0.0), 0.6) << "the room has such places";
  const double left = longest(2.0 * kDegree);
  EXPECT_GT(left, 0.1);
  EXPECT_LT(left, 0.52);
}

TEST_F(TwoViews, AMillimetreOffComesBackToTheTruth) {
  const Refined result = refined(*fixed, *moving, off(kApart, 2e-3, 2e-4), 0.0, settings);
  EXPECT_GT(result.patches, 100U);
  const PoseDifference left = difference(kApart, result.fixed_from_moving);
  EXPECT_LT(left.translation_m, 2e-4);
  EXPECT_LT(left.rotation_rad, 2e-5);
}

// b is the gradient of half the weighted squares: the same system at poses to both sides tells the slope.
TEST_F(TwoViews, TheSystemIsTheSlopeOfTheSquares) {
  const Pose at = off(kApart, 1e-4, 1e-5);
  const auto cells = cellsOnPatches(*fixed, *moving, at, 0.0, settings);
  const auto half = [&](const Pose& pose) {
    LinearSystem system;
    lineariseCells(pose, cells, 0.0, 1e3, system);
    return 0.5 * system.loss_square_m2;
  };
  LinearSystem system;
  lineariseCells(at, cells, 0.0, 1e3, system);
  for (int k = 0; k < 6; ++k) {
    Vector6d by = Vector6d::Zero();
    by[k] = 1e-6;
    const double slope = (half(at.moved(by)) - half(at.moved(-by))) / 2e-6;
    EXPECT_NEAR(slope, system.b[k], 0.02 * system.b.norm()) << k;
  }
  EXPECT_LT((system.h - system.h.transpose()).norm(), 1e-9 * system.h.norm());
}

TEST_F(TwoViews, WithoutCellsThePoseIsAsGiven) {
  RegistrationSettings none = settings;
  none.refine = false;
  const PreparedScanPtr a = view(Pose(), 0.0, none), b = view(kApart, 0.0, none);
  EXPECT_TRUE(a->cells.empty());
  EXPECT_EQ(refined(*a, *b, kApart, 0.0, none).patches, 0U);
  RegistrationSettings cubes = settings;
  cubes.patch_grouping = PatchGrouping::Cubes;
  const PreparedScanPtr c = view(Pose(), 0.0, cubes), d = view(kApart, 0.0, cubes);
  const Refined result = refined(*c, *d, kApart, 0.0, cubes);
  EXPECT_EQ(result.patches, 0U);
  EXPECT_EQ(difference(result.fixed_from_moving, kApart).translation_m, 0.0);
}

TEST_F(TwoViews, ARegistrationEndsWithItAndSaysSo) {
  const PreparedScanPtr a = view(Pose(), 0.01, settings), b = view(kApart, 0.01, settings);
  Registration registration(a, b, off(kApart, 0.2, 0.02), settings);
  StepReport last;
  int refining = 0;
  while (!registration.done()) {
    last = registration.step();
    EXPECT_TRUE(last.refining || refining == 0) << "patches are not paired again";
    refining += last.refining ? 1 : 0;
    EXPECT_EQ(last.cells > 0.0, last.refining);
    EXPECT_EQ(last.rejected[static_cast<std::size_t>(RejectReason::None)], last.pairs);
  }
  EXPECT_TRUE(isSuccess(*registration.stopReason()));
  EXPECT_TRUE(last.refining);
  EXPECT_LT(difference(kApart, registration.fixedFromMoving()).translation_m, 2e-3);
}

TEST(CellSamples, AreAllCellsOnceSmallTilesAsOne) {
  const Scan scan = test_support::sceneScan(test_support::roomScene(), Pose(), 0.0, 4);
  for (const bool regular : {true, false}) {
    Scan other = scan;
    if (!regular) {
      RangeImageData data = scan.image->data();
      data.direction.assign(data.cells(), Eigen::Vector3f::Zero());
      for (int row = 0; row < data.rows; ++row)
        for (int column = 0; column < data.columns; ++column) {
          if (!scan.image->hasPoint(row, column)) continue;
          const V p = cellPoint(*scan.image, scan.geometry, row, column);
          data.direction[scan.image->index(row, column)] = p.normalized().cast<float>();
          data.range_m[scan.image->index(row, column)] = static_cast<float>(p.norm());
        }
      other.image = RangeImage::make(std::move(data)).value();
    }
    const auto sampled = [&](double whole_below_m) {
      CellSamples samples;
      tileMoments(*other.image, other.geometry, 2, 4, false, &samples, whole_below_m);
      double cells = 0.0;
      V sum = V::Zero();
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto n = static_cast<double>(samples.count[i]);
        cells += n;
        sum += n * V(static_cast<double>(samples.x[i]), static_cast<double>(samples.y[i]),
                     static_cast<double>(samples.z[i]));
      }
      EXPECT_DOUBLE_EQ(cells, static_cast<double>(other.image->validCells()));
      return std::pair(samples.size(), V(sum / cells));
    };
    const auto [single, mean] = sampled(0.0);
    const auto [some, same] = sampled(0.2);
    const auto [tiles, again] = sampled(1000.0);
    EXPECT_EQ(single, other.image->validCells());
    EXPECT_LT(some, single);
    EXPECT_LT(tiles, some);
    EXPECT_LT((mean - same).norm() + (mean - again).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace tiltmap
