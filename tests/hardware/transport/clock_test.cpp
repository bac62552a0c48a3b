#include "hardware/transport/clock.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

class Metronome : public Actor {
 public:
  Metronome(VirtualClock& clock, std::string& heard, char sound, Duration period)
      : clock_(clock), heard_(heard), sound_(sound), period_(period), next_(clock.now() + period) {
    clock_.attach(*this);
  }
  ~Metronome() override { clock_.detach(*this); }
  Instant nextEvent() const override { return next_; }
  void act(Instant now) override {
    EXPECT_EQ(now, next_);
    EXPECT_EQ(now, clock_.now());
    heard_ += sound_;
    next_ += period_;
  }

 private:
  VirtualClock& clock_;
  std::string& heard_;
  char sound_;
  Duration period_;
  Instant next_;
};

TEST(VirtualClock, RunsActorsInOrderOfTime) {
  VirtualClock clock;
  std::string heard;
  {
    Metronome slow(clock, heard, 's', 300ms);
    Metronome fast(clock, heard, 'f', 200ms);
    clock.sleepFor(600ms);
    EXPECT_EQ(heard, "fsfsf");
    EXPECT_EQ(clock.now(), Instant{} + 600ms);
    EXPECT_TRUE(clock.step(clock.now() + 1s));
    EXPECT_EQ(clock.now(), Instant{} + 800ms);
  }
  clock.sleepFor(1h);
  EXPECT_EQ(heard, "fsfsff");
  EXPECT_NEAR(clock.unixTime(Instant{} + 2s) - clock.unixTime(Instant{}), 2.0, 1e-6);
}

TEST(VirtualClock, DoesNotGoBackAndHasNoSleepWithoutEnd) {
  VirtualClock clock;
  clock.sleepFor(2s);
  clock.sleepUntil(Instant{} + 1s);
  EXPECT_EQ(clock.now(), Instant{} + 2s);
  EXPECT_THROW(clock.sleepUntil(kNever), std::logic_error);
  EXPECT_THROW(clock.systemTime(clock.now()), std::logic_error);
}

TEST(RealClock, SpeedStretchesWhatIsWaitedFor) {
  RealClock clock(50.0);
  const Instant begin = clock.now();
  const auto begin_system = clock.systemTime(begin);
  EXPECT_NEAR(secondsOf(clock.systemTime(begin + 10s) - begin_system), 0.2, 1e-6);
  clock.sleepUntil(begin + 500ms);
  EXPECT_GE(clock.now(), begin + 499ms);
  EXPECT_EQ(clock.systemTime(kNever), kNever);
  EXPECT_THROW(RealClock(0.0), std::invalid_argument);
  EXPECT_THROW(RealClock(-1.0), std::invalid_argument);
}

}  // namespace
}  // namespace tiltmap
