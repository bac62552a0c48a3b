#include "core/world/street_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/geometry/pose.h"
#include "core/world/furniture.h"

namespace tiltmap {

namespace {

constexpr double kLane = 3.4;       // half the width of a main street's lane: the first bays begin there
constexpr double kCrossKerb = 4.0;  // from a cross street's centre to its kerb
constexpr double kEndWall = 9.5;    // from a cross street's centre to the first end wall
constexpr double kQuarterTurn = 90.0 * kDegree;

// Fills one block. Every random draw is made whether or not its shape is near enough to be kept, so that a
// block is the same from wherever it is seen; and each in a statement of its own, for the order of a call's
// arguments is the compiler's choice.
class Block {
 public:
  Block(const StreetGrid& grid, int k, int l, Furnisher& out)
      : grid_(grid),
        style_(*grid.style),
        u0_(k * style_.pitch_u),
        v0_(l * style_.pitch_v),
        out_(out),
        layout_(streamOf(style_.layout_seed.value_or(grid.seed), 0x51a7, k, l)),
        parked_(streamOf(style_.layout_seed.value_or(grid.seed), 0xca45, k, l)),
        detail_(streamOf(grid.seed, 0xde7a, k, l)) {}

  void fill() {
    for (const int side : {0, 1}) {
      for (const ParkingRow& row : style_.rows) parkingRow(side, row);
      if (style_.island_to > style_.island_from) island(side);
      verge(side);
      buildings(side);
    }
    for (const int side : {0, 1}) crossVerge(side);
    corners();
    courtyard();
  }

 private:
  static RandomStream streamOf(std::uint64_t seed, std::uint64_t purpose, int k, int l) {
    return RandomStream::keyed({seed, purpose, static_cast<std::uint64_t>(std::int64_t{k}),
                                static_cast<std::uint64_t>(std::int64_t{l})});
  }
  // Along the block's side 0 (u low) or 1 (u high): `in` metres from the lane's centre into the block.
  double across(int side, double in) const { return side == 0 ? u0_ + in : u0_ + style_.pitch_u - in; }
  double inward(int side) const { return side == 0 ? 1.0 : -1.0; }
  Spot spot(double u, double v, double turn_rad = 0.0) const {
    return {grid_.site(u, v), grid_.angle_rad + turn_rad};
  }
  // What stands where, and by how much a seed's site differs from that.
  double between(double low, double high) { return layout_.uniform(low, high); }
  double about(double tolerance) { return detail_.uniform(-tolerance, tolerance); }
  std::uint64_t looks() { return detail_.next(); }

  void parkingRow(int side, const ParkingRow& row) {
    constexpr int kGroup = 5;
    const int bays = static_cast<int>((style_.pitch_v - 2.0 * style_.first_bay) / QuarterStyle::kBayWidth);
    const auto takenBefore = [&row](int bay) { return static_cast<int>(std::lround(row.taken * bay)); };
    for (int bay = 0, left = 0; bay < bays; ++bay) {
      // As many of every group's bays as the share asks for, and no more.
      const int of_group = std::min(kGroup, bays - bay / kGroup * kGroup) - bay % kGroup;
      if (bay % kGroup == 0) left = takenBefore(bay + of_group) - takenBefore(bay);
      const bool taken = parked_.uniform() * of_group < left;
      const double nose = detail_.uniform() < 0.6 ? -1.0 : 1.0;  // into the bay, or out of it
      const double in = row.from_m + 2.55 + detail_.uniform(-0.2, 0.25);
      const double aside = about(0.15), turn = about(0.05) + nose * inward(side) * kQuarterTurn;
      const std::uint64_t car_looks = looks();
      if (!taken) continue;
      --left;
      const double v = style_.first_bay + (bay + 0.5) * QuarterStyle::kBayWidth;
      out_.car(spot(across(side, in), v0_ + v + aside, turn), car_looks);
    }
  }

  void kerbLine(int side, double in, double from, double to) {
    for (double v = from; v + 3.0 <= to + 1e-9; v += 3.0)
      out_.kerb(spot(across(side, in), v0_ + v + 1.5), 3.0);
  }

  void lamps(int side, double in, double from, double to) {
    for (double v = from + between(1.0, 6.0); v < to; v += between(14.0, 19.0)) {
      const double high = between(4.2, 6.5), aside = about(0.3);
      out_.lampPost(spot(across(side, in), v0_ + v + aside, inward(side) * kQuarterTurn), high);
    }
  }

  void island(int side) {
    const double from = style_.first_bay, to = style_.pitch_v - style_.first_bay;
    kerbLine(side, style_.island_from + 0.08, from, to);
    kerbLine(side, style_.island_to - 0.08, from, to);
    const double middle = 0.5 * (style_.island_from + style_.island_to);
    lamps(side, middle, from, to);
  }

  // Kerb behind the bays; lamp posts, trees, bins, signs and containers on the pavement.
  void verge(int side) {
    const double from = style_.first_bay - 3.0, to = style_.pitch_v - style_.first_bay + 3.0,
                 kerb = style_.kerb();
    kerbLine(side, kerb + 0.08, from, to);
    lamps(side, kerb + 0.55, from, to);
    for (double v = from + between(2.0, 7.0); v < to; v += between(6.5, 13.0)) {
      const double in = kerb + between(1.2, 2.0), size = between(0.75, 1.2), aside = about(0.3);
      out_.tree(spot(across(side, in), v0_ + v + aside), size, looks());
    }
    for (double v = from + detail_.uniform(3.0, 10.0); v < to; v += detail_.uniform(9.0, 22.0)) {
      const double in = kerb + detail_.uniform(0.5, 1.0), kind = detail_.uniform(), turn = about(0.2);
      const Spot place = spot(across(side, in), v0_ + v, turn);
      if (kind < 0.35)
        out_.bin(place);
      else if (kind < 0.7)
        out_.sign(place, inward(side) * kQuarterTurn);
      else
        out_.container(place);
    }
  }

  void buildings(int side) {
    double v = kEndWall + between(0.0, 3.0);
    bool open_before = true;
    while (v < style_.pitch_v - kEndWall - 6.0) {
      const double wish = between(style_.shortest_house, style_.longest_house);
      const double length = std::min(wish, style_.pitch_v - kEndWall - v);
      const bool open = layout_.uniform() < style_.open_lots && !open_before;
      const double front = style_.kerb() + between(style_.nearest_front, style_.furthest_front) + about(0.3);
      const double depth = between(8.0, 10.5), turn = about(0.03), lot = layout_.uniform();
      const double storey = between(style_.lowest_storey, style_.highest_storey), roof = layout_.uniform();
      const std::uint64_t seed = looks();
      if (open) {
        garden(side, v, length);
      } else if (length > 5.0) {
        const bool corner = v < 16.0 || v + length > style_.pitch_v - 24.0;
        const int more = lot < style_.two_storeys_more                            ? 2
                         : lot < style_.two_storeys_more + style_.one_storey_more ? 1
                                                                                  : 0;
        const int storeys = std::max(style_.least_storeys + more, corner ? style_.least_at_corner : 0);
        const House::Roof form = roof < style_.gabled                 ? House::Roof::Gabled
                                 : roof < 0.5 * (1.0 + style_.gabled) ? House::Roof::StairTower
                                                                      : House::Roof::Flat;
        // The frame's +y looks back at the street.
        out_.building(spot(across(side, front + 0.5 * depth), v0_ + v + 0.5 * length,
                           turn + inward(side) * kQuarterTurn),
                      {length, depth, storeys, storey, form}, seed);
      }
      open_before = open;
      v += length + between(2.5, 7.0);
    }
  }

  // A gap in the row: a low wall at the pavement and trees behind it.
  void garden(int side, double v, double length) {
    const double turn = about(0.06), high = between(0.5, 1.1);
    out_.lowWall(spot(across(side, style_.kerb() + 3.2), v0_ + v + 0.5 * length, turn), length - 1.0, high);
    for (double place = 2.0; place < length - 1.0; place += between(4.0, 6.0)) {
      const double in = style_.kerb() + between(5.6, 10.6), size = between(0.9, 1.5), aside = about(0.3);
      out_.tree(spot(across(side, in), v0_ + v + place + aside), size, looks());
    }
  }

  void crossVerge(int side) {
    const auto along = [&](double in) { return side == 0 ? v0_ + in : v0_ + style_.pitch_v - in; };
    const double from = style_.kerb() + 1.0, to = style_.pitch_u - style_.kerb() - 1.0;
    for (double u = from; u + 3.0 <= to + 1e-9; u += 3.0)
      out_.kerb(spot(u0_ + u + 1.5, along(kCrossKerb + 0.08), kQuarterTurn), 3.0);
    const double gap = style_.cross_tree_gap;
    for (double u = from + between(0.5, 4.0); u < to; u += between(0.85 * gap, 1.15 * gap)) {
      const double in = kCrossKerb + between(1.5, 2.5), size = style_.cross_tree_size * between(0.86, 1.14);
      const double aside = about(0.3);
      out_.tree(spot(u0_ + u + aside, along(in)), size, looks());
    }
    for (double u = from + between(2.0, 8.0); u < to; u += between(16.0, 22.0)) {
      const double high = between(4.2, 6.5), aside = about(0.3);
      out_.lampPost(spot(u0_ + u + aside, along(kCrossKerb + 0.6), side == 0 ? 2.0 * kQuarterTurn : 0.0),
                    high);
    }
    for (double u = from + between(1.0, 6.0); u + 6.0 < to; u += between(9.0, 18.0)) {
      const double turn = kQuarterTurn + about(0.05), length = between(3.5, 6.0), high = between(0.6, 1.6);
      out_.lowWall(spot(u0_ + u + 3.0, along(kCrossKerb + 4.2), turn), length, high);
    }
  }

  // Islands with a large tree where two streets meet: without them a crossing sees little but sky.
  void corners() {
    for (const int side : {0, 1})
      for (const bool far_end : {false, true}) {
        const double in = between(5.1, 5.8), along = between(5.6, 6.4),
                     size = style_.corner_tree_size * between(0.95, 1.05);
        const Spot place = spot(across(side, in), far_end ? v0_ + style_.pitch_v - along : v0_ + along);
        out_.island(place, 1.0);
        out_.tree(place, size, looks());
      }
  }

  void courtyard() {
    for (double v = 12.0 + between(0.0, 8.0); v < style_.pitch_v - 12.0; v += between(10.0, 16.0)) {
      const double u = 0.5 * style_.pitch_u + between(-0.6, 0.6), size = between(0.6, 0.8);
      out_.tree(spot(u0_ + u, v0_ + v), size, looks());
    }
  }

  const StreetGrid& grid_;
  const QuarterStyle& style_;
  double u0_, v0_;
  Furnisher& out_;
  RandomStream layout_, parked_, detail_;
};

}  // namespace

const QuarterStyle& QuarterStyle::carPark() {
  static const QuarterStyle style{.layout_seed = 2,
                                  .pitch_u = 96.0,
                                  .pitch_v = 88.0,
                                  // Beyond the island: a row, a second aisle of 6 m, a row.
                                  .rows = {{kLane, 0.0}, {10.2, 0.2}, {21.2, 0.6}},
                                  .island_from = 8.4,
                                  .island_to = 10.2,
                                  .first_bay = 9.0,
                                  .nearest_front = 6.5,
                                  .furthest_front = 7.5,
                                  .shortest_house = 20.0,
                                  .longest_house = 26.0,
                                  .one_storey_more = 0.0,
                                  .two_storeys_more = 0.0,
                                  .least_storeys = 3,
                                  .least_at_corner = 3,
                                  .lowest_storey = 3.25,
                                  .highest_storey = 3.45,
                                  .gabled = 0.0,
                                  .open_lots = 0.0,
                                  .cross_tree_gap = 8.0,
                                  .cross_tree_size = 1.05,
                                  .corner_tree_size = 1.6};
  return style;
}

const QuarterStyle& QuarterStyle::streets() {
  static const QuarterStyle style{.layout_seed = std::nullopt,
                                  .pitch_u = 54.0,
                                  .pitch_v = 66.0,
                                  .rows = {{kLane, 0.55}},
                                  .island_from = 0.0,
                                  .island_to = 0.0,
                                  .first_bay = 9.0,
                                  .nearest_front = 3.8,
                                  .furthest_front = 6.8,
                                  .shortest_house = 9.0,
                                  .longest_house = 21.0,
                                  .one_storey_more = 0.5,
                                  .two_storeys_more = 0.07,
                                  .least_storeys = 1,
                                  .least_at_corner = 2,
                                  .lowest_storey = 3.0,
                                  .highest_storey = 3.5,
                                  .gabled = 0.35,
                                  .open_lots = 0.22,
                                  .cross_tree_gap = 6.2,
                                  .cross_tree_size = 1.15,
                                  .corner_tree_size = 1.42};
  return style;
}

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
  constexpr double kAsphalt = 0.25, kPaint = 0.6, kPavement = 0.32, kGrass = 0.45;
  const Eigen::Vector2d place = grid({x_m, y_m});
  // Distances from the nearest lane centre of either direction, and along the bays.
  const double u = std::abs(place.x() - style->pitch_u * std::round(place.x() / style->pitch_u));
  const double v_in = place.y() - style->pitch_v * std::floor(place.y() / style->pitch_v);
  const double v = std::min(v_in, style->pitch_v - v_in);
  if (v < kCrossKerb || u < kLane) return kAsphalt;
  if (u >= style->kerb()) return u < style->kerb() + 2.6 ? kPavement : kGrass;
  if (v < style->first_bay) return kAsphalt;
  if (u > style->island_from && u < style->island_to) return kGrass;
  const double bay = (v_in - style->first_bay) / QuarterStyle::kBayWidth;
  const bool line = std::abs(bay - std::round(bay)) * QuarterStyle::kBayWidth < 0.06;
  const bool in_bay = std::any_of(style->rows.begin(), style->rows.end(), [u](const ParkingRow& row) {
    return u > row.from_m && u < row.from_m + QuarterStyle::kBayDepth;
  });
  return line && in_bay ? kPaint : kAsphalt;
}

std::vector<Shape> shapesAround(const StreetGrid& grid, const Ground& ground, const Eigen::Vector2d& centre_m,
                                double radius_m) {
  Furnisher furnisher(ground, centre_m, radius_m);
  const Eigen::Vector2d c = grid.grid(centre_m);
  const auto index = [](double place, double pitch) { return static_cast<int>(std::floor(place / pitch)); };
  const double pu = grid.style->pitch_u, pv = grid.style->pitch_v;
  for (int l = index(c.y() - radius_m, pv); l <= index(c.y() + radius_m, pv); ++l)
    for (int k = index(c.x() - radius_m, pu); k <= index(c.x() + radius_m, pu); ++k)
      Block(grid, k, l, furnisher).fill();
  return furnisher.take();
}

}  // namespace tiltmap
