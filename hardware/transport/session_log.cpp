#include "hardware/transport/session_log.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace tiltmap {

namespace {

constexpr auto kSyncEvery = std::chrono::milliseconds(200);

}  // namespace

Result<WireSession> readSession(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return fail("cannot read the recorded session", file.string(), "look at its name");
  std::ostringstream text;
  text << in.rdbuf();
  return parseSession(text.str(), file.string());
}

Result<std::unique_ptr<SessionLog>> SessionLog::create(const std::filesystem::path& file,
                                                       const std::string& about) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0)
    return fail(std::string("cannot make the session log: ") + std::strerror(errno), file.string(),
                "give a name that is not taken, in a folder that you may write");
  std::unique_ptr<SessionLog> log(new SessionLog(descriptor, file));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  log->append(sessionHead(about, std::chrono::duration<double>(now).count()));
  if (const auto failed = log->failed()) return fail(*failed);
  return log;
}

SessionLog::SessionLog(int descriptor, std::filesystem::path file)
    : descriptor_(descriptor), file_(std::move(file)) {
  sync_ = std::jthread([this](const std::stop_token& stop) {
    // Away from the thread that reads: a disk may take longer than the port's buffer lasts.
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kSyncEvery);
      {
        const std::lock_guard lock(mutex_);
        if (!unsynced_) continue;
        unsynced_ = false;
      }
      ::fdatasync(descriptor_);
    }
  });
}

SessionLog::~SessionLog() {
  sync_.request_stop();
  sync_.join();
  ::fdatasync(descriptor_);
  ::close(descriptor_);
}

void SessionLog::add(const WireRecord& record) {
  append(recordText(record));
}

Instant SessionLog::begun(Instant now) {
  const std::lock_guard lock(mutex_);
  if (!begun_) begun_ = now;
  return *begun_;
}

void SessionLog::add(WireRecord::Kind kind, const std::string& text, Instant now) {
  WireRecord record;
  record.kind = kind;
  record.at = now - begun(now);
  record.text = text;
  add(record);
}

void SessionLog::append(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (failed_) return;
  unsynced_ = true;
  if (::write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    failed_ = Error{std::string("the session is no longer recorded: ") + std::strerror(errno), file_.string(),
                    "free some space and begin a new session"};
}

std::optional<Error> SessionLog::failed() const {
  const std::lock_guard lock(mutex_);
  return failed_;
}

LoggedChannel::LoggedChannel(std::unique_ptr<ByteChannel> channel, std::shared_ptr<SessionLog> log,
                             const Clock& clock)
    : channel_(std::move(channel)), log_(std::move(log)), clock_(clock), begun_(log_->begun(clock.now())) {
  log_->add(WireRecord::Kind::Opened, channel_->name(), clock.now());
  WireRecord first = record(WireRecord::Kind::Line);
  first.line = channel_->line();
  log_->add(first);
}

WireRecord LoggedChannel::record(WireRecord::Kind kind, std::span<const Byte> bytes) const {
  return {kind, clock_.now() - begun_, ByteVector(bytes.begin(), bytes.end()), {}, {}};
}

void LoggedChannel::lost(const Error& error) {
  if (told_lost_ || channel_->state() != ChannelState::Lost) return;
  told_lost_ = true;
  WireRecord last = record(WireRecord::Kind::Lost);
  last.text = error.what;
  log_->add(last);
}

Result<std::size_t> LoggedChannel::read(std::span<Byte> buffer, Instant deadline) {
  const auto count = channel_->read(buffer, deadline);
  if (!count)
    lost(count.error());
  else if (*count > 0)
    log_->add(record(WireRecord::Kind::Received, buffer.first(*count)));
  return count;
}

Status LoggedChannel::write(std::span<const Byte> bytes) {
  // Before it is handed over, so that no answer stands above its question.
  log_->add(record(WireRecord::Kind::Sent, bytes));
  const auto written = channel_->write(bytes);
  if (!written) lost(written.error());
  return written;
}

Status LoggedChannel::setLine(const LineSettings& line) {
  const auto set = channel_->setLine(line);
  if (set) {
    WireRecord change = record(WireRecord::Kind::Line);
    change.line = line;
    log_->add(change);
  } else {
    lost(set.error());
  }
  return set;
}

}  // namespace tiltmap
