#include "hardware/odometry/odometry_feed.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/text.h"

namespace tiltmap {

namespace {

using std::chrono::steady_clock;

constexpr double kSlice_s = 0.02;           // how late the end of the feed is noticed
constexpr std::size_t kLongestLine = 1024;  // eight numbers with all their digits are 200 letters

double secondsSince(steady_clock::time_point then) {
  return std::chrono::duration<double>(steady_clock::now() - then).count();
}

// Lines out of what arrives, in pieces as the network cuts it.
class LineCutter {
 public:
  // Calls `take` for each line that is complete, without its end, and `tooLong` once for each that never is.
  template <class Take, class TooLong>
  void add(std::span<const Byte> bytes, const Take& take, const TooLong& tooLong) {
    for (const Byte byte : bytes) {
      if (byte == '\n') {
        if (skipping_)
          skipping_ = false;
        else
          take(line_);
        line_.clear();
      } else if (!skipping_) {
        line_ += static_cast<char>(byte);
        if (line_.size() > kLongestLine) {
          tooLong();
          skipping_ = true;
          line_.clear();
        }
      }
    }
  }

 private:
  std::string line_;
  bool skipping_ = false;
};

}  // namespace

struct OdometryFeed::Shared {
  Shared(const TcpAddress& to, const OdometryFeedSettings& how)
      : address(to), settings(how), begun(steady_clock::now()) {}

  void run();
  void receive(TcpChannel& channel);
  void takeLine(std::string_view line, std::size_t number);
  void refuse(Error error);
  void pause(double seconds);

  const TcpAddress address;
  const OdometryFeedSettings settings;
  const steady_clock::time_point begun;
  RealClock clock;
  std::atomic<bool> ended = false;

  mutable std::mutex mutex;
  std::condition_variable changed;
  // Below: under the mutex.
  FeedStatus status;
  bool connected = false;
  std::optional<steady_clock::time_point> pose_at, connected_at;
};

void OdometryFeed::Shared::pause(double seconds) {
  std::unique_lock lock(mutex);
  changed.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ended.load(); });
}

void OdometryFeed::Shared::run() {
  while (!ended) {
    auto channel = TcpChannel::connect(address, clock, settings.connect_limit_s);
    if (ended) return;
    {
      const std::lock_guard lock(mutex);
      connected = channel.has_value();
      if (channel) {
        ++status.connections;
        status.connection_error.reset();
        connected_at = steady_clock::now();
      } else {
        status.connection_error = channel.error();
      }
    }
    if (channel) receive(**channel);
    if (!ended) pause(settings.retry_s);
  }
}

void OdometryFeed::Shared::receive(TcpChannel& channel) {
  LineCutter cutter;
  std::array<Byte, 4096> buffer{};
  std::size_t number = 0;
  while (!ended) {
    const auto count = channel.read(buffer, clock.now() + durationOf(kSlice_s));
    if (!count) {
      const std::lock_guard lock(mutex);
      connected = false;
      status.connection_error = count.error();
      return;
    }
    cutter.add(
        std::span(buffer).first(*count), [&](std::string_view line) { takeLine(line, ++number); },
        [&] {
          refuse({"a line of more than " + std::to_string(kLongestLine) + " letters is no pose",
                  "line " + std::to_string(++number), "send lines: stamp x y z qx qy qz qw"});
        });
  }
}

void OdometryFeed::Shared::takeLine(std::string_view line, std::size_t number) {
  if (isPoseComment(line)) return;
  const auto pose = parseStampedPose(line, "line " + std::to_string(number));
  if (!pose) {
    refuse(pose.error());
    return;
  }
  const std::lock_guard lock(mutex);
  if (status.latest && pose->stamp_s < status.latest->stamp_s) ++status.epoch;
  status.latest = *pose;
  ++status.poses;
  pose_at = steady_clock::now();
}

void OdometryFeed::Shared::refuse(Error error) {
  const std::lock_guard lock(mutex);
  ++status.refused;
  status.line_error = std::move(error);
}

OdometryFeed::OdometryFeed(const TcpAddress& address, const OdometryFeedSettings& settings)
    : shared_(std::make_shared<Shared>(address, settings)) {
  // Not joined at the end: looking up a name can take half a minute and nothing interrupts it. What the
  // thread uses is its own as well, and it ends as soon as it can.
  std::thread([shared = shared_] { shared->run(); }).detach();
}

OdometryFeed::~OdometryFeed() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ended = true;
  }
  shared_->changed.notify_all();
}

const TcpAddress& OdometryFeed::address() const {
  return shared_->address;
}

FeedStatus OdometryFeed::status() const {
  const std::lock_guard lock(shared_->mutex);
  const Shared& s = *shared_;
  FeedStatus status = s.status;
  status.age_s = secondsSince(s.pose_at.value_or(s.begun));
  if (!s.connected) {
    status.state = FeedState::Connecting;
    return status;
  }
  // A connection that came back has a while of its own.
  const bool since_connected = s.pose_at && *s.pose_at >= *s.connected_at;
  const double quiet_s = secondsSince(since_connected ? *s.pose_at : *s.connected_at);
  status.state = quiet_s > s.settings.silence_s ? FeedState::Silent
                 : since_connected              ? FeedState::Receiving
                                                : FeedState::Waiting;
  return status;
}

std::string feedText(const FeedStatus& status) {
  const auto seconds = [](double s) { return fixedReal(s, 0) + " s"; };
  std::string text;
  switch (status.state) {
    case FeedState::Connecting:
      text = status.connections > 0 ? "Connecting again" : "Connecting";
      if (status.connection_error)
        text += ": " + status.connection_error->what + " (" + status.connection_error->where + ")";
      text += ".";
      break;
    case FeedState::Waiting:
      text = "Connected; no pose has come yet.";
      break;
    case FeedState::Receiving:
      text = status.age_s < 1.0 ? "Receiving."
                                : "Receiving; the latest pose came " + seconds(status.age_s) + " ago.";
      break;
    case FeedState::Silent:
      text = "Silent: no pose for " + seconds(status.age_s) + ". Is the vehicle's odometry running?";
      break;
  }
  if (status.refused > 0 && status.line_error)
    text += " " + groupedInteger(static_cast<long long>(status.refused)) +
            (status.refused == 1 ? " line" : " lines") + " refused; last: " + status.line_error->where +
            ": " + status.line_error->what + ".";
  return text;
}

Result<TcpAddress> parseFeedAddress(const std::string& text) {
  constexpr std::string_view scheme = "tcp://";
  std::string address(trimmed(text));
  if (address.starts_with(scheme)) address.erase(0, scheme.size());
  const auto parsed =
      address.empty() ? Result<TcpAddress>(fail("no address is given", "", "")) : parseTcpAddress(address, 0);
  if (!parsed)
    return fail(address.empty() ? "no address is given" : printable(text) + " is no address of a feed",
                "odometry", "write HOST:PORT, as 192.168.0.10:7000");
  return *parsed;
}

}  // namespace tiltmap
