#include "core/multiview/metascan.h"

#include "core/registration/registration.h"

namespace tiltmap {

namespace {

void appendMoved(const SurfaceElements& from, const Pose& to_from_from, SurfaceElements& to) {
  const Eigen::Matrix3d rotation = to_from_from.rotation();
  const Eigen::Vector3d shift = to_from_from.translation();
  for (std::size_t i = 0; i < from.size(); ++i) {
    to.position.push_back(rotation * from.position[i] + shift);
    to.normal.push_back(rotation * from.normal[i]);
  }
  for (PatchShape shape : from.shape) {
    shape.u = rotation * shape.u;
    shape.v = rotation * shape.v;
    to.shape.push_back(shape);
  }
}

}  // namespace

PreparedScanPtr metascan(std::span<const PreparedScanPtr> scans, std::span<const Pose> world_from_scan,
                         std::span<const int> members, const Pose& world_from_frame,
                         const RegistrationSettings& settings) {
  auto result = std::make_shared<PreparedScan>();
  std::size_t total = 0;
  for (const int member : members) total += scans[static_cast<std::size_t>(member)]->elements.size();
  result->elements.position.reserve(total);
  result->elements.normal.reserve(total);
  const Pose frame_from_world = world_from_frame.inverse();
  for (const int member : members) {
    const auto index = static_cast<std::size_t>(member);
    appendMoved(scans[index]->elements, frame_from_world * world_from_scan[index], result->elements);
    result->raw_points += scans[index]->raw_points;
  }
  addSearch(settings, *result);
  return result;
}

MetascanAlignment alignToMetascan(std::span<const PreparedScanPtr> scans,
                                  std::span<const Pose> world_from_scan, std::span<const int> members,
                                  int scan, const Pose& start_world_from_scan,
                                  const RegistrationSettings& settings, const std::stop_token& stop,
                                  const std::function<void(const Registration&)>& each) {
  const PreparedScanPtr model = metascan(scans, world_from_scan, members, start_world_from_scan, settings);
  Registration registration(model, scans[static_cast<std::size_t>(scan)], Pose(), settings);
  if (each) each(registration);
  while (!registration.done()) {
    registration.step(stop);
    if (each) each(registration);
  }
  MetascanAlignment result;
  result.reason = *registration.stopReason();
  result.pairs = registration.keptPairs();
  result.rms_m = registration.rms();
  result.world_from_scan = start_world_from_scan;
  if (isSuccess(result.reason)) {
    result.world_from_scan = start_world_from_scan * registration.fixedFromMoving();
    result.moved = difference(start_world_from_scan, result.world_from_scan);
  }
  return result;
}

}  // namespace tiltmap
