// A maxon MIP 50 with its motor, gear and the scanner on it, at the other end of a wire.
//
// What is public about the controller is kept to (mip50_table.h); where nothing is known it is as strict as
// it could be: while the motor moves it answers nothing but a refusal, a follow error switches regulation off
// without a word, and in the text menu a carriage return stops the motor.
#pragma once

#include <deque>
#include <set>

#include "core/base/random.h"
#include "hardware/emulator/emulated_instrument.h"
#include "hardware/emulator/motor_model.h"
#include "hardware/tilt/mip50_codec.h"
#include "hardware/transport/byte_channel.h"

namespace tiltmap {

struct Mip50EmulatorSettings {
  Mip50Table table;
  int axis = 1;
  int baud = 19200;
  double counts_per_turn = 3125248.0;
  double most_speed = 120.0;       // counts/ms, whatever it is told
  double most_acceleration = 2.0;  // counts/ms2
  double settle_s = 0.05;
  double home_rad = -0.6283185307179586;  // where the home switch is: -36 deg
  double start_rad = 0.0;                 // where the tilt stands at power-on
  double home_speed = 40.0;               // counts/ms
  double lower_rad = -0.8377580409572781, upper_rad = 1.0821041362364843;  // end stops: -48 and 62 deg
  double answer_delay_s = 0.001;
  bool text_menu = false;       // start-up mode 0 instead of 2
  bool heeds_interrupt = true;  // the ASCII mode can be left while the motor moves
  std::uint64_t seed = 1;

  // What TiltDrive::level_count has to be for it.
  std::int64_t levelCount() const;
};

enum class Mip50Fault {
  Stall,               // the next move gets stuck on its way; regulation goes off
  FollowError,         // the same near its end, with an error stored
  LostSteps,           // the next move ends short, and the encoder tells
  LateReply,           // the next answer comes 1.5 s late
  LostDone,            // the next acknowledge is swallowed
  Silence,             // nothing is answered until Recover
  LostByte,            // of the next answer
  FlippedByte,         // of the next answer
  InsertedByte,        // before the next answer
  LostCommandByte,     // of what is received next
  FlippedCommandByte,  // of what is received next
  PowerCut,            // off at once, and on again 2 s later: does not know where it stands
  Recover,             // what is stuck or silent works again
};
// "motor-stall", "follow-error", ...: the words for command lines.
std::string mip50FaultName(Mip50Fault fault);
std::optional<Mip50Fault> mip50FaultNamed(std::string_view name);
std::vector<Mip50Fault> allMip50Faults();

class Mip50Emulator : public EmulatedTilt {
 public:
  // Boots at once. Wire and clock must outlive it.
  Mip50Emulator(Clock& clock, DeviceWire& wire, Mip50EmulatorSettings settings = {});

  Instant nextEvent() const override;
  void act(Instant now) override;

  void inject(Mip50Fault fault);
  // Where the scanner looks, for any instant of the last few seconds; radians, positive up.
  double angle(Instant at) const override;
  // Standing, settled, since then.
  bool still(Instant at) const override;
  double counts(Instant at) const { return motor_.rawPosition(at); }
  bool regulated() const { return regulated_; }
  // For another end of the wire, after a plug was pulled and put back.
  void rewire(DeviceWire& wire) override;
  Status applyFault(const std::string& text) override;
  std::vector<std::string> knownFaults() const override;

 private:
  struct Outgoing {
    Instant at;
    char byte;
  };
  void receive(Instant now);
  void hear(char byte, Instant now);
  void obey(const Mip50Command& command, Instant now);
  void typed(char key, Instant now);
  void answer(const Mip50Answer& what, Instant now);
  void refuse(int number, const Mip50Command& command, Instant now);
  void beginMove(double target, double speed, Instant now);
  void endMotion(Instant now);
  void boot(Instant now);
  bool takeFault(Mip50Fault fault);
  void garble(std::string& bytes);

  Clock& clock_;
  DeviceWire* wire_;
  Mip50EmulatorSettings settings_;
  Mip50CommandReader reader_;
  MotorModel motor_;
  RandomStream random_;
  std::multiset<Mip50Fault> faults_;

  struct Incoming {
    Instant at;
    char byte;
  };
  std::deque<Incoming> incoming_;  // a terminal hands bytes over at once; a wire takes its time for each
  std::deque<Outgoing> outgoing_;
  Instant wire_free_{};
  bool ascii_ = true, echo_ = false;
  char last_key_ = 0;
  bool on_ = true;
  Instant back_on_ = kNever;
  bool regulated_ = false;
  bool homed_ = false, homing_ = false;
  bool busy_ = false;      // a motion whose end has not been told
  bool stuck_ = false;     // this motion will never tell
  Instant trip_ = kNever;  // when the follow error is noticed
  int error_ = 0;
  double speed_ = 100.0, acceleration_ = 0.2;
  double home_offset_ = 0.0;  // raw count of the home switch: where the count is to become 0
};

}  // namespace tiltmap
