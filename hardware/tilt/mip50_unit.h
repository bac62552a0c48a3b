// The maxon MIP 50 in its ASCII mode, as a tilt unit.
//
// Written after what is public about the controller; no controller was at hand. Every string and time limit
// comes from a Mip50Table. Requests go one at a time, each waits for its answer, and a move counts as ended
// only when the position that is read back says so: the line has no checksum.
#pragma once

#include <deque>
#include <memory>

#include "hardware/tilt/mip50_codec.h"
#include "hardware/tilt/tilt_unit.h"
#include "hardware/transport/byte_channel.h"

namespace tiltmap {

class Mip50Unit : public TiltUnit {
 public:
  // The clock must outlive the unit. Throws std::invalid_argument for a drive that check() refuses.
  Mip50Unit(std::unique_ptr<ByteChannel> channel, Clock& clock, TiltDrive drive, Mip50Table table = {},
            int axis = 1);
  ~Mip50Unit() override;

  const std::string& name() const override { return name_; }
  // Finds the controller in its ASCII mode (entering it from the text menu where it must), clears errors,
  // sets ramp and speed, switches regulation on and searches home.
  Status prepare(const JobControl& job) override;
  Status checkAngle(double angle_rad) const override;
  Status moveTo(double angle_rad) override;
  Result<std::optional<TiltReading>> poll() override;
  void stop() override;
  // In one piece, whatever TiltDrive::longest_segment_s says: stop() then needs the table's `interrupt`, and
  // the controller has to be prepared again. The position cannot be asked for while it moves: that the move
  // took as long as it should have, and ended where it should, makes its angles certain.
  SteadySpeed steadySpeed(double wished_rad_s) const override;
  Status moveSteadily(double angle_rad, double rate_rad_s) override;
  double steadyDelay() const override;
  std::optional<SteadyMotion> steadyMotion() const override { return steady_known_ ? steady_ : std::nullopt; }
  Status release() override;
  Status findWhereItStands() override;
  std::vector<std::string> takeWarnings() override;
  std::vector<InstrumentFact> facts() const override;

  // Is there a controller? Brings it into its ASCII mode; nothing moves.
  Status identify(const JobControl& job);

  // For diagnosis; not while it moves. Blocks for at most a few seconds.
  Result<std::int64_t> readParameter(int number);

 private:
  // One request and what it is waiting for.
  struct Request {
    Mip50Command command;
    double limit_s = 1.0;   // until it is answered
    int value_number = -1;  // M#number must come before the acknowledge; -1: none
  };
  enum class Phase { Idle, Moving, Gliding, Reading, Checking, Still, Lost };

  Status send();
  Status take();
  Result<bool> advance();
  Result<bool> answered(const Mip50Answer& answer);
  Status refused(const Mip50Refusal& refusal);
  Status overdue();
  void next();
  Status runScript(const JobControl* job);
  Status findAsciiMode(const JobControl& job);
  Result<bool> probe(const JobControl& job, std::string_view bytes, bool banner);
  Status home(const JobControl& job);
  Result<bool> arrived();
  void settleSteady();
  void noteSent(const std::string& text);
  Status plan();
  Status lost(Error error);
  Request moveRequest(std::int64_t from, std::int64_t to) const;
  Request request(Mip50Verb verb, double value = 0.0) const;
  Request positionRequest() const;
  std::string troubleOf(int number, const std::map<int, std::string>& texts) const;
  Error silent() const;

  std::unique_ptr<ByteChannel> channel_;
  Clock& clock_;
  TiltDrive drive_;
  Mip50Table table_;
  int axis_;
  std::string name_;
  std::vector<std::string> warnings_;

  Mip50AnswerReader reader_;
  std::deque<Mip50Answer> answers_;
  std::deque<Request> script_;
  bool sent_ = false;
  bool mode_known_ = false;  // line ends may be sent: in the text menu one would stop the motor
  int tries_ = 0;
  Instant deadline_{}, quiet_until_{};
  std::optional<std::int64_t> value_;  // of the request under way
  std::int64_t last_value_ = 0;        // of the one that was completed last
  Instant move_deadline_{};

  Phase phase_ = Phase::Idle;
  bool ready_ = false;
  std::int64_t position_ = 0;  // read back last
  std::int64_t target_ = 0;
  int attempts_ = 0;
  bool only_reading_ = false;  // where it stands is wanted, not a move
  bool irregular_ = false;     // an answer was late, lost or garbled: look twice
  Instant ended_{};            // when the last segment was acknowledged
  TiltReading reading_;
  std::optional<SteadyMotion> steady_;  // under way, or the last one
  bool steady_known_ = false;           // it is over, and was as it should have been
};

}  // namespace tiltmap
