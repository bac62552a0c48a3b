// One request at a time over a channel: acknowledge, answer, limits, repeats.
#pragma once

#include <functional>
#include <stop_token>

#include "hardware/lms2xx/framer.h"
#include "hardware/lms2xx/requests.h"

namespace tiltmap::lms2xx {

// A telegram and when its bytes came.
struct Arrival {
  Telegram telegram;
  Instant first_byte{};
  Instant last_byte{};
};

class RequestEngine {
 public:
  // How long to wait, and how often to ask.
  struct Limits {
    Duration answer = std::chrono::seconds(1);
    int attempts = 3;
  };
  // Why nothing came of a request, to decide what to do next.
  enum class Outcome { Answered, Silent, Refused, Damaged, Restarted, ChannelFailed, Stopped };
  struct Reply {
    Outcome outcome = Outcome::Silent;
    Arrival arrival;   // of Answered
    Instant asked{};   // when the request had left, the first time
    int repeated = 0;  // how often it had to be asked again
    Error error;       // else, in words
    bool answered() const { return outcome == Outcome::Answered; }
  };
  struct Counts {
    std::size_t repeats = 0, negative = 0, missing_acknowledges = 0;
  };

  // The channel must outlive it.
  RequestEngine(ByteChannel& channel, Clock& clock) : channel_(channel), clock_(clock) {}

  // `begun` is called once, when the first bytes of the answer are there and look like `begun_size` bytes in
  // all; from then on the request is not repeated.
  Reply ask(const Request& request, const Limits& limits, const std::stop_token& stop,
            const std::function<void(Instant)>& begun = {}, std::size_t begun_size = 0);
  // The next telegram, whatever it is; nothing at the deadline.
  Result<std::optional<Arrival>> next(Instant deadline, const std::stop_token& stop);
  // Reads until nothing has come for so long; telegrams are thrown away, their number is returned.
  Result<int> drain(Duration silence, Duration at_most, const std::stop_token& stop);
  // Bytes without asking anything: true where a whole telegram is among them.
  Result<bool> listen(Duration length, const std::stop_token& stop);
  void forget();  // what was received so far

  ByteChannel& channel() { return channel_; }
  const Framer::Counts& noise() const { return framer_.counts(); }
  const Counts& counts() const { return counts_; }

 private:
  struct Heard {
    std::optional<Token> token;
    Instant first{}, last{};
    bool broken = false;  // what begun_ was told of will not be whole
  };
  // The next token; none at the deadline. A telegram that does not go on for `gap` was none.
  Result<Heard> hear(Instant deadline, Duration gap, const std::stop_token& stop);
  bool looksBegun(Byte command, std::size_t size) const;

  ByteChannel& channel_;
  Clock& clock_;
  Framer framer_;
  Counts counts_;
  Instant last_byte_{}, first_byte_{};
  bool first_known_ = false;
  bool told_ = false;
  std::size_t bad_then_ = 0;
  std::function<void(Instant)> begun_;
  Byte begun_command_ = 0;
  std::size_t begun_size_ = 0;
};

}  // namespace tiltmap::lms2xx
