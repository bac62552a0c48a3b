#include "hardware/odometry/odometry_feed.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/feed_server.h"

namespace tiltmap {
namespace {

using test::FeedServer;

// Never silent, and quickly there again.
constexpr OdometryFeedSettings kPatient{.silence_s = 1000.0, .retry_s = 0.01};

// The status once it is as wanted; the last one where that does not come about in 20 s (a defect).
template <class Condition>
FeedStatus statusWhen(const OdometryFeed& feed, const Condition& condition) {
  for (int k = 0; k < 4000; ++k) {
    const FeedStatus status = feed.status();
    if (condition(status)) return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ADD_FAILURE() << "never came about; the feed says: " << feedText(feed.status());
  return feed.status();
}
FeedStatus afterPoses(const OdometryFeed& feed, std::uint64_t count) {
  return statusWhen(feed, [&](const FeedStatus& s) { return s.poses >= count; });
}

TEST(OdometryFeed, KeepsTheLatestPose) {
  FeedServer server;
  const OdometryFeed feed(server.address(), kPatient);
  EXPECT_EQ(feed.address(), server.address());
  EXPECT_FALSE(feed.status().isFresh());
  const FeedStatus waiting =
      statusWhen(feed, [](const FeedStatus& s) { return s.state == FeedState::Waiting; });
  EXPECT_FALSE(waiting.latest);
  EXPECT_FALSE(waiting.isFresh());
  server.send("10.5 1 2 3 0 0 0.70710678 0.70710678\n");
  FeedStatus status = afterPoses(feed, 1);
  ASSERT_TRUE(status.latest);
  EXPECT_TRUE(status.isFresh());
  EXPECT_EQ(status.state, FeedState::Receiving);
  EXPECT_EQ(status.latest->stamp_s, 10.5);
  EXPECT_EQ(status.latest->world_from_body.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(status.connection_error);
  EXPECT_EQ(status.connections, 1);
  // Many at once: the last one counts. Remarks and blank lines are none.
  server.send(FeedServer::line(11) + "# a remark\r\n\r\n" + FeedServer::line(12) + FeedServer::line(13, 7.5));
  status = afterPoses(feed, 4);
  EXPECT_EQ(status.latest->stamp_s, 13.0);
  EXPECT_EQ(status.latest->world_from_body.translation().x(), 7.5);
  EXPECT_EQ(status.refused, 0U);
  EXPECT_EQ(status.epoch, 0);
}

TEST(OdometryFeed, ALineMayComeInPieces) {
  FeedServer server;
  const OdometryFeed feed(server.address(), kPatient);
  for (const char* piece : {"10.", "5 1 2", " 3 0 0 0 ", "1", "\r", "\n11 4 ", "5 6 0 0 0 1\n12 9 9 9 0 0"}) {
    server.send(piece);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const FeedStatus status = afterPoses(feed, 2);
  EXPECT_EQ(status.latest->stamp_s, 11.0) << "the third one is not complete";
  EXPECT_EQ(status.latest->world_from_body.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(status.refused, 0U);
}

TEST(OdometryFeed, GarbageIsRefusedByNameAndHarmsNothing) {
  FeedServer server;
  const OdometryFeed feed(server.address(), kPatient);
  server.send(FeedServer::line(1, 5.0));
  afterPoses(feed, 1);
  const std::pair<std::string, const char*> garbage[] = {
      {"hello\n", "there are 1"},
      {"2 1 nan 0 0 0 0 1\n", "y: \"nan\""},
      {"3 0 0 0 0 0 0 0.5\n", "length 0.500"},
      {std::string("\x00\xff\x7f\n", 4), "there are"},
      {std::string(3000, 'x') + "\n", "more than 1024"},
  };
  std::uint64_t refused = 0;
  for (const auto& [text, told] : garbage) {
    server.send(text);
    ++refused;
    const FeedStatus status = statusWhen(feed, [&](const FeedStatus& s) { return s.refused >= refused; });
    EXPECT_EQ(status.refused, refused);
    ASSERT_TRUE(status.line_error);
    EXPECT_NE(status.line_error->what.find(told), std::string::npos) << status.line_error->what;
    EXPECT_NE(status.line_error->where.find("line " + std::to_string(refused + 1)), std::string::npos)
        << status.line_error->where;
    EXPECT_EQ(status.latest->stamp_s, 1.0) << "what is refused is no pose";
    EXPECT_NE(feedText(status).find("refused; last: line"), std::string::npos);
  }
  server.send(FeedServer::line(4, 6.0));
  EXPECT_EQ(afterPoses(feed, 2).latest->world_from_body.translation().x(), 6.0);
}

TEST(OdometryFeed, ComesBackAfterTheConnectionWasLost) {
  FeedServer server;
  const OdometryFeed feed(server.address(), kPatient);
  server.send(FeedServer::line(1) + "2 3 4 0 0");  // cut off
  afterPoses(feed, 1);
  server.hangUp();
  // On the new connection: the rest of the cut line is none of its own.
  server.send(FeedServer::line(3, 7.0));
  const FeedStatus status = afterPoses(feed, 2);
  EXPECT_EQ(status.connections, 2);
  EXPECT_EQ(status.latest->world_from_body.translation().x(), 7.0);
  EXPECT_EQ(status.refused, 0U);
  EXPECT_EQ(status.epoch, 0) << "the odometry went on";
  EXPECT_EQ(status.state, FeedState::Receiving);
  EXPECT_FALSE(status.connection_error);
}

TEST(OdometryFeed, IsLookedForUntilItIsThere) {
  int port = 0;
  { port = FeedServer().address().port; }
  const OdometryFeed feed({"127.0.0.1", port}, kPatient);
  const FeedStatus status =
      statusWhen(feed, [](const FeedStatus& s) { return s.connection_error.has_value(); });
  EXPECT_EQ(status.state, FeedState::Connecting);
  EXPECT_NE(feedText(status).find("refuses"), std::string::npos) << feedText(status);
  FeedServer server(port);
  server.send(FeedServer::line(1));
  EXPECT_TRUE(afterPoses(feed, 1).isFresh());
}

TEST(OdometryFeed, GoneWithoutReturningItSaysSo) {
  auto server = std::make_unique<FeedServer>();
  const OdometryFeed feed(server->address(), kPatient);
  server->send(FeedServer::line(1));
  afterPoses(feed, 1);
  server.reset();
  const FeedStatus status =
      statusWhen(feed, [](const FeedStatus& s) { return s.state == FeedState::Connecting; });
  EXPECT_FALSE(status.isFresh()) << "where the vehicle was is not where it is";
  EXPECT_TRUE(status.latest);
  EXPECT_TRUE(status.connection_error);
  EXPECT_NE(feedText(status).find("again"), std::string::npos);
}

TEST(OdometryFeed, SilenceIsNoticed) {
  FeedServer server;
  const OdometryFeed feed(server.address(), {.silence_s = 0.05, .retry_s = 0.01});
  statusWhen(feed, [](const FeedStatus& s) { return s.state == FeedState::Silent && !s.latest; });
  server.send(FeedServer::line(1));
  afterPoses(feed, 1);
  FeedStatus status = statusWhen(feed, [](const FeedStatus& s) { return s.state == FeedState::Silent; });
  EXPECT_FALSE(status.isFresh());
  EXPECT_NE(feedText(status).find("Silent"), std::string::npos) << feedText(status);
  // What is no pose does not end it.
  server.send("hello\n");
  status = statusWhen(feed, [](const FeedStatus& s) { return s.refused == 1; });
  EXPECT_EQ(status.state, FeedState::Silent);
  std::jthread talking([&](const std::stop_token& stop) {
    for (int k = 2; !stop.stop_requested(); ++k) {
      server.send(FeedServer::line(k));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  statusWhen(feed, [](const FeedStatus& s) { return s.isFresh(); });
}

TEST(OdometryFeed, AStampThatGoesBackBeginsANewEpoch) {
  FeedServer server;
  const OdometryFeed feed(server.address(), kPatient);
  server.send(FeedServer::line(100) + FeedServer::line(101));
  EXPECT_EQ(afterPoses(feed, 2).epoch, 0);
  server.send(FeedServer::line(1) + FeedServer::line(2));
  const FeedStatus status = afterPoses(feed, 4);
  EXPECT_EQ(status.epoch, 1);
  EXPECT_EQ(status.latest->stamp_s, 2.0);
}

TEST(OdometryFeed, EndsAtOnceEvenWhileItConnects) {
  // More clients than are ever welcomed fill the queue; further ones wait for an answer that does not come.
  RealClock clock;
  auto wire = TcpWire::listen(clock);
  ASSERT_TRUE(wire);
  std::vector<std::unique_ptr<TcpChannel>> waiting;
  for (int k = 0; k < 16; ++k)
    if (auto channel = TcpChannel::connect({"127.0.0.1", (*wire)->port()}, clock, 0.05))
      waiting.push_back(std::move(*channel));
  EXPECT_LT(waiting.size(), 16U);
  // Waiting for its thread would take an hour here.
  const auto feed = std::make_unique<OdometryFeed>(TcpAddress{"127.0.0.1", (*wire)->port()},
                                                   OdometryFeedSettings{.connect_limit_s = 3600.0});
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(feed->status().state, FeedState::Connecting);
  EXPECT_EQ(feedText(feed->status()), "Connecting.");
}

TEST(OdometryFeed, ItsAddress) {
  EXPECT_EQ(parseFeedAddress("10.0.0.5:7000").value(), (TcpAddress{"10.0.0.5", 7000}));
  EXPECT_EQ(parseFeedAddress(" tcp://rover.local:7000 ").value(), (TcpAddress{"rover.local", 7000}));
  EXPECT_EQ(parseFeedAddress("tcp://[::1]:7000").value(), (TcpAddress{"::1", 7000}));
  for (const char* text : {"", "tcp://", "rover", "rover:", "rover:0", ":7000", "udp://rover:7000", "a:b:1"})
    EXPECT_FALSE(parseFeedAddress(text)) << text;
}

}  // namespace
}  // namespace tiltmap
