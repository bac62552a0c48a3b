#include "hardware/lms2xx/framer.h"

namespace tiltmap::lms2xx {

void Framer::push(std::span<const Byte> bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void Framer::drop(std::size_t count) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
}

std::optional<Token> Framer::next() {
  std::size_t at = 0;  // everything before it is done with
  const auto done = [&](std::optional<Token> token) {
    drop(at);
    return token;
  };
  for (; at < buffer_.size(); ++at) {
    const std::size_t left = buffer_.size() - at;
    const Byte first = buffer_[at];
    if (sender_ == Sender::Scanner && (first == kAck || first == kNak)) {
      ++at;
      return done(first == kAck ? Token(Ack{}) : Token(Nak{}));
    }
    if (first != kStx || (left >= 2 && !addressFits(buffer_[at + 1]))) {
      ++counts_.noise;
      continue;
    }
    if (left < 4) return done(std::nullopt);
    const std::size_t length = word(buffer_, at + 2);
    if (length == 0 || length > kLongestPayload) {
      ++counts_.noise;
      continue;
    }
    if (left < length + kOverhead) return done(std::nullopt);
    const std::span<const Byte> whole(buffer_.data() + at, length + kOverhead);
    if (crc(whole.first(length + 4)) != word(whole, length + 4)) {
      ++counts_.bad_checksum;
      ++counts_.noise;
      continue;
    }
    Telegram telegram{whole[1], ByteVector(whole.begin() + 4, whole.end() - 2)};
    ++counts_.telegrams;
    at += whole.size();
    return done(std::move(telegram));
  }
  return done(std::nullopt);
}

bool Framer::giveUpFirst() {
  if (buffer_.empty()) return false;
  ++counts_.cut;
  ++counts_.noise;
  drop(1);
  return true;
}

std::optional<Byte> Framer::begunCommand() const {
  if (buffer_.size() < 5) return std::nullopt;
  return buffer_[4];
}

void Framer::clear() {
  buffer_.clear();
}

}  // namespace tiltmap::lms2xx
