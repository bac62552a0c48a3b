#include "hardware/transport/session_log.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <optional>
#include <sstream>
#include <unistd.h>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr std::string_view kFirstLine = "# tiltmap wire session 1";
constexpr std::string_view kBegun = "# begun ";
constexpr auto kSyncEvery = std::chrono::milliseconds(200);

std::string lineText(const LineSettings& line) {
  const char* format = line.parity == Parity::Even ? "8E1" : line.parity == Parity::Odd ? "8O1" : "8N1";
  return std::to_string(line.baud) + " " + format;
}

std::optional<LineSettings> parseLine(std::string_view text) {
  const auto words = splitWords(text);
  if (words.size() != 2) return std::nullopt;
  const auto baud = parseInteger(words[0]);
  if (!baud || *baud <= 0 || *baud > 10'000'000) return std::nullopt;
  LineSettings line{static_cast<int>(*baud)};
  if (words[1] == "8E1")
    line.parity = Parity::Even;
  else if (words[1] == "8O1")
    line.parity = Parity::Odd;
  else if (words[1] != "8N1")
    return std::nullopt;
  return line;
}

std::optional<WireRecord> parseRecord(std::string_view text) {
  const auto blank = text.find(' ');
  if (blank == std::string_view::npos || blank + 1 >= text.size()) return std::nullopt;
  const auto seconds = parseReal(text.substr(0, blank));
  if (!seconds || !(*seconds >= 0.0) || !(*seconds < 1e9)) return std::nullopt;
  WireRecord record;
  record.at = durationOf(*seconds);
  const char kind = text[blank + 1];
  const std::string_view rest = trimmed(text.substr(blank + 2));
  if (kind == '!' || kind == '@') {
    record.kind = kind == '!' ? WireRecord::Kind::Lost : WireRecord::Kind::Opened;
    record.text = std::string(rest);
    return record;
  }
  if (kind == '=') {
    const auto line = parseLine(rest);
    if (!line) return std::nullopt;
    record.kind = WireRecord::Kind::Line;
    record.line = *line;
    return record;
  }
  if (kind != '>' && kind != '<') return std::nullopt;
  auto bytes = parseHex(rest);
  if (!bytes || bytes->empty()) return std::nullopt;
  record.kind = kind == '>' ? WireRecord::Kind::Sent : WireRecord::Kind::Received;
  record.bytes = std::move(*bytes);
  return record;
}

// Texts stay on their line.
std::string onOneLine(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

}  // namespace

std::string recordText(const WireRecord& record) {
  const std::string text = fixedReal(secondsOf(record.at), 9);
  switch (record.kind) {
    case WireRecord::Kind::Opened:
      return text + " @ " + onOneLine(record.text) + "\n";
    case WireRecord::Kind::Line:
      return text + " = " + lineText(record.line) + "\n";
    case WireRecord::Kind::Sent:
      return text + " > " + hexText(record.bytes) + "\n";
    case WireRecord::Kind::Received:
      return text + " < " + hexText(record.bytes) + "\n";
    case WireRecord::Kind::Lost:
      break;
  }
  return text + " ! " + onOneLine(record.text) + "\n";
}

Result<WireSession> parseSession(std::string_view text, const std::string& where) {
  WireSession session;
  Duration last{};
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) break;  // cut off when the program or the machine ended
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::string place = where + ", line " + std::to_string(number);
    if (number == 1) {
      if (trimmed(line) != kFirstLine)
        return fail("this is no recorded session", place, "give a file that was made with ?log=");
    } else if (line.starts_with(kBegun)) {
      session.begun_unix_s = parseReal(trimmed(line.substr(kBegun.size()))).value_or(0.0);
    } else if (line.starts_with('#')) {
      if (number == 2) session.about = std::string(trimmed(line.substr(1)));
    } else {
      auto record = parseRecord(trimmed(line));
      if (!record || record->at < last)
        return fail("this is no record of a session: " + printable(line), place,
                    "a record is `SECONDS > BYTES`, with >, <, =, @ or !, in order of time");
      last = record->at;
      session.records.push_back(std::move(*record));
    }
  }
  return session;
}

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
  log->append(std::string(kFirstLine) + "\n# " + onOneLine(about) + "\n" + std::string(kBegun) +
              fixedReal(std::chrono::duration<double>(now).count(), 6) + "\n");
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
