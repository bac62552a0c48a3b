// A maxon EPOS with its motor, as a tilt unit: CiA 402 homing and profile positions.
//
// Written after what is public about the controllers; none was at hand. Nothing is stored in the controller:
// what is set lasts until it is switched off.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "hardware/tilt/epos_link.h"
#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {

struct EposSettings {
  std::optional<EposProtocol> protocol;   // none: found out
  std::vector<int> bauds;                 // tried in this order; empty: 115200, 38400, 57600, 19200, 9600
  int node = 1;                           // 1 to 127
  double counts_per_motor_turn = 2048.0;  // of an encoder with 512 impulses
  int home_method = 27;                   // of CiA 402: 27 goes down to the home switch
  double home_speed = 40.0;               // counts/ms, to the switch; a tenth of it at the switch
  double home_limit_s = 120.0;
};

class EposUnit : public TiltUnit {
 public:
  // The clock must outlive the unit. Throws std::invalid_argument for a drive that check() refuses, and for
  // settings out of their ranges.
  EposUnit(std::unique_ptr<ByteChannel> channel, Clock& clock, TiltDrive drive, EposSettings settings = {});
  ~EposUnit() override;

  const std::string& name() const override { return name_; }
  // Finds the controller (rate and protocol), clears a fault, switches the power stage on, and searches home.
  Status prepare(const JobControl& job) override;
  Status checkAngle(double angle_rad) const override;
  Status moveTo(double angle_rad) override;
  Result<std::optional<TiltReading>> poll() override;
  // Beside sending nothing further, tells a motor that moves to halt.
  void stop() override;
  SteadySpeed steadySpeed(double wished_rad_s) const override;
  Status moveSteadily(double angle_rad, double rate_rad_s) override;
  double steadyDelay() const override;
  std::optional<SteadyMotion> steadyMotion() const override {
    return phase_ == Phase::Still && steady_known_ ? steady_ : std::nullopt;
  }
  Status release() override;
  Status findWhereItStands() override;
  std::vector<InstrumentFact> facts() const override;
  std::vector<std::string> takeWarnings() override;

  EposProtocol protocol() const { return link_.protocol(); }
  // Is there an EPOS, and what does it say of itself? Moves and changes nothing.
  struct Identity {
    EposProtocol protocol;
    int baud;
    std::uint32_t status;
    std::uint32_t error;  // stored last; 0: none
    std::int32_t position;
  };
  Result<Identity> identify(const JobControl& job);

 private:
  // What a move consists of.
  struct Step {
    // Begin: the write that starts a steady move. ReadOnTheWay: where it is meanwhile.
    enum class Kind { Write, Begin, AwaitTaken, AwaitReached, ReadPosition, ReadOnTheWay, ReadError } kind;
    EposRequest request;
    double limit_s = 0.0;  // of waiting
  };
  enum class Phase { Idle, Moving, Gliding, Reading, Checking, Still, Lost };
  struct Told {
    Instant at;
    std::int64_t counts;
  };

  EposRequest reading(std::uint16_t index, Byte sub = 0) const;
  EposRequest writing(std::uint16_t index, Byte sub, std::int64_t value) const;
  Status find(const JobControl& job);
  Result<std::uint32_t> ask(const EposRequest& request, const JobControl* job);
  Status set(std::uint16_t index, Byte sub, std::int64_t value, const JobControl& job);
  Status clearFault(const JobControl& job);
  Status enable(const JobControl& job);
  Status home(const JobControl& job);
  Status setProfile(const JobControl& job);
  Result<bool> advance();
  Result<bool> completed(const Step& step, const EposAnswer& answer);
  Result<bool> watched(const Step& step, std::uint32_t status);
  Status arrivedOrAgain(bool& there);
  void plan();
  void settleSteady();
  double countsPerMs(double rpm_told) const;
  Status lost(Error error);
  Status troubled(const EposRequest& request, std::uint32_t abort);
  Error silent() const;
  double rpm(double counts_per_ms) const;

  std::unique_ptr<ByteChannel> channel_;
  Clock& clock_;
  TiltDrive drive_;
  EposSettings settings_;
  std::string name_;
  EposLink link_;
  std::vector<std::string> warnings_;

  std::deque<Step> steps_;
  std::optional<Instant> waiting_until_;  // of the step under way
  Instant look_again_{};
  std::optional<std::string> fault_;  // why the error code is being read
  Phase phase_ = Phase::Idle;
  bool ready_ = false;
  std::int64_t position_ = 0;
  std::int64_t target_ = 0;
  int attempts_ = 0;
  bool only_reading_ = false;  // where it stands is wanted, not a move
  bool irregular_ = false;     // an answer was late, lost or garbled: look twice
  Instant ended_{};
  Instant move_deadline_{};
  TiltReading reading_;

  double speed_told_ = 0.0;             // revolutions a minute, in profile moves
  std::optional<SteadyMotion> steady_;  // under way, or the last one
  bool steady_known_ = false;           // it is over, and was as it should have been
  std::vector<Told> on_the_way_;
};

}  // namespace tiltmap
