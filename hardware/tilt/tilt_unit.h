// What turns the scanner up and down: whatever drives it, capture sees this.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "hardware/tilt/steady_motion.h"
#include "hardware/transport/clock.h"
#include "hardware/transport/instrument_fact.h"

namespace tiltmap {

// Where the tilt stands.
struct TiltReading {
  double angle_rad = 0.0;   // read back; 0 level, positive up
  std::int64_t counts = 0;  // the encoder's; 0 for units without one
  Instant settled{};        // still from then on; may lie a little ahead
};

// One thread. Failures are written for the operator; after one, prepare() begins anew and nothing that was
// set has to be set again.
class TiltUnit {
 public:
  virtual ~TiltUnit() = default;

  virtual const std::string& name() const = 0;
  // Makes it ready to move: power on, home found. Returns at once when it is ready already. Looks at the stop
  // token every 50 ms; cancelling leaves it standing.
  virtual Status prepare(const JobControl& job) = 0;
  // Refuses what lies outside the limits; nothing moves.
  virtual Status checkAngle(double angle_rad) const = 0;
  // Begins to move to an absolute angle, which is always reached from below, and returns at once.
  virtual Status moveTo(double angle_rad) = 0;
  // Does what is due. Nothing while the unit moves; the reading once it has arrived.
  virtual Result<std::optional<TiltReading>> poll() = 0;
  // Sends nothing further: what moves stands still within 200 ms. The unit stays ready; out of a steady move
  // it may have to be prepared again.
  virtual void stop() = 0;

  // For scanning while the tilt moves: the rate it would take for a wished one, at most that.
  virtual SteadySpeed steadySpeed(double) const { return {}; }
  // Begins to move from where it stands to an angle in one piece, at that rate, and returns at once. poll()
  // tells when it has arrived, and fails where it did not move as it should have.
  virtual Status moveSteadily(double, double) {
    return fail("this tilt cannot move steadily", name(), "capture line by line: --mode stop");
  }
  // How long after moveSteadily() it begins to move, seconds.
  virtual double steadyDelay() const { return 0.0; }
  // How it moved the last time, once it has arrived and that is certain.
  virtual std::optional<SteadyMotion> steadyMotion() const { return std::nullopt; }

  // Lets go of the motor; at the end of the work.
  virtual Status release() = 0;
  // After stop(): asks where it stands, and poll() tells. Nothing moves.
  virtual Status findWhereItStands() { return {}; }
  // What the operator should know, once each.
  virtual std::vector<std::string> takeWarnings() { return {}; }
  // Identity and health as it told them when it was prepared.
  virtual std::vector<InstrumentFact> facts() const { return {}; }
};

// The drive between encoder and scanner: thesis 3.2 has a 1526:1 gear behind a motor of 2048 counts a turn.
struct TiltDrive {
  double counts_per_turn = 3125248.0;        // of the output; negative where counts grow downwards
  std::int64_t level_count = 0;              // where the scanner looks straight ahead, counted from home
  double minimum_rad = -0.7853981633974483;  // -45 deg
  double maximum_rad = 1.0471975511965976;   // 60 deg
  double speed = 120.0;                      // counts/ms; a 48 V motor on 24 V reaches about this
  double acceleration = 2.0;                 // counts/ms2
  double settle_s = 0.05;
  double tolerance_rad = 0.0003;   // between where it should stand and where it does
  double approach_rad = 0.035;     // how far below a target a way down ends first: more than the gear's play
  double longest_segment_s = 0.2;  // a move is a chain of such, so that stopping always takes effect

  double angleOf(std::int64_t counts) const;
  std::int64_t countsOf(double angle_rad) const;  // nearest
  // Of one move with ramps; counts of any sign.
  double moveDuration(double counts) const;
  // The longest move, in counts, that is over within longest_segment_s.
  double longestSegment() const;
  // Everything positive and finite, limits in order, a tolerance that an encoder can tell.
  Status check() const;
};

// "12.30 deg".
std::string angleText(double angle_rad);
// Refuses an angle outside the limits, in the words of the unit `name`; `given_with` says where its limits
// come from.
Status withinLimits(double angle_rad, double minimum_rad, double maximum_rad, const std::string& name,
                    const std::string& given_with);

// The stations of a move: where each segment ends, the target last. From above, it first goes approach_rad
// below the target (as far as the limits let it).
std::vector<std::int64_t> segmentsOf(const TiltDrive& drive, std::int64_t from, std::int64_t to);

}  // namespace tiltmap
