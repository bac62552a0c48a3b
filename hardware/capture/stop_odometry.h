// Where the stops of a capture are, from what the vehicle's own odometry has written or sends.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/body_axes.h"
#include "core/geometry/pose.h"

namespace tiltmap {

// The poses of one source, in its own frame: stops that are placed by one source lie in one frame.
class StopOdometry {
 public:
  // `where`: a TUM file that holds one pose for each stop of the project, in their order; or
  // "tcp://HOST:PORT", a feed of lines, whose latest pose is that of the stop when it is asked. Opens nothing
  // and checks the words; a feed is connected to from now on.
  static Result<std::unique_ptr<StopOdometry>> make(const std::string& where, BodyAxes axes);
  virtual ~StopOdometry() = default;

  // odometry_from_scan of the stop with this index in the project. The vehicle stands there now: of a feed a
  // pose is taken that comes from now on, for which it waits at most limit_s. `last`: the pose of the stop
  // before in the project, where there is one.
  virtual Result<Pose> poseOf(std::size_t stop, const std::optional<Pose>& last, double limit_s,
                              const JobControl& job) = 0;
};

// Whether the words name a source that could be read: a file that is there and holds poses, an address. Asks
// nobody in a network.
Status checkStopOdometry(const std::string& where);
bool isOdometryFeed(const std::string& where);

}  // namespace tiltmap
