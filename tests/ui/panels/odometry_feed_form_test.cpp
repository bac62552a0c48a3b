// The form with a server of poses at this machine.
#include <QSignalSpy>

#include "tests/support/feed_server.h"
#include "tests/ui/support/odometry_form_fixture.h"
#include "tests/ui/support/wait_until.h"

namespace tiltmap::test {
namespace {

using ui::OdometryForm;

class OdometryFeedFormTest : public OdometryFormTest {
 protected:
  void connectToServer() {
    click("odometry-feed");
    type("odometry-feed-address", ui::qt(server.address().text()));
    click("odometry-feed-connect");
  }
  bool receives(const QString& x) {
    return waitUntil([&] {
      return find<QLabel>("odometry-feed-pose")->text().startsWith("Latest: x " + x) &&
             find<QLabel>("odometry-feed-state")->text().startsWith("Receiving");
    });
  }
  FeedServer server;
};

TEST_F(OdometryFeedFormTest, TheStepIsBetweenTwoPosesThatWereTaken) {
  click("odometry-feed");
  EXPECT_TRUE(misses("o feed is connected"));
  EXPECT_FALSE(find("odometry-feed-take")->isEnabled());
  connectToServer();
  EXPECT_EQ(find<QToolButton>("odometry-feed-connect")->text(), "Disconnect");
  EXPECT_TRUE(waitUntil([&] { return find<QLabel>("odometry-feed-state")->text().startsWith("Connected"); }));
  EXPECT_FALSE(find("odometry-feed-take")->isEnabled()) << "there is no pose yet";
  server.send(FeedServer::line(1, 5.0, 5.0));
  ASSERT_TRUE(receives("5.00"));
  EXPECT_TRUE(misses("pose at the last stop is not known"));
  click("odometry-feed-here");
  EXPECT_TRUE(misses("has not been taken"));
  server.send("2 7 5 0 0 0 0.1305262 0.9914449\n");
  ASSERT_TRUE(receives("7.00"));
  EXPECT_TRUE(misses("has not been taken")) << "it is not taken by itself";
  QSignalSpy changed(form.get(), &OdometryForm::changed);
  click("odometry-feed-take");
  EXPECT_GT(changed.count(), 0);
  EXPECT_TRUE(tells(Pose::planar(0.0, 2.0, 15.0 * kDegree)));
  EXPECT_EQ(sentence(), "2.00 m forward, turned 15° to the left");
  // What comes later changes nothing, until it is taken or the stop is captured.
  server.send(FeedServer::line(3, 9.0, 5.0));
  ASSERT_TRUE(receives("9.00"));
  EXPECT_TRUE(tells(Pose::planar(0.0, 2.0, 15.0 * kDegree)));
  choose("odometry-feed-axes", 1);
  EXPECT_TRUE(tells(Pose::planar(2.0, 0.0, 15.0 * kDegree)));
  choose("odometry-feed-axes", 0);
  form->stopCaptured();
  EXPECT_TRUE(misses("has not been taken"));
  server.send("4 9 5 0 0 0 0.1305262 0.9914449\n");
  ASSERT_TRUE(
      waitUntil([&] { return find<QLabel>("odometry-feed-pose")->text().indexOf("stamp 4.00") > 0; }));
  click("odometry-feed-take");
  // From (7, 5) looking 15 deg to the left.
  EXPECT_TRUE(tells(Pose::planar(2.0 * std::sin(15.0 * kDegree), 2.0 * std::cos(15.0 * kDegree), 0.0)));
  click("odometry-feed-connect");
  EXPECT_TRUE(find<QLabel>("odometry-feed-state")->text().startsWith("Not connected"));
  EXPECT_FALSE(find("odometry-feed-take")->isEnabled());
  EXPECT_TRUE(form->lastFromNext()) << "what was taken stays taken";
}

TEST_F(OdometryFeedFormTest, TheFirstStopsPoseIsKeptForTheSecond) {
  form->setFirstStop(true);
  connectToServer();
  server.send(FeedServer::line(1, 1.0, 0.0));
  ASSERT_TRUE(receives("1.00"));
  EXPECT_FALSE(find("odometry-feed-take")->isEnabled());
  form->stopCaptured();
  form->setFirstStop(false);
  EXPECT_TRUE(misses("has not been taken"));
  server.send(FeedServer::line(2, 4.0, 0.0));
  ASSERT_TRUE(receives("4.00"));
  click("odometry-feed-take");
  EXPECT_TRUE(tells(Pose::planar(0.0, 3.0, 0.0)));
}

TEST_F(OdometryFeedFormTest, AnOdometryBegunAnewIsNotBelieved) {
  connectToServer();
  server.send(FeedServer::line(100, 1.0));
  ASSERT_TRUE(receives("1.00"));
  click("odometry-feed-here");
  server.send(FeedServer::line(2, 3.0));
  ASSERT_TRUE(receives("3.00"));
  click("odometry-feed-take");
  EXPECT_TRUE(misses("begun anew"));
  // The same where it was begun anew while nobody was connected.
  click("odometry-feed-here");
  EXPECT_TRUE(misses("has not been taken"));
  click("odometry-feed-connect");
  server.hangUp();
  click("odometry-feed-connect");
  server.send(FeedServer::line(1, 5.0));
  ASSERT_TRUE(receives("5.00"));
  click("odometry-feed-take");
  EXPECT_TRUE(misses("begun anew"));
}

TEST_F(OdometryFeedFormTest, LongWordsAreNotCutOff) {
  form->resize(240, 300);
  connectToServer();
  server.send(FeedServer::line(1, 123.0) + "1 2 nonsense-that-is-no-number 4 5 6 7 8\n");
  ASSERT_TRUE(receives("123.00"));
  auto* state = find<QLabel>("odometry-feed-state");
  ASSERT_TRUE(waitUntil([&] { return state->text().indexOf("y: \"nonsense") > 0; }))
      << state->text().toStdString();
  QCoreApplication::processEvents();
  for (const char* label : {"odometry-feed-state", "odometry-feed-pose", "odometry-sentence"}) {
    auto* words = find<QLabel>(label);
    EXPECT_GE(words->height(), words->heightForWidth(words->width())) << label;
  }
  // And they give the room back.
  const int before = state->minimumHeight();
  form->resize(900, 560);
  QCoreApplication::processEvents();
  EXPECT_LT(state->minimumHeight(), before);
}

TEST_F(OdometryFeedFormTest, AWrongAddressAndALostFeedAreSaid) {
  click("odometry-feed");
  type("odometry-feed-address", "rover");
  click("odometry-feed-connect");
  EXPECT_FALSE(find<QToolButton>("odometry-feed-connect")->isChecked());
  EXPECT_NE(find<QLabel>("odometry-feed-state")->text().indexOf("HOST:PORT"), -1);
  int port = 0;
  { port = FeedServer().address().port; }
  type("odometry-feed-address", QString("127.0.0.1:%1").arg(port));
  click("odometry-feed-connect");
  EXPECT_TRUE(waitUntil([&] { return find<QLabel>("odometry-feed-state")->text().indexOf("refuses") > 0; }));
  const FeedServer late(port);
  EXPECT_TRUE(waitUntil([&] { return find<QLabel>("odometry-feed-state")->text().startsWith("Connected"); }));
}

}  // namespace
}  // namespace tiltmap::test
