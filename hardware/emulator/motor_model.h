// A motor behind a gear that follows trapezoids, and remembers where it was.
#pragma once

#include <deque>

#include "hardware/transport/clock.h"

namespace tiltmap {

// Counts; no wire, no protocol. Where the load is at an instant can be asked for the last kMemory seconds,
// because a scan is looked at when it has been measured.
class MotorModel {
 public:
  static constexpr double kMemoryS = 5.0;

  explicit MotorModel(double start_counts) : rest_(start_counts) {}

  // counts/ms and counts/ms2; from where it stands at `start`, which must not lie before earlier starts.
  void moveTo(Instant start, double target, double speed, double acceleration);
  // Ends the move under way where it is at that instant.
  void haltAt(Instant at);
  // The encoder begins to count anew: every remembered position is shifted by so much.
  void shift(double counts);

  Instant arrival() const { return end_; }  // of the last move
  bool moving(Instant at) const { return at < end_; }
  double rawPosition(Instant at) const;  // as the profile says
  // With what is left of the swing after a move: it dies away within `settle_s` of its end.
  double position(Instant at, double settle_s) const;

 private:
  struct Move {
    Instant start, end;
    double from = 0.0, to = 0.0, speed = 0.0, acceleration = 0.0;
    double at(Instant when) const;
  };
  void forget(Instant before);

  double rest_;  // before the first remembered move
  std::deque<Move> moves_;
  Instant end_{};
};

}  // namespace tiltmap
