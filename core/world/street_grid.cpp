#include "core/world/street_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/geometry/pose.h"
#include "core/world/furniture.h"

namespace tiltmap {

namespace {

constexpr double kKerb =
    StreetGrid::kHalfLane + StreetGrid::kBayDepth;  // from the lane's centre, main streets
constexpr double kCrossKerb = 4.0;                  // the same, cross streets
constexpr double kFirstBay = 9.0;                   // from the crossing along v
constexpr double kBuildingFrom = 9.5;               // likewise, end walls of buildings

// Fills one block. Every random draw is made whether or not its shape is near enough to be kept, so that a
// block is the same from wherever it is seen.
class Block {
 public:
  Block(const StreetGrid& grid, int k, int l, Furnisher& out)
      : grid_(grid),
        u0_(k * StreetGrid::kPitchU),
        v0_(l * StreetGrid::kPitchV),
        out_(out),
        random_(RandomStream::keyed({grid.seed, 0x51a7, static_cast<std::uint64_t>(std::int64_t{k}),
                                     static_cast<std::uint64_t>(std::int64_t{l})})) {}

  void fill() {
    for (const int side : {0, 1}) {
      parkingRow(side);
      verge(side);
      buildings(side);
    }
    crossVerge(0);
    crossVerge(1);
    corners();
    courtyard();
  }

 private:
  // Along the block's side 0 (u low) or 1 (u high): `in` metres from the lane's centre into the block.
  double across(int side, double in) const { return side == 0 ? u0_ + in : u0_ + StreetGrid::kPitchU - in; }
  double inward(int side) const { return side == 0 ? 1.0 : -1.0; }
  Spot spot(double u, double v, double turn_rad) const {
    return {grid_.site(u, v), grid_.angle_rad + turn_rad};
  }
  bool chance(double p) { return random_.uniform() < p; }

  void parkingRow(int side) {
    const double end = StreetGrid::kPitchV - kFirstBay;
    for (double v = kFirstBay; v + StreetGrid::kBayWidth <= end; v += StreetGrid::kBayWidth) {
      const bool taken = chance(0.55), nose_in = chance(0.6);
      const double in = StreetGrid::kHalfLane + 2.55 + random_.uniform(-0.2, 0.25);
      const double turn =
          random_.uniform(-0.05, 0.05) + (nose_in ? -0.5 : 0.5) * inward(side) * 180.0 * kDegree;
      const Spot place =
          spot(across(side, in), v0_ + v + 0.5 * StreetGrid::kBayWidth + random_.uniform(-0.15, 0.15), turn);
      const std::uint64_t looks = random_.next();
      if (taken) out_.car(place, looks);
    }
  }

  // Kerb behind the bays, lamp posts, trees, bins, signs, low walls in front of the buildings.
  void verge(int side) {
    const double from = kFirstBay - 3.0, to = StreetGrid::kPitchV - kFirstBay + 3.0;
    for (double v = from; v + 3.0 <= to + 1e-9; v += 3.0)
      out_.kerb(spot(across(side, kKerb + 0.08), v0_ + v + 1.5, 0.0), 3.0);
    for (double v = from + random_.uniform(1.0, 6.0); v < to; v += random_.uniform(14.0, 19.0))
      out_.lampPost(spot(across(side, kKerb + 0.55), v0_ + v, inward(side) * 90.0 * kDegree),
                    random_.uniform(4.2, 6.5));
    for (double v = from + random_.uniform(2.0, 7.0); v < to; v += random_.uniform(6.5, 13.0))
      out_.tree(spot(across(side, kKerb + random_.uniform(1.2, 2.0)), v0_ + v, 0.0),
                random_.uniform(0.75, 1.2), random_.next());
    for (double v = from + random_.uniform(3.0, 10.0); v < to; v += random_.uniform(9.0, 22.0)) {
      const double in = kKerb + random_.uniform(0.5, 1.0), kind = random_.uniform();
      const Spot place = spot(across(side, in), v0_ + v, random_.uniform(-0.2, 0.2));
      if (kind < 0.35)
        out_.bin(place);
      else if (kind < 0.7)
        out_.sign(place, inward(side) * 90.0 * kDegree);
      else
        out_.container(place);
    }
  }

  void buildings(int side) {
    double v = kBuildingFrom + random_.uniform(0.0, 3.0);
    bool open_before = true;
    while (v < StreetGrid::kPitchV - kBuildingFrom - 6.0) {
      const double length = std::min(random_.uniform(9.0, 21.0), StreetGrid::kPitchV - kBuildingFrom - v);
      const bool open = chance(0.22) && !open_before;
      const double front = random_.uniform(12.2, 15.2), depth = random_.uniform(8.0, 10.5);
      const double turn = random_.uniform(-0.03, 0.03);
      const std::uint64_t looks = random_.next();
      const double middle = v0_ + v + 0.5 * length;
      if (open) {
        garden(side, v, length, looks);
      } else if (length > 5.0) {
        // The frame's +y looks back at the street.
        const Spot place =
            spot(across(side, front + 0.5 * depth), middle, turn + inward(side) * 90.0 * kDegree);
        // At the corners never a low one.
        const bool corner = v < 16.0 || v + length > StreetGrid::kPitchV - 24.0;
        out_.building(place, length, depth, corner ? 2 : 1, looks);
      }
      open_before = open;
      v += length + random_.uniform(2.5, 7.0);
    }
  }

  // A gap in the row: a low wall at the pavement and trees behind it.
  void garden(int side, double v, double length, std::uint64_t looks) {
    RandomStream random(looks);
    out_.lowWall(spot(across(side, 11.6), v0_ + v + 0.5 * length, random.uniform(-0.06, 0.06)), length - 1.0,
                 random.uniform(0.5, 1.1));
    for (double place = 2.0; place < length - 1.0; place += random.uniform(4.0, 6.0))
      out_.tree(spot(across(side, random.uniform(14.0, 19.0)), v0_ + v + place, 0.0),
                random.uniform(0.9, 1.5), random.next());
  }

  void crossVerge(int side) {
    const auto along = [&](double in) { return side == 0 ? v0_ + in : v0_ + StreetGrid::kPitchV - in; };
    const double from = kKerb + 1.0, to = StreetGrid::kPitchU - kKerb - 1.0;
    for (double u = from; u + 3.0 <= to + 1e-9; u += 3.0)
      out_.kerb(spot(u0_ + u + 1.5, along(kCrossKerb + 0.08), 90.0 * kDegree), 3.0);
    for (double u = from + random_.uniform(0.5, 4.0); u < to; u += random_.uniform(5.2, 7.2))
      out_.tree(spot(u0_ + u, along(kCrossKerb + random_.uniform(1.5, 2.5)), 0.0), random_.uniform(1.0, 1.35),
                random_.next());
    for (double u = from + random_.uniform(2.0, 8.0); u < to; u += random_.uniform(16.0, 22.0))
      out_.lampPost(spot(u0_ + u, along(kCrossKerb + 0.6), side == 0 ? 180.0 * kDegree : 0.0),
                    random_.uniform(4.2, 6.5));
    for (double u = from + random_.uniform(1.0, 6.0); u + 6.0 < to; u += random_.uniform(9.0, 18.0))
      out_.lowWall(
          spot(u0_ + u + 3.0, along(kCrossKerb + 4.2), 90.0 * kDegree + random_.uniform(-0.05, 0.05)),
          random_.uniform(3.5, 6.0), random_.uniform(0.6, 1.6));
  }

  // Islands with a large tree where two streets meet: without them a crossing sees little but sky.
  void corners() {
    for (const int side : {0, 1})
      for (const bool far_end : {false, true}) {
        const double in = random_.uniform(5.1, 5.8), along = random_.uniform(5.6, 6.4),
                     size = random_.uniform(1.35, 1.5);
        const std::uint64_t looks = random_.next();
        const Spot place =
            spot(across(side, in), far_end ? v0_ + StreetGrid::kPitchV - along : v0_ + along, 0.0);
        out_.island(place, 1.0);
        out_.tree(place, size, looks);
      }
  }

  void courtyard() {
    const double middle = 0.5 * StreetGrid::kPitchU;
    for (double v = 12.0 + random_.uniform(0.0, 8.0); v < StreetGrid::kPitchV - 12.0;
         v += random_.uniform(10.0, 16.0))
      out_.tree(spot(u0_ + middle + random_.uniform(-0.6, 0.6), v0_ + v, 0.0), random_.uniform(0.6, 0.8),
                random_.next());
  }

  const StreetGrid& grid_;
  double u0_, v0_;
  Furnisher& out_;
  RandomStream random_;
};

}  // namespace

Eigen::Vector2d StreetGrid::site(double u_m, double v_m) const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return origin_m + Eigen::Vector2d(c * u_m - s * v_m, s * u_m + c * v_m);
}

Eigen::Vector2d StreetGrid::grid(const Eigen::Vector2d& site_m) const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const Eigen::Vector2d d = site_m - origin_m;
  return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
}

double StreetGrid::groundReflectivity(double x_m, double y_m) const {
  constexpr double kAsphalt = 0.2, kPaint = 0.6, kPavement = 0.32, kGrass = 0.45;
  const Eigen::Vector2d place = grid({x_m, y_m});
  // Distances from the nearest lane centre of either direction, and along the bays.
  const double u = std::abs(place.x() - kPitchU * std::round(place.x() / kPitchU));
  const double v_in = place.y() - kPitchV * std::floor(place.y() / kPitchV);
  const double v = std::min(v_in, kPitchV - v_in);
  if (v < kCrossKerb || u < kHalfLane) return kAsphalt;
  if (u < kKerb) {
    if (v < kFirstBay) return kAsphalt;
    const double bay = (v_in - kFirstBay) / kBayWidth;
    return std::abs(bay - std::round(bay)) * kBayWidth < 0.06 ? kPaint : kAsphalt;
  }
  return u < kKerb + 2.6 ? kPavement : kGrass;
}

std::vector<Shape> shapesAround(const StreetGrid& grid, const Ground& ground, const Eigen::Vector2d& centre_m,
                                double radius_m) {
  Furnisher furnisher(ground, centre_m, radius_m);
  const Eigen::Vector2d c = grid.grid(centre_m);
  const auto index = [](double place, double pitch) { return static_cast<int>(std::floor(place / pitch)); };
  for (int l = index(c.y() - radius_m, StreetGrid::kPitchV);
       l <= index(c.y() + radius_m, StreetGrid::kPitchV); ++l)
    for (int k = index(c.x() - radius_m, StreetGrid::kPitchU);
         k <= index(c.x() + radius_m, StreetGrid::kPitchU); ++k)
      Block(grid, k, l, furnisher).fill();
  return furnisher.take();
}

}  // namespace tiltmap
