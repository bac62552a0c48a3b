// What went over a wire, both ways, with time stamps: a text file to look at, and to replay.
//
//   # tiltmap wire session 1
//   # lms2xx:/dev/ttyUSB0
//   # begun 1767225600.000000
//   0.000000000 @ /dev/ttyUSB0         a port was opened
//   0.000013200 = 9600 8N1             the line's settings from now on
//   0.000051000 > 02 00 01 00 31 15 12   handed to the port
//   0.083120441 < 06                   came from the instrument
//   2.100000000 ! the port is gone     the channel failed, or no port could be opened
//
// Seconds since the beginning. A line is written to the file in one piece before the call returns, so that it
// outlives the program; a thread brings it to the disk within a quarter of a second. A line cut off at the
// end of the file is left out when reading.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

struct WireRecord {
  enum class Kind { Opened, Line, Sent, Received, Lost };
  Kind kind = Kind::Received;
  Duration at{};  // since the session began
  ByteVector bytes;
  LineSettings line;  // of Line
  std::string text;   // of Opened, the port; of Lost, why
};

struct WireSession {
  std::string about;  // the URL it was recorded from
  double begun_unix_s = 0.0;
  std::vector<WireRecord> records;
};

// What a session begins with, and a line of it (session_text.cpp).
std::string sessionHead(const std::string& about, double begun_unix_s);
std::string recordText(const WireRecord& record);
// Fails with the number of the first line that is none; `where` names the file in it.
Result<WireSession> parseSession(std::string_view text, const std::string& where);
Result<WireSession> readSession(const std::filesystem::path& file);

// Writes one. Any thread.
class SessionLog {
 public:
  // Refuses to write over a file that is there.
  static Result<std::unique_ptr<SessionLog>> create(const std::filesystem::path& file,
                                                    const std::string& about);
  ~SessionLog();
  SessionLog(const SessionLog&) = delete;
  SessionLog& operator=(const SessionLog&) = delete;

  // A disk that is full stops the recording, not the session: failed() then says why.
  void add(const WireRecord& record);
  void add(WireRecord::Kind kind, const std::string& text, Instant now);
  // Of the first thing recorded, from which on all records count.
  Instant begun(Instant now);
  std::optional<Error> failed() const;

 private:
  SessionLog(int descriptor, std::filesystem::path file);
  void append(const std::string& text);
  const int descriptor_;
  const std::filesystem::path file_;
  mutable std::mutex mutex_;
  bool unsynced_ = false;
  std::optional<Error> failed_;
  std::optional<Instant> begun_;
  std::jthread sync_;
};

// Another channel, everything of it recorded. Several, one after the other, may share a log.
class LoggedChannel : public ByteChannel {
 public:
  LoggedChannel(std::unique_ptr<ByteChannel> channel, std::shared_ptr<SessionLog> log, const Clock& clock);

  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override;
  Status write(std::span<const Byte> bytes) override;
  Status setLine(const LineSettings& line) override;
  LineSettings line() const override { return channel_->line(); }
  ChannelState state() const override { return channel_->state(); }
  void close() override { channel_->close(); }
  const std::string& name() const override { return channel_->name(); }
  const SessionLog& log() const { return *log_; }

 private:
  WireRecord record(WireRecord::Kind kind, std::span<const Byte> bytes = {}) const;
  void lost(const Error& error);
  std::unique_ptr<ByteChannel> channel_;
  std::shared_ptr<SessionLog> log_;
  const Clock& clock_;
  const Instant begun_;
  bool told_lost_ = false;
};

}  // namespace tiltmap
