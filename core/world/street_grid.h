// Where the simulated sites' streets, parking bays and blocks lie: an endless grid, every block a function of
// the seed and its place, so that any part of it can be built alone.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/world/site.h"

namespace tiltmap {

// A row of parking bays, square to the lane.
struct ParkingRow {
  double from_m = 0.0;  // its near edge, from the lane's centre
  double taken = 0.5;   // share of bays with a car in it
};

// What a quarter looks like. Lengths in metres; "from the lane" means from the centre of a main street's
// lane.
struct QuarterStyle {
  // What stands where; without it, every seed lays out its own quarter.
  std::optional<std::uint64_t> layout_seed;
  double pitch_u, pitch_v;               // between main streets, between cross streets
  std::vector<ParkingRow> rows;          // beside a main street, from the lane outwards
  double island_from, island_to;         // strip with lamps between two rows; equal: none
  double first_bay;                      // from a crossing along the main street
  double nearest_front, furthest_front;  // of buildings, beyond the kerb
  double shortest_house, longest_house;
  double one_storey_more, two_storeys_more;  // chances of a building's storeys above the least
  int least_storeys, least_at_corner;
  double lowest_storey, highest_storey;
  double gabled;     // chance of a gabled roof; of the others every second has a stair tower
  double open_lots;  // chance of a garden where a building could be
  double cross_tree_gap, cross_tree_size;  // along the cross streets: mean distance, mean size
  double corner_tree_size;

  double kerb() const { return rows.back().from_m + kBayDepth; }
  static constexpr double kBayDepth = 5.0;
  static constexpr double kBayWidth = 2.5;

  // A large car park between tall buildings, as the thesis': most walls are 25 to 40 m away, so that a scan
  // keeps 8,000 to 9,500 points at the thesis' reduction to half a metre, as it reports.
  static const QuarterStyle& carPark();
  // Streets with bays on both sides and buildings of one to three storeys behind them.
  static const QuarterStyle& streets();
};

// Main streets run along v, cross streets along u. Lane centres lie at u = k * pitch_u and v = l * pitch_v;
// block (k, l) is the rectangle from crossing (k, l) to (k+1, l+1).
struct StreetGrid {
  std::uint64_t seed = 1;
  const QuarterStyle* style = &QuarterStyle::streets();  // one of QuarterStyle's, which live for ever
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();    // crossing (0, 0) in the site frame
  double angle_rad = 0.0;                                // of the main streets against +y, left positive

  Eigen::Vector2d site(double u_m, double v_m) const;
  Eigen::Vector2d grid(const Eigen::Vector2d& site_m) const;  // (u, v)
  // Asphalt, paint between the bays, pavement, grass.
  double groundReflectivity(double x_m, double y_m) const;
};

// All shapes of the blocks that reach within radius_m of the centre (site frame) and lie within it
// themselves.
std::vector<Shape> shapesAround(const StreetGrid& grid, const Ground& ground, const Eigen::Vector2d& centre_m,
                                double radius_m);

}  // namespace tiltmap
