// Odometry over the network: lines `stamp x y z qx qy qz qw` that somebody sends to whoever connects.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/io/pose_track.h"
#include "hardware/transport/tcp_channel.h"

namespace tiltmap {

struct OdometryFeedSettings {
  double silence_s = 3.0;        // without a pose for so long the feed is silent
  double connect_limit_s = 2.0;  // how long the other side may take to accept
  double retry_s = 1.0;          // from a connection that failed to the next attempt
};

enum class FeedState {
  Connecting,  // nobody has accepted yet, or the connection was lost: it is tried again and again
  Waiting,     // connected, and no pose has come yet
  Receiving,
  Silent,  // connected, and nothing that is a pose has come for a while
};

// What is known of a feed at one instant.
struct FeedStatus {
  FeedState state = FeedState::Connecting;
  std::optional<StampedPose> latest;
  double age_s = 0.0;  // of `latest`, since it arrived here; without one, since the feed was begun
  // Poses of one epoch have one origin. A new one begins where a stamp is earlier than the one before: the
  // odometry was begun anew, and its poses cannot be compared with earlier ones.
  int epoch = 0;
  int connections = 0;
  std::uint64_t poses = 0, refused = 0;   // lines
  std::optional<Error> connection_error;  // why there is no connection; nothing while there is one
  std::optional<Error> line_error;        // of the last line that was refused: names line and field

  // Whether `latest` may be taken for where the vehicle is now.
  bool isFresh() const { return state == FeedState::Receiving && latest.has_value(); }
};

// A sentence for the operator, and what to do where something is wrong.
std::string feedText(const FeedStatus& status);

// "HOST:PORT" or "tcp://HOST:PORT".
Result<TcpAddress> parseFeedAddress(const std::string& text);

// Connects and keeps connected, on a thread of its own. Nothing here waits for the network: not the
// constructor, not status(), not the end.
class OdometryFeed {
 public:
  explicit OdometryFeed(const TcpAddress& address, const OdometryFeedSettings& settings = {});
  ~OdometryFeed();
  OdometryFeed(const OdometryFeed&) = delete;
  OdometryFeed& operator=(const OdometryFeed&) = delete;

  const TcpAddress& address() const;
  FeedStatus status() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  // with the thread, which may be the last to leave it
};

}  // namespace tiltmap
