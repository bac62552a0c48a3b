// A recorded session as a channel: the driver that recorded it, or a newer one, runs against it.
#pragma once

#include <functional>
#include <memory>

#include "hardware/transport/session_log.h"

namespace tiltmap {

// What was received becomes readable as long after the last thing written before it as it did then, divided
// by `speed`. On a virtual clock that takes no time at all, and no deadline passes that did not pass then.
//
// What the driver writes must be what was written then: else the write fails with both, in hexadecimal.
class ReplayChannel : public ByteChannel {
 public:
  // Called with each received record before the driver gets it; for stepping through a session it returns
  // when the operator has asked for the next one (on a virtual clock: nothing times out meanwhile).
  using Gate = std::function<void(const WireRecord&)>;

  ReplayChannel(WireSession session, Clock& clock, double speed = 1.0, Gate gate = {});

  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override { return line_; }
  ChannelState state() const override { return state_; }
  void close() override;
  const std::string& name() const override { return name_; }

  // Everything was received, and everything written that was written then.
  bool finished() const;

 private:
  // Index of the next record to be received, or size() where a write must come first or nothing is left.
  std::size_t nextReceived() const;
  Instant due(const WireRecord& record) const;

  WireSession session_;
  Clock& clock_;
  double speed_;
  Gate gate_;
  std::string name_;
  LineSettings line_;
  ChannelState state_ = ChannelState::Open;
  std::string lost_;
  std::size_t next_ = 0;        // first record that is not received or skipped
  std::size_t sent_ = 0;        // records before this one are written
  std::size_t sent_bytes_ = 0;  // of the record at sent_
  Instant anchor_;              // when the last record was written now ...
  Duration anchor_then_{};      // ... and then
  ByteVector pending_;
  std::size_t taken_ = 0;
};

// A session in which ports were opened several times: each opening gives what came until the next one, or
// fails as it did then.
class ReplayOpener {
 public:
  ReplayOpener(WireSession session, Clock& clock, double speed = 1.0, ReplayChannel::Gate gate = {});
  Result<std::unique_ptr<ByteChannel>> open();

 private:
  std::string about_;
  std::vector<std::vector<WireRecord>> parts_;
  std::size_t next_ = 0;
  Clock& clock_;
  double speed_;
  ReplayChannel::Gate gate_;
};

}  // namespace tiltmap
