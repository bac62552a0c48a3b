#include "hardware/lms2xx/request_engine.h"

#include <algorithm>

namespace tiltmap::lms2xx {

namespace {

using namespace std::chrono_literals;

// The listing says 60 ms; a USB adapter adds up to 16 each way.
constexpr Duration kAcknowledgeLimit = 250ms;
constexpr Duration kAfterRefusal = 30ms;
// The listing allows 14 ms between bytes; behind USB bytes come in heaps.
constexpr Duration kByteGap = 60ms;
// In a stream nobody waits for one telegram, and what follows tells soon enough that one was cut.
constexpr Duration kStreamGap = 900ms;
// So that a stop takes effect.
constexpr Duration kSlice = 50ms;

std::string nameOf(const Request& request) {
  ByteVector bytes{request.command};
  if (request.command == command::kMode && !request.data.empty()) bytes.push_back(request.data[0]);
  return "request " + hexText(bytes);
}

}  // namespace

void RequestEngine::forget() {
  framer_.clear();
  first_known_ = false;
}

bool RequestEngine::looksBegun(Byte command, std::size_t size) const {
  const auto start = framer_.start();
  return start.size() >= 5 && start[4] == command && word(start, 2) + kOverhead == size;
}

Result<RequestEngine::Heard> RequestEngine::hear(Instant deadline, Duration gap,
                                                 const std::stop_token& stop) {
  std::array<Byte, 1024> buffer;
  for (;;) {
    if (auto token = framer_.next()) {
      Heard heard{std::move(token), first_byte_, last_byte_};
      if (const auto* telegram = std::get_if<Telegram>(&*heard.token)) {
        // Bytes that came in one heap began before it.
        const Instant by_rate = last_byte_ - channel_.line().wireTime(telegram->wireSize() - 1);
        heard.first = first_known_ ? std::min(first_byte_, by_rate) : by_rate;
      }
      first_known_ = false;
      return heard;
    }
    const Instant now = clock_.now();
    if (told_ && (framer_.counts().bad_checksum != bad_then_ || !framer_.waiting()))
      return Heard{std::nullopt, {}, {}, true};
    if (framer_.waiting()) {
      if (!first_known_) {
        first_known_ = true;
        first_byte_ = last_byte_;
      }
      if (begun_ && looksBegun(begun_command_, begun_size_)) {
        const auto tell = std::move(begun_);
        begun_ = nullptr;
        told_ = true;
        bad_then_ = framer_.counts().bad_checksum;
        tell(now);
      }
    } else {
      first_known_ = false;
    }
    if (stop.stop_requested()) return Heard{};
    Instant wake = std::min(deadline, now + kSlice);
    if (framer_.waiting()) wake = std::min(wake, last_byte_ + gap);
    const auto count = channel_.read(buffer, wake);
    if (!count) return fail(count.error());
    if (*count > 0) {
      last_byte_ = clock_.now();
      framer_.push(std::span(buffer).first(*count));
      continue;
    }
    // Only what is not there even now is late: on a busy machine it is we who come late.
    if (framer_.waiting() && clock_.now() - last_byte_ >= gap) {
      if (told_) return Heard{std::nullopt, {}, {}, true};
      framer_.giveUpFirst();
      first_known_ = false;
    } else if (clock_.now() >= deadline) {
      return Heard{};
    }
  }
}

RequestEngine::Reply RequestEngine::ask(const Request& request, const Limits& limits,
                                        const std::stop_token& stop,
                                        const std::function<void(Instant)>& begun, std::size_t begun_size) {
  Reply reply;
  const auto end = [&](Outcome outcome, Error error) {
    begun_ = nullptr;
    told_ = false;
    reply.outcome = outcome;
    reply.error = std::move(error);
    return reply;
  };
  const std::string& port = channel_.name();
  const Error damaged{"a scan arrived damaged", port,
                      "it is measured again; look at the cable if that happens often"};
  bool acknowledged_once = false;
  for (int attempt = 0; attempt < limits.attempts; ++attempt) {
    if (attempt > 0) ++counts_.repeats;
    reply.repeated = attempt;
    forget();
    if (const auto cleared = channel_.discardInput(); !cleared)
      return end(Outcome::ChannelFailed, cleared.error());
    const ByteVector bytes = request.encoded();
    begun_ = begun;
    told_ = false;
    begun_command_ = request.answer();
    begun_size_ = begun_size;
    const Instant written = clock_.now();
    if (const auto sent = channel_.write(bytes); !sent) return end(Outcome::ChannelFailed, sent.error());
    // A port that waits until the bytes have left returns later than one that does not.
    // Of several askings the first counts, in case a late answer to it is heard.
    const Instant heard_there = written + channel_.line().wireTime(bytes.size());
    if (attempt == 0) reply.asked = heard_there;
    bool acknowledged = false, refused = false;
    Instant deadline = std::max(clock_.now(), heard_there) + kAcknowledgeLimit;
    // What must not be asked twice gets all the time there is, in case only the acknowledge was lost.
    if (limits.attempts == 1) deadline += limits.answer;
    while (!refused) {
      auto heard = hear(deadline, kByteGap, stop);
      if (!heard) return end(Outcome::ChannelFailed, heard.error());
      if (stop.stop_requested()) return end(Outcome::Stopped, {"stopped", port, "begin again"});
      if (heard->broken) return end(Outcome::Damaged, damaged);
      if (!heard->token) break;
      if (std::holds_alternative<Ack>(*heard->token)) {
        if (!acknowledged) deadline = clock_.now() + limits.answer;
        acknowledged = acknowledged_once = true;
      } else if (std::holds_alternative<Nak>(*heard->token)) {
        if (acknowledged) continue;  // a stray byte of something else
        ++counts_.negative;
        refused = true;
        clock_.sleepFor(kAfterRefusal);
      } else {
        auto& telegram = std::get<Telegram>(*heard->token);
        const Byte name = telegram.command();
        if (name == request.answer()) {
          if (!acknowledged) ++counts_.missing_acknowledges;
          reply.arrival = {std::move(telegram), heard->first, heard->last};
          return end(Outcome::Answered, {});
        }
        if (name == command::kRefused)
          return end(Outcome::Refused, {"the scanner refuses " + nameOf(request), port,
                                        "its type or firmware may not know it, or it is in another mode"});
        if (name == command::kPowerOn)
          return end(Outcome::Restarted, {"the scanner was switched on just now: its power was interrupted",
                                          port, "look at its supply; it is set up again by connecting anew"});
      }
    }
    // Once the answer has begun, it is this one or none.
    if (told_) return end(Outcome::Damaged, damaged);
  }
  return end(Outcome::Silent,
             {acknowledged_once ? "the scanner heard " + nameOf(request) + " but did not answer in time"
                                : "the scanner does not answer " + nameOf(request),
              port, "look at its power and its cable; connecting anew searches for it at every rate"});
}

Result<std::optional<Arrival>> RequestEngine::next(Instant deadline, const std::stop_token& stop) {
  for (;;) {
    auto heard = hear(deadline, kStreamGap, stop);
    if (!heard) return fail(heard.error());
    if (!heard->token) return std::nullopt;
    if (auto* telegram = std::get_if<Telegram>(&*heard->token))
      return Arrival{std::move(*telegram), heard->first, heard->last};
  }
}

Result<int> RequestEngine::drain(Duration silence, Duration at_most, const std::stop_token& stop) {
  const Instant end = clock_.now() + at_most;
  Instant quiet_since = clock_.now();
  std::array<Byte, 1024> buffer;
  int reads = 0;
  while (!stop.stop_requested()) {
    const Instant wake = std::min(end, quiet_since + silence);
    const auto count = channel_.read(buffer, wake);
    if (!count) return fail(count.error());
    if (*count == 0 && clock_.now() >= wake) break;
    if (*count > 0) {
      quiet_since = clock_.now();
      ++reads;
    }
    if (clock_.now() >= end) break;
  }
  forget();
  return reads;
}

Result<bool> RequestEngine::listen(Duration length, const std::stop_token& stop) {
  forget();
  const auto heard = next(clock_.now() + length, stop);
  if (!heard) return fail(heard.error());
  return heard->has_value();
}

}  // namespace tiltmap::lms2xx
