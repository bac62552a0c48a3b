// What a simulated site is made of. Every shape answers three questions: where a ray strikes it, how far a
// point is from it, and which box holds it. Site frame (z against gravity), metres.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tiltmap {

struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // close to unit length; distances are counted in its length
};

struct SurfaceHit {
  double distance_m = 0.0;
  Eigen::Vector3d normal;     // unit, against the ray
  double reflectivity = 0.0;  // diffuse, 0 (black) to 1 (white)
};

// A convex body bounded by planes: boxes, car bodies, gable roofs.
class Hull {
 public:
  static constexpr int kMaxPlanes = 12;

  // Corners in the frame's own coordinates.
  static Hull box(const Eigen::Isometry3d& site_from_frame, const Eigen::Vector3d& low,
                  const Eigen::Vector3d& high, double reflectivity);
  // Keeps the side of the plane that the normal points away from; point and normal in the box's frame.
  // Throws std::logic_error beyond kMaxPlanes.
  Hull& cut(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

  std::optional<SurfaceHit> hit(const Ray& ray, double max_distance_m) const;
  double distance(const Eigen::Vector3d& point) const;
  Eigen::AlignedBox3d bounds() const { return bounds_; }

 private:
  Eigen::Isometry3d site_from_frame_ = Eigen::Isometry3d::Identity();
  std::array<Eigen::Vector3d, kMaxPlanes> normal_;
  std::array<double, kMaxPlanes> offset_{};  // normal . p <= offset inside
  int planes_ = 0;
  double reflectivity_ = 0.0;
  Eigen::AlignedBox3d bounds_;
};

// An upright cylinder with a flat top: lamp posts, trunks, round pillars, bins.
struct Cylinder {
  Eigen::Vector2d centre;
  double radius_m = 0.0;
  double low_m = 0.0, high_m = 0.0;
  double reflectivity = 0.0;

  std::optional<SurfaceHit> hit(const Ray& ray, double max_distance_m) const;
  double distance(const Eigen::Vector3d& point) const;
  Eigen::AlignedBox3d bounds() const;
};

struct Ball {
  Eigen::Vector3d centre;
  double radius_m = 0.0;
  double reflectivity = 0.0;

  std::optional<SurfaceHit> hit(const Ray& ray, double max_distance_m) const;
  double distance(const Eigen::Vector3d& point) const;
  Eigen::AlignedBox3d bounds() const;
};

// The crown of a tree: an ellipsoid of cells, some of which hold a clump of leaves, so that beams partly
// pass. Which do is a function of place and seed: the same leaves are seen from everywhere.
struct Foliage {
  Eigen::Vector3d centre;
  double radius_m = 0.0;       // across
  double half_height_m = 0.0;  // along z
  double density = 0.5;        // share of the cells with a clump
  double reflectivity = 0.0;
  std::uint64_t seed = 0;

  static constexpr double kCellM = 0.3;

  std::optional<SurfaceHit> hit(const Ray& ray, double max_distance_m) const;
  double distance(const Eigen::Vector3d& point) const;
  Eigen::AlignedBox3d bounds() const;
};

// The body of a building: an upright box with rows of recessed windows and doors in its four walls.
struct Facade {
  Eigen::Isometry3d site_from_frame = Eigen::Isometry3d::Identity();  // origin: middle of the ground floor
  Eigen::Vector2d half_m = Eigen::Vector2d::Zero();                   // half length along the frame's x and y
  double below_m = 3.0;                                               // how far the foundation goes down
  double height_m = 0.0;
  double storey_m = 3.2;
  double bay_m = 2.8;  // from window to window
  double window_width_m = 1.4, window_height_m = 1.5, sill_m = 0.9;
  double recess_m = 0.3;
  double wall_reflectivity = 0.5, glass_reflectivity = 0.2, door_reflectivity = 0.3;
  std::uint64_t seed = 0;  // decides which bay has a window, a door or a blank wall

  std::optional<SurfaceHit> hit(const Ray& ray, double max_distance_m) const;
  double distance(const Eigen::Vector3d& point) const;
  Eigen::AlignedBox3d bounds() const;
};

using Shape = std::variant<Hull, Cylinder, Ball, Foliage, Facade>;

// The nearest strike in front of the ray's origin and within max_distance_m; nothing where it passes. A ray
// that starts inside a shape does not strike it.
std::optional<SurfaceHit> hitOf(const Shape& shape, const Ray& ray, double max_distance_m);
// At most the distance of the point from the shape, and zero or less exactly where it lies inside.
double distanceOf(const Shape& shape, const Eigen::Vector3d& point);
Eigen::AlignedBox3d boundsOf(const Shape& shape);

}  // namespace tiltmap
