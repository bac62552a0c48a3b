#include "core/world/furniture.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"

namespace tiltmap {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d Furnisher::upright(const Spot& spot) const {
  Isometry3d frame = Isometry3d::Identity();
  frame.linear() = Eigen::AngleAxisd(spot.turn_rad, Vector3d::UnitZ()).toRotationMatrix();
  frame.translation() = Vector3d(spot.place_m.x(), spot.place_m.y(), height(spot));
  return frame;
}

Isometry3d Furnisher::onSlope(const Spot& spot) const {
  Isometry3d frame = upright(spot);
  const Vector3d up = ground_.normal(spot.place_m.x(), spot.place_m.y());
  frame.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), up).toRotationMatrix() * frame.linear();
  return frame;
}

void Furnisher::car(const Spot& spot, std::uint64_t looks) {
  if (far(spot)) return;
  RandomStream random(looks);
  const double x = 0.5 * random.uniform(1.62, 1.8), y = 0.5 * random.uniform(3.7, 4.6);
  const bool van = random.uniform() < 0.05, saloon = random.uniform() < 0.5;
  const double waist = random.uniform(0.78, 0.9),
               roof = van ? random.uniform(1.85, 2.1) : random.uniform(1.36, 1.52);
  const double paint = random.uniform(0.15, 0.75), glass = 0.18, tyre = 0.1;
  const Isometry3d frame = onSlope(spot);

  Hull body = Hull::box(frame, {-x, -y, 0.24}, {x, y, waist}, paint);
  body.cut({0.0, y - 0.95, waist}, {0.0, 0.16, 1.0});   // bonnet
  body.cut({0.0, y, waist - 0.28}, {0.0, 1.0, 0.45});   // nose
  body.cut({0.0, -y, waist - 0.15}, {0.0, -1.0, 0.5});  // tail
  body.cut({x, 0.0, waist - 0.1}, {1.0, 0.0, 0.35});    // shoulders
  body.cut({-x, 0.0, waist - 0.1}, {-1.0, 0.0, 0.35});
  shapes_.push_back(body);

  const double front = van ? y - 0.6 : y - 1.05, back = van ? -y + 0.05 : (saloon ? -y + 0.75 : -y + 0.12);
  Hull cabin =
      Hull::box(frame, {-x + 0.04, back, waist - 0.12}, {x - 0.04, front, roof}, van ? paint : glass);
  cabin.cut({0.0, front, waist - 0.1}, {0.0, 1.0, van ? 0.5 : 1.15});              // windscreen
  cabin.cut({0.0, back, waist}, {0.0, -1.0, van ? 0.05 : (saloon ? 1.0 : 0.45)});  // rear window
  cabin.cut({x - 0.04, 0.0, waist}, {1.0, 0.0, 0.28});
  cabin.cut({-x + 0.04, 0.0, waist}, {-1.0, 0.0, 0.28});
  shapes_.push_back(cabin);

  if (!van) {
    const double run = roof - waist, foremost = front - 1.15 * (run + 0.1),
                 hindmost = back + (saloon ? 1.0 : 0.45) * run;
    const double half = x - 0.04 - 0.28 * run;
    shapes_.push_back(Hull::box(frame, {-half, hindmost, roof - 0.02}, {half, foremost, roof + 0.03}, paint));
  }

  const double wheel = 0.31;
  for (const double axle : {y - 0.85, -y + 0.8}) {
    // An eight-sided roller as wide as the car: both wheels of an axle.
    Hull wheels =
        Hull::box(frame, {-x + 0.03, axle - wheel, 0.0}, {x - 0.03, axle + wheel, 2.0 * wheel}, tyre);
    for (const double side : {-1.0, 1.0})
      for (const double high : {-1.0, 1.0})
        wheels.cut(Vector3d(0.0, axle, wheel) + wheel * Vector3d(0.0, side, high).normalized(),
                   {0.0, side, high});
    shapes_.push_back(wheels);
  }
}

void Furnisher::kerb(const Spot& spot, double length_m) {
  if (far(spot)) return;
  shapes_.push_back(
      Hull::box(onSlope(spot), {-0.08, -0.5 * length_m, -0.3}, {0.08, 0.5 * length_m, 0.13}, 0.4));
}

void Furnisher::island(const Spot& spot, double radius_m) {
  if (far(spot)) return;
  const double foot = height(spot);
  shapes_.push_back(Cylinder{spot.place_m, radius_m, foot - 0.6, foot + 0.15, 0.4});
}

void Furnisher::lampPost(const Spot& spot, double height_m) {
  if (far(spot)) return;
  const double foot = height(spot);
  shapes_.push_back(Cylinder{spot.place_m, 0.08, foot - 0.5, foot + height_m, 0.45});
  shapes_.push_back(Cylinder{spot.place_m, 0.13, foot - 0.5, foot + 1.1, 0.4});  // the door of the mast
  const Isometry3d frame = upright(spot);
  shapes_.push_back(Hull::box(frame, {-0.05, 0.0, height_m - 0.15}, {0.05, 0.9, height_m - 0.05}, 0.45));
  shapes_.push_back(Hull::box(frame, {-0.16, 0.7, height_m - 0.22}, {0.16, 1.35, height_m + 0.02}, 0.5));
}

void Furnisher::tree(const Spot& spot, double size, std::uint64_t looks) {
  if (far(spot)) return;
  RandomStream random(looks);
  const double foot = height(spot), trunk = size * random.uniform(1.7, 2.4);
  const double radius = size * random.uniform(1.4, 1.9), half_height = size * random.uniform(1.6, 2.4);
  const double density = random.uniform(0.3, 0.55), bark = random.uniform(0.25, 0.4),
               leaf = random.uniform(0.4, 0.6);
  const double middle = foot + trunk + 0.8 * half_height;
  shapes_.push_back(Cylinder{spot.place_m, size * random.uniform(0.11, 0.2), foot - 0.5, middle, bark});
  shapes_.push_back(Foliage{
      {spot.place_m.x(), spot.place_m.y(), middle}, radius, half_height, density, leaf, random.next()});
}

void Furnisher::bin(const Spot& spot) {
  if (far(spot)) return;
  const double foot = height(spot);
  shapes_.push_back(Cylinder{spot.place_m, 0.27, foot - 0.3, foot + 0.95, 0.35});
}

void Furnisher::sign(const Spot& spot, double facing_rad) {
  if (far(spot)) return;
  const double foot = height(spot);
  shapes_.push_back(Cylinder{spot.place_m, 0.035, foot - 0.3, foot + 2.5, 0.5});
  Spot board = spot;
  board.turn_rad += facing_rad;
  shapes_.push_back(Hull::box(upright(board), {-0.3, 0.04, 1.9}, {0.3, 0.07, 2.5}, 0.9));
}

void Furnisher::container(const Spot& spot) {
  if (far(spot)) return;
  Hull tub = Hull::box(onSlope(spot), {-0.5, -0.65, 0.0}, {0.5, 0.65, 1.3}, 0.3);
  tub.cut({0.0, 0.0, 1.3}, {0.3, 0.0, 1.0});
  tub.cut({0.0, 0.0, 1.3}, {-0.3, 0.0, 1.0});
  shapes_.push_back(tub);
}

void Furnisher::lowWall(const Spot& spot, double length_m, double height_m) {
  if (far(spot)) return;
  const Isometry3d frame = upright(spot);
  shapes_.push_back(Hull::box(frame, {-0.13, -0.5 * length_m, -1.5}, {0.13, 0.5 * length_m, height_m}, 0.45));
  shapes_.push_back(Hull::box(frame, {-0.18, -0.5 * length_m - 0.05, height_m},
                              {0.18, 0.5 * length_m + 0.05, height_m + 0.07}, 0.55));
}

void Furnisher::building(const Spot& spot, const House& house, std::uint64_t looks) {
  // Beyond the radius only when all of it is.
  if ((spot.place_m - centre_m_).norm() > radius_m_ + 0.5 * std::hypot(house.length_m, house.depth_m)) return;
  RandomStream random(looks);
  Facade body;
  body.site_from_frame = upright(spot);
  body.half_m = {0.5 * house.length_m, 0.5 * house.depth_m};
  body.storey_m = house.storey_m;
  body.height_m = house.storeys * house.storey_m + random.uniform(0.4, 0.9);  // with a parapet
  body.bay_m = random.uniform(2.5, 3.4);
  body.window_width_m = body.bay_m * random.uniform(0.42, 0.6);
  body.window_height_m = random.uniform(1.3, 1.7);
  body.recess_m = random.uniform(0.18, 0.4);
  body.wall_reflectivity = random.uniform(0.4, 0.75);
  body.seed = random.next();
  shapes_.push_back(body);
  const Isometry3d& frame = body.site_from_frame;
  const double x = body.half_m.x(), y = body.half_m.y(), top = body.height_m, wall = body.wall_reflectivity;

  // Plinth and cornice all round, pilasters between the bays of the front.
  shapes_.push_back(Hull::box(frame, {-x - 0.1, -y - 0.1, -3.0}, {x + 0.1, y + 0.1, 0.35}, 0.35));
  shapes_.push_back(Hull::box(frame, {-x - 0.18, -y - 0.18, top - 0.25}, {x + 0.18, y + 0.18, top}, wall));
  const double bays = std::floor(2.0 * x / body.bay_m);
  const int every = 2 + static_cast<int>(random.below(3));
  for (int bay = 0; bay <= static_cast<int>(bays); bay += every) {
    const double at = (bay - 0.5 * bays) * body.bay_m;
    shapes_.push_back(Hull::box(frame, {at - 0.2, y - 0.1, -3.0}, {at + 0.2, y + 0.28, top - 0.25}, wall));
  }

  const double place = random.uniform(-0.5, 0.5), extra = random.uniform(1.8, 3.0);
  if (house.roof == House::Roof::Gabled) {  // ridge along x
    Hull gable = Hull::box(frame, {-x, -y - 0.3, top}, {x, y + 0.3, top + 0.35 * house.depth_m}, 0.3);
    gable.cut({0.0, y + 0.3, top}, {0.0, 0.6, 1.0});
    gable.cut({0.0, -y - 0.3, top}, {0.0, -0.6, 1.0});
    shapes_.push_back(gable);
  } else if (house.roof == House::Roof::StairTower) {
    const double half = std::min(2.2, 0.4 * x);
    const double at = place * 2.0 * (x - half);
    shapes_.push_back(Hull::box(frame, {at - half, -0.6 * y, top}, {at + half, y - 0.05, top + extra}, wall));
  }
  // An entrance: slab on two round pillars, and steps.
  const double porch = random.uniform(-0.6, 0.6) * (x - 2.0), out = 1.5;
  if (random.uniform() < 0.6 && x > 3.0) {
    shapes_.push_back(Hull::box(frame, {porch - 1.5, y, 2.55}, {porch + 1.5, y + out, 2.8}, 0.5));
    shapes_.push_back(Hull::box(frame, {porch - 1.5, y, -1.0}, {porch + 1.5, y + out, 0.16}, 0.4));
    for (const double side : {-1.3, 1.3}) {
      const Vector3d pillar = frame * Vector3d(porch + side, y + out - 0.2, 0.0);
      shapes_.push_back(Cylinder{pillar.head<2>(), 0.14, pillar.z() - 1.0, pillar.z() + 2.55, 0.5});
    }
  }
}

}  // namespace tiltmap
