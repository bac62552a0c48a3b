// Time for drivers and emulators: real, sped up, or virtual, so that tests never wait.
#pragma once

#include <chrono>
#include <vector>

namespace tiltmap {

using Duration = std::chrono::nanoseconds;
using Instant = std::chrono::time_point<std::chrono::steady_clock, Duration>;
inline constexpr Instant kNever = Instant::max();

inline double secondsOf(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}
inline Duration durationOf(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

// What drivers, channels and emulators read the time from and wait with.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual Instant now() const = 0;
  // Returns at once for an instant that has passed.
  virtual void sleepUntil(Instant until) = 0;
  void sleepFor(Duration duration) { sleepUntil(now() + duration); }
  // Seconds since the Unix epoch at that instant, for time stamps in files.
  virtual double unixTime(Instant at) const = 0;
  // The time of the machine's steady clock at that instant, for waits of the operating system.
  // Throws std::logic_error for a clock that does not run by itself.
  virtual std::chrono::steady_clock::time_point systemTime(Instant at) const = 0;
};

// The machine's steady clock, `speed` times as fast. Any number of threads.
class RealClock : public Clock {
 public:
  // Throws std::invalid_argument unless speed is positive and finite.
  explicit RealClock(double speed = 1.0);
  Instant now() const override;
  void sleepUntil(Instant until) override;
  double unixTime(Instant at) const override;
  std::chrono::steady_clock::time_point systemTime(Instant at) const override;
  double speed() const { return speed_; }

 private:
  double speed_;
  std::chrono::steady_clock::time_point start_;
  double start_unix_s_;
};

// Something that happens by itself as time goes on: an emulated instrument.
class Actor {
 public:
  virtual ~Actor() = default;
  // When act() wants to be called next; kNever: only when something arrives.
  virtual Instant nextEvent() const = 0;
  // Does everything that is due at `now`. Afterwards nextEvent() must lie behind `now`.
  virtual void act(Instant now) = 0;
};

// Time that passes only while somebody waits, and then at once; what the actors do meanwhile happens at its
// instant, in order of time and, at one instant, of attachment. For one thread: the driver's waits run the
// emulators.
class VirtualClock : public Clock {
 public:
  Instant now() const override { return now_; }
  void sleepUntil(Instant until) override;
  double unixTime(Instant at) const override;
  std::chrono::steady_clock::time_point systemTime(Instant at) const override;

  // Moves to the nearest event of an actor and runs it, or to `limit` where none comes before. False: the
  // limit was reached and nothing is due any more.
  bool step(Instant limit);

  // The actor must be detached before it ends.
  void attach(Actor& actor);
  void detach(Actor& actor);

 private:
  Instant now_{};
  std::vector<Actor*> actors_;
};

}  // namespace tiltmap
