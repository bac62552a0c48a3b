// One request after the other to an EPOS, without waiting: handshakes, time limits and repetitions.
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "hardware/tilt/epos_codec.h"
#include "hardware/transport/clock.h"

namespace tiltmap {

// A request that came to nothing is made again: reading changes nothing, and writing the same value twice is
// as good as once. Before that the line is left alone until the controller has forgotten what it was in the
// middle of.
class EposLink {
 public:
  // Both must outlive it.
  EposLink(ByteChannel& channel, Clock& clock) : channel_(channel), clock_(clock) {}

  void setProtocol(EposProtocol protocol);
  EposProtocol protocol() const { return protocol_; }
  // How often a request is made before it counts as unanswered, and how long an answer may take beyond the
  // wire's time.
  void setPatience(int tries, double answer_s);

  // Forgets what is under way.
  void reset();
  // One at a time: throws std::logic_error while another one is under way.
  void begin(const EposRequest& request);
  bool busy() const { return step_ != Step::Idle; }
  // What is due; the answer once it is there. Fails where the channel is lost or nobody answers ("" as what:
  // the caller knows better how to say it).
  Result<std::optional<EposAnswer>> poll();

  // When the last request that was answered had reached the controller.
  Instant sentAt() const { return sent_at_; }
  // Since the last call something was repeated, late or garbled: what was answered may be an older answer.
  bool takeIrregular() { return std::exchange(irregular_, false); }

 private:
  enum class Step {
    Idle,
    Quiet,   // the line is left alone
    Ready,   // V1: the code was sent, 'O' is waited for
    Taken,   // V1: the rest was sent, 'O' is waited for
    Coming,  // V1: the answer's code is waited for
    Body,    // V1: and the rest of it
    Answer,  // V2
  };
  Status start();
  Status send(std::span<const Byte> bytes, Step next, double limit_s);
  Status again();
  Result<std::optional<EposAnswer>> heard(Byte byte);
  std::optional<EposAnswer> understood(const EposFrame& frame) const;

  ByteChannel& channel_;
  Clock& clock_;
  EposProtocol protocol_ = EposProtocol::V1;
  int most_tries_ = 4;
  double answer_s_ = 0.3;
  Step step_ = Step::Idle;
  EposRequest request_;
  ByteVector frame_;
  int tries_ = 0;
  bool irregular_ = false;
  Instant deadline_{}, sent_at_{};
  Instant clear_{};  // nothing of earlier tries comes after it
  EposBodyReader body_;
  EposStreamReader stream_;
};

}  // namespace tiltmap
