#include "hardware/transport/replay_channel.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tiltmap {

ReplayChannel::ReplayChannel(WireSession session, Clock& clock, double speed, Gate gate)
    : session_(std::move(session)),
      clock_(clock),
      speed_(speed),
      gate_(std::move(gate)),
      name_("replay of " + session_.about),
      anchor_(clock.now()) {
  if (!(speed > 0.0) || !std::isfinite(speed))
    throw std::invalid_argument("ReplayChannel: the speed must be a positive number");
  if (!session_.records.empty()) anchor_then_ = session_.records.front().at;
  for (const WireRecord& record : session_.records)
    if (record.kind == WireRecord::Kind::Line) {
      line_ = record.line;
      break;
    }
  while (sent_ < session_.records.size() && session_.records[sent_].kind != WireRecord::Kind::Sent) ++sent_;
}

std::size_t ReplayChannel::nextReceived() const {
  std::size_t index = next_;
  // Changes of the line are the driver's own; what it must write first holds back what came after it.
  while (index < session_.records.size() && index < sent_ &&
         session_.records[index].kind != WireRecord::Kind::Received &&
         session_.records[index].kind != WireRecord::Kind::Lost)
    ++index;
  return index < sent_ ? index : session_.records.size();
}

Instant ReplayChannel::due(const WireRecord& record) const {
  return anchor_ + durationOf(secondsOf(record.at - anchor_then_) / speed_);
}

Result<std::size_t> ReplayChannel::read(std::span<Byte> buffer, Instant deadline) {
  for (;;) {
    if (state_ != ChannelState::Open)
      return fail(state_ == ChannelState::Lost ? lost_ : "the replay was closed", name_, "replay it again");
    if (taken_ < pending_.size()) {
      const std::size_t count = std::min(buffer.size(), pending_.size() - taken_);
      std::copy_n(pending_.begin() + static_cast<std::ptrdiff_t>(taken_), count, buffer.begin());
      taken_ += count;
      return count;
    }
    const std::size_t index = nextReceived();
    if (index == session_.records.size()) {
      if (deadline == kNever) throw std::logic_error("ReplayChannel: a read without end");
      clock_.sleepUntil(deadline);
      return 0;
    }
    const WireRecord& record = session_.records[index];
    const Instant when = due(record);
    if (when > clock_.now()) {
      clock_.sleepUntil(std::min(when, deadline));
      if (when > clock_.now()) return 0;
    }
    // A port lost at the very end of a wait was found lost by what came next.
    if (record.kind == WireRecord::Kind::Lost && when == deadline) return 0;
    next_ = index + 1;
    if (gate_) gate_(record);
    if (record.kind == WireRecord::Kind::Lost) {
      state_ = ChannelState::Lost;
      lost_ = record.text;
      continue;
    }
    pending_ = record.bytes;
    taken_ = 0;
  }
}

Status ReplayChannel::write(std::span<const Byte> bytes) {
  if (state_ != ChannelState::Open)
    return fail(state_ == ChannelState::Lost ? lost_ : "the replay was closed", name_, "replay it again");
  while (!bytes.empty()) {
    if (sent_ >= session_.records.size())
      return fail("the driver wrote " + hexText(bytes) + " where the recording has nothing more", name_,
                  "replay it with the settings that it was recorded with");
    const WireRecord& record = session_.records[sent_];
    const std::size_t count = std::min(bytes.size(), record.bytes.size() - sent_bytes_);
    if (!std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count),
                    record.bytes.begin() + static_cast<std::ptrdiff_t>(sent_bytes_)))
      return fail("the driver wrote " + hexText(bytes) + " where the recording has " + hexText(record.bytes),
                  name_, "replay it with the settings that it was recorded with");
    bytes = bytes.subspan(count);
    sent_bytes_ += count;
    if (sent_bytes_ < record.bytes.size()) return {};
    sent_bytes_ = 0;
    anchor_ = clock_.now();
    anchor_then_ = record.at;
    for (++sent_; sent_ < session_.records.size() && session_.records[sent_].kind != WireRecord::Kind::Sent;)
      ++sent_;
  }
  return {};
}

Status ReplayChannel::setLine(const LineSettings& line) {
  line_ = line;
  return {};
}

void ReplayChannel::close() {
  if (state_ == ChannelState::Open) state_ = ChannelState::Closed;
}

bool ReplayChannel::finished() const {
  return sent_ >= session_.records.size() && nextReceived() >= session_.records.size() &&
         taken_ >= pending_.size();
}

ReplayOpener::ReplayOpener(WireSession session, Clock& clock, double speed, ReplayChannel::Gate gate)
    : about_(session.about), clock_(clock), speed_(speed), gate_(std::move(gate)) {
  bool open = false;
  for (WireRecord& record : session.records) {
    const bool fails = record.kind == WireRecord::Kind::Lost && !open;
    if (record.kind == WireRecord::Kind::Opened || fails || parts_.empty()) parts_.emplace_back();
    open = !fails && record.kind != WireRecord::Kind::Lost;
    parts_.back().push_back(std::move(record));
  }
}

Result<std::unique_ptr<ByteChannel>> ReplayOpener::open() {
  if (next_ >= parts_.size())
    return fail("the recording ends here", "replay of " + about_, "replay a longer one");
  std::vector<WireRecord>& part = parts_[next_++];
  if (part.front().kind == WireRecord::Kind::Lost)
    return fail(part.front().text, "replay of " + about_, "so it was when this was recorded");
  return std::make_unique<ReplayChannel>(WireSession{about_, 0.0, std::move(part)}, clock_, speed_, gate_);
}

}  // namespace tiltmap
