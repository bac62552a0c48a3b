// A maxon EPOS with its motor, gear and the scanner on it, at the other end of a wire.
//
// Speaks one of the protocols and nothing else, byte for byte: in V1 each step waits for its acknowledge and
// a frame is forgotten after 500 ms of silence. Objects have their rights, the drive its states (CiA 402),
// and a new set-point is taken at the rising edge of its bit alone.
#pragma once

#include <deque>
#include <map>
#include <set>

#include "core/base/random.h"
#include "hardware/emulator/emulated_instrument.h"
#include "hardware/emulator/motor_model.h"
#include "hardware/tilt/epos_codec.h"

namespace tiltmap {

struct EposEmulatorSettings {
  EposProtocol protocol = EposProtocol::V2;
  int baud = 115200;
  int node = 1;
  double counts_per_turn = 3125248.0;
  double counts_per_motor_turn = 2048.0;
  double most_speed = 120.0;       // counts/ms, whatever it is told
  double most_acceleration = 2.0;  // counts/ms2
  double settle_s = 0.05;
  double home_rad = -0.6283185307179586;  // where the home switch is: -36 deg
  double start_rad = 0.0;                 // where the tilt stands at power-on
  double lower_rad = -0.8377580409572781, upper_rad = 1.0821041362364843;  // end stops: -48 and 62 deg
  double answer_delay_s = 0.001;
  std::uint64_t seed = 1;

  // What TiltDrive::level_count has to be for it, homed at the switch.
  std::int64_t levelCount() const;
};

enum class EposFault {
  Stall,               // the next move gets stuck on its way: following error
  FollowError,         // the same near its end
  LostSteps,           // the next move ends short, and the encoder tells
  LateReply,           // the next thing it says comes 1.5 s late
  LostAcknowledge,     // the next thing it says is swallowed (V1: the 'O')
  RefusedFrame,        // V1: the next frame is answered by 'F'
  Silence,             // nothing is said until Recover
  LostByte,            // of the next thing it says
  FlippedByte,         // of the next thing it says
  InsertedByte,        // before the next thing it says
  LostCommandByte,     // of what is received next
  FlippedCommandByte,  // of what is received next
  PowerCut,            // off at once, and on again 2 s later: does not know where it stands
  Recover,             // what is silent or was still to come is over
};
// "motor-stall", "follow-error", ...: the words for command lines, where they fit those of the MIP 50.
std::string eposFaultName(EposFault fault);
std::optional<EposFault> eposFaultNamed(std::string_view name);
std::vector<EposFault> allEposFaults();

class EposEmulator : public EmulatedTilt {
 public:
  // On at once. Wire and clock must outlive it.
  EposEmulator(Clock& clock, DeviceWire& wire, EposEmulatorSettings settings = {});

  Instant nextEvent() const override;
  void act(Instant now) override;
  void rewire(DeviceWire& wire) override;
  double angle(Instant at) const override;
  bool still(Instant at) const override;
  Status applyFault(const std::string& text) override;
  std::vector<std::string> knownFaults() const override;

  void inject(EposFault fault);
  double counts(Instant at) const { return motor_.rawPosition(at); }
  // The power stage is on.
  bool enabled() const { return drive_ == Drive::OperationEnabled; }

 private:
  enum class Drive { SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn, OperationEnabled, Fault };
  enum class Expecting { Code, Body, Consent, Verdict };  // of V1
  struct Outgoing {
    Instant at;
    Byte byte;
  };
  struct Entry {
    bool readable = true, writable = true;
    std::int64_t low = 0, high = 0;  // what may be written
    std::uint32_t value = 0;
  };

  void powerOn();
  void receive(Instant now);
  void heardV1(Byte byte, Instant now);
  void heardV2(Byte byte, Instant now);
  EposAnswer answerTo(const std::optional<EposRequest>& request, Instant now);
  EposAnswer write(const EposRequest& request, Instant now);
  std::uint32_t read(std::uint16_t index, Instant now) const;
  void control(std::uint32_t word, Instant now);
  void command(std::uint32_t word, std::uint32_t before, Instant now);
  void startHoming(Instant now);
  void moveTo(double target, double speed, double acceleration, Instant now);
  void endMotion(Instant now);
  void fail402(std::uint32_t code, Instant now);
  std::uint32_t statusWord(Instant now) const;
  std::uint32_t object(std::uint16_t index, Byte sub = 0) const;
  void say(ByteVector bytes, Instant now);
  bool takeFault(EposFault fault);

  Clock& clock_;
  DeviceWire* wire_;
  EposEmulatorSettings settings_;
  MotorModel motor_;
  RandomStream random_;
  std::multiset<EposFault> faults_;
  std::map<std::pair<std::uint16_t, Byte>, Entry> objects_;

  // The wire.
  std::deque<Outgoing> outgoing_;
  Instant wire_free_{}, busy_until_{}, last_heard_{};
  Expecting expecting_ = Expecting::Code;
  EposBodyReader body_;
  ByteVector answer_;  // of V1, until it was received well
  EposStreamReader stream_;
  std::deque<Byte> unheard_;  // while it is busy

  // The drive.
  bool on_ = true;
  Instant back_on_ = kNever;
  Drive drive_ = Drive::SwitchOnDisabled;
  bool moving_ = false, homing_ = false, homed_ = false, taken_ = false, reached_ = true;
  bool trips_ = false;
  Instant trip_ = kNever;
  std::uint32_t error_ = 0;
  double home_count_ = 0.0;  // where the home switch is
  double home_target_ = 0.0, home_value_ = 0.0;
};

}  // namespace tiltmap
