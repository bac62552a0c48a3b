// Finds telegrams in a stream of bytes that may hold anything.
#pragma once

#include <optional>
#include <variant>

#include "hardware/lms2xx/telegram.h"

namespace tiltmap::lms2xx {

// Single bytes between telegrams.
struct Ack {
  bool operator==(const Ack&) const = default;
};
struct Nak {
  bool operator==(const Nak&) const = default;
};
using Token = std::variant<Telegram, Ack, Nak>;

// Who is listened to: telegrams of the scanner have bit 7 of the address set, a host's have not.
enum class Sender { Scanner, Host };

// Frames by length and checksum. A candidate whose checksum is wrong gives up its first byte only, so that a
// telegram inside of what looked like one is still found: nothing valid is ever skipped.
class Framer {
 public:
  explicit Framer(Sender sender = Sender::Scanner) : sender_(sender) {}

  void push(std::span<const Byte> bytes);
  // The next token of what was pushed; nothing: more bytes are needed.
  std::optional<Token> next();
  // The bytes stopped coming in the middle of a telegram: what is there is searched for others behind its
  // first byte. False where nothing was waiting.
  bool giveUpFirst();
  // A telegram seems to have begun: its start is here, its end is not.
  bool waiting() const { return !buffer_.empty(); }
  // The bytes of the telegram that seems to have begun.
  std::span<const Byte> start() const { return buffer_; }
  // Command of the telegram that seems to have begun, once that byte is there.
  std::optional<Byte> begunCommand() const;
  void clear();

  struct Counts {
    std::size_t telegrams = 0;
    std::size_t noise = 0;         // bytes that belong to nothing
    std::size_t bad_checksum = 0;  // candidates given up for it
    std::size_t cut = 0;           // candidates given up because no more came
  };
  const Counts& counts() const { return counts_; }
  // At most one candidate and what was pushed since next() was last asked to the end.
  std::size_t buffered() const { return buffer_.size(); }

 private:
  void drop(std::size_t count);
  bool addressFits(Byte address) const {
    return ((address & kFromScanner) != 0) == (sender_ == Sender::Scanner);
  }
  Sender sender_;
  ByteVector buffer_;
  Counts counts_;
};

}  // namespace tiltmap::lms2xx
