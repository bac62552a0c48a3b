// The things that stand on a simulated site, each put together from a few shapes.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/world/ground.h"
#include "core/world/shapes.h"

namespace tiltmap {

// A place on the ground; the thing's own +y points turn_rad left of the site's +y.
struct Spot {
  Eigen::Vector2d place_m;
  double turn_rad = 0.0;
};

struct House {
  enum class Roof { Flat, Gabled, StairTower };
  double length_m, depth_m;  // along x, along y
  int storeys;
  double storey_m;
  Roof roof;
};

// Collects shapes that stand on a ground, and leaves out what lies beyond a radius. What a thing looks like
// depends on its arguments alone; `looks` is the seed of one thing.
class Furnisher {
 public:
  Furnisher(const Ground& ground, const Eigen::Vector2d& centre_m, double radius_m)
      : ground_(ground), centre_m_(centre_m), radius_m_(radius_m) {}

  void car(const Spot& spot, std::uint64_t looks);   // nose to +y; stands on the slope
  void kerb(const Spot& spot, double length_m);      // along +y, 0.13 m high, follows the slope
  void island(const Spot& spot, double radius_m);    // a round kerb with earth in it
  void lampPost(const Spot& spot, double height_m);  // the arm points along +y
  void tree(const Spot& spot, double size, std::uint64_t looks);
  void bin(const Spot& spot);
  void sign(const Spot& spot, double facing_rad);
  void container(const Spot& spot);
  void lowWall(const Spot& spot, double length_m, double height_m);          // along +y
  void building(const Spot& spot, const House& house, std::uint64_t looks);  // front towards +y

  std::vector<Shape> take() { return std::move(shapes_); }

 private:
  bool far(const Spot& spot) const { return (spot.place_m - centre_m_).norm() > radius_m_; }
  double height(const Spot& spot) const { return ground_.height(spot.place_m.x(), spot.place_m.y()); }
  Eigen::Isometry3d upright(const Spot& spot) const;
  Eigen::Isometry3d onSlope(const Spot& spot) const;

  const Ground& ground_;
  Eigen::Vector2d centre_m_;
  double radius_m_;
  std::vector<Shape> shapes_;
};

}  // namespace tiltmap
