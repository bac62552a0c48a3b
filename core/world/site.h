// A simulated site: ground and shapes, with a tree of boxes so that a ray looks at few of them.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/world/ground.h"
#include "core/world/shapes.h"

namespace tiltmap {

// Immutable once built, so any number of threads may cast rays. Site frame: z against gravity, metres.
class Site {
 public:
  using GroundReflectivity = std::function<double(double x_m, double y_m)>;

  // `reflectivity` of the ground, 0 to 1 (asphalt, paint, grass); 0.2 everywhere where empty.
  Site(Ground ground, std::vector<Shape> shapes, GroundReflectivity reflectivity = {});

  // The nearest surface along the ray.
  std::optional<SurfaceHit> cast(const Ray& ray, double max_distance_m) const;
  // The same for up to kMaxBundle rays that stay close to the first one, in one walk through the tree:
  // hits[i] is what cast(rays[i]) gives. Throws std::invalid_argument for more rays, or fewer slots than
  // rays.
  static constexpr std::size_t kMaxBundle = 16;
  void cast(std::span<const Ray> rays, double max_distance_m,
            std::span<std::optional<SurfaceHit>> hits) const;
  // At most the distance from the point to the nearest shape (not the ground); not positive inside one.
  // Infinite for a site without shapes.
  double clearance(const Eigen::Vector3d& point) const;

  const Ground& ground() const { return ground_; }
  const std::vector<Shape>& shapes() const { return shapes_; }

 private:
  struct Node {
    Eigen::Array4f low, high;  // the fourth lane is filler, so that one vector instruction serves all axes
    std::uint32_t first = 0;   // leaf: first shape; inner: the left child, the right one follows it
    std::uint32_t count = 0;   // shapes of a leaf; 0 for an inner node
  };
  void castAtShapes(std::span<const Ray> rays, std::span<double> reach,
                    std::span<std::optional<SurfaceHit>> hits) const;
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& order,
             const std::vector<Eigen::AlignedBox3d>& bounds);

  Ground ground_;
  std::vector<Shape> shapes_;  // in leaf order
  GroundReflectivity reflectivity_;
  std::vector<Node> nodes_;
};

}  // namespace tiltmap
