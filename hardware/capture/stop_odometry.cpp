#include "hardware/capture/stop_odometry.h"

#include <chrono>
#include <thread>

#include "core/io/pose_track.h"
#include "hardware/odometry/odometry_feed.h"

namespace tiltmap {

namespace {

constexpr std::string_view kFeed = "tcp://";
constexpr auto kLook = std::chrono::milliseconds(20);

// Read again at each stop: it may grow while the vehicle drives.
class FileOdometry : public StopOdometry {
 public:
  FileOdometry(std::string file, BodyAxes axes)
      : file_(std::move(file)), scan_from_body_(scanFromBody(axes)) {}

  Result<Pose> poseOf(std::size_t stop, const std::optional<Pose>& last, double, const JobControl&) override {
    const auto track = PoseTrack::read(file_);
    if (!track) return fail(track.error());
    if (stop >= track->size())
      return fail("the file holds " + std::to_string(track->size()) +
                      (track->size() == 1 ? " pose" : " poses") + ", and none for stop " +
                      std::to_string(stop),
                  file_, "write a pose for each stop of the project, in their order");
    const Pose& here = track->at(stop).world_from_body;
    // Where the project has its stops by now: they may have been placed by another source, or moved.
    if (stop > 0 && last)
      return *last * stepBetween(track->at(stop - 1).world_from_body, here, scan_from_body_);
    return here * scan_from_body_.inverse();
  }

 private:
  std::string file_;
  Pose scan_from_body_;
};

class FedOdometry : public StopOdometry {
 public:
  FedOdometry(const TcpAddress& address, BodyAxes axes)
      : feed_(address), scan_from_body_(scanFromBody(axes)) {}

  Result<Pose> poseOf(std::size_t, const std::optional<Pose>&, double limit_s,
                      const JobControl& job) override {
    const std::uint64_t before = feed_.status().poses;
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
    FeedStatus now = feed_.status();
    while (!(now.isFresh() && now.poses > before)) {
      if (job.stopRequested()) return fail(kCancelled, "odometry", "start it again");
      if (std::chrono::steady_clock::now() >= until)
        return fail("no odometry has come: " + feedText(now), feed_.address().text(),
                    "see to the feed, or give the step with --odometry X,Y,HEADING");
      job.tell(-1.0, "waiting for the odometry of " + feed_.address().text());
      std::this_thread::sleep_for(kLook);
      now = feed_.status();
    }
    if (epoch_ && *epoch_ != now.epoch)
      return fail(
          "the vehicle's odometry was begun anew since the last stop", feed_.address().text(),
          "give this step with --odometry X,Y,HEADING; the stops after it need a project of their own");
    epoch_ = now.epoch;
    return now.latest->world_from_body * scan_from_body_.inverse();
  }

 private:
  OdometryFeed feed_;
  Pose scan_from_body_;
  std::optional<int> epoch_;
};

}  // namespace

bool isOdometryFeed(const std::string& where) {
  return where.starts_with(kFeed);
}

Status checkStopOdometry(const std::string& where) {
  if (isOdometryFeed(where)) return parseFeedAddress(where).map([](const auto&) {});
  return PoseTrack::read(where).map([](const auto&) {});
}

Result<std::unique_ptr<StopOdometry>> StopOdometry::make(const std::string& where, BodyAxes axes) {
  if (Status status = checkStopOdometry(where); !status) return fail(status.error());
  if (!isOdometryFeed(where)) return std::make_unique<FileOdometry>(where, axes);
  const auto address = parseFeedAddress(where);
  return std::make_unique<FedOdometry>(*address, axes);
}

}  // namespace tiltmap
