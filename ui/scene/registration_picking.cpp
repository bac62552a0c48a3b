// What lies under the pointer: handles, pairs, points.
#include "ui/scene/registration_parts.h"

namespace tiltmap::ui {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d RegistrationLayer::handlePixel(GizmoHandle handle) const {
  const Parts& p = *parts_;
  return p.scene.pixelOf(gizmoPlace(handle, p.pose, p.gizmoLength()));
}

GizmoHandle RegistrationLayer::gizmoAt(const Vector2d& pixel) const {
  const Parts& p = *parts_;
  if (!p.gizmo_shown) return GizmoHandle::None;
  GizmoHandle best = GizmoHandle::None;
  double nearest = 12.0 * p.pixel_ratio;
  const double length = p.gizmoLength();
  const auto offer = [&](GizmoHandle handle, const Vector3d& place) {
    const double away = (p.scene.pixelOf(place) - pixel).norm();
    if (away < nearest) nearest = away, best = handle;
  };
  for (const GizmoHandle handle : {GizmoHandle::X, GizmoHandle::Y, GizmoHandle::Z, GizmoHandle::Plane})
    offer(handle, gizmoPlace(handle, p.pose, length));
  for (const Vector3d& place : ringPlaces(p.pose, length)) offer(GizmoHandle::Turn, place);
  return best;
}

RegistrationLayer::Drag RegistrationLayer::dragged(GizmoHandle handle, const Vector2d& from,
                                                   const Vector2d& to) const {
  const Parts& p = *parts_;
  const auto pixels = [&p](const Vector3d& world) { return p.scene.pixelOf(world); };
  return dragOf(handle, p.pose.translation(), from, to, pixels);
}

std::optional<std::size_t> RegistrationLayer::pickPair(const Vector2d& pixel, double radius_px) const {
  const Parts& p = *parts_;
  std::optional<std::size_t> best;
  double nearest = radius_px;
  for (std::size_t i = 0; i < p.pairs.size(); ++i) {
    const TracedPair& pair = p.pairs[i];
    if (!p.shows(pair)) continue;
    Vector2d a = p.scene.pixelOf(p.pose * pair.moving_point), b = p.scene.pixelOf(pair.fixed_point);
    if (pair.pair.reason == RejectReason::NoPartner)
      (pair.pair.from_fixed ? a : b) = pair.pair.from_fixed ? b : a;
    if (!a.allFinite() || !b.allFinite()) continue;
    const double square = (b - a).squaredNorm();
    const double along = square > 0.0 ? std::clamp((pixel - a).dot(b - a) / square, 0.0, 1.0) : 0.0;
    const double away = (a + along * (b - a) - pixel).norm();
    if (away < nearest) nearest = away, best = i;
  }
  return best;
}

std::optional<Vector3d> RegistrationLayer::pickPoint(bool of_fixed, const Vector2d& pixel,
                                                     double radius_px) const {
  const Parts& p = *parts_;
  const std::vector<float>& xyz = of_fixed ? p.fixed_xyz : p.moving_xyz;
  const Pose pose = of_fixed ? Pose() : p.pose;
  std::optional<Vector3d> best;
  double nearest = radius_px;
  for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
    const Vector3d own(xyz[i], xyz[i + 1], xyz[i + 2]);
    const double away = (p.scene.pixelOf(pose * own) - pixel).norm();
    if (away < nearest) nearest = away, best = own;
  }
  return best;
}

}  // namespace tiltmap::ui
