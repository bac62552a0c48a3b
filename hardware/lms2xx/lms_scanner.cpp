#include "hardware/lms2xx/lms_scanner.h"

#include <algorithm>
#include <cmath>

namespace tiltmap {

using namespace lms2xx;
using namespace std::chrono_literals;

namespace {

constexpr double kTurn = 0.01332;  // of the mirror, seconds
constexpr Duration kModeLimit = 3500ms;
constexpr Duration kScanLimit = 1s;
// A stream that pauses for so many of its periods has ended.
constexpr int kSilentPeriods = 4;

Byte expected(LmsStream kind) {
  return kind == LmsStream::Reflectivity ? 0xC4 : 0xB0;
}

}  // namespace

LmsScanner::LmsScanner(Opener opener, Clock& clock, LmsSettings settings)
    : opener_(std::move(opener)), clock_(clock), settings_(std::move(settings)) {}

LmsScanner::~LmsScanner() {
  disconnect();
}

tl::unexpected<Error> LmsScanner::lost(Error error) {
  state_ = LmsState::Lost;
  return fail(std::move(error));
}

tl::unexpected<Error> LmsScanner::failed(const Engine::Reply& reply) {
  switch (reply.outcome) {
    case Engine::Outcome::Silent:
    case Engine::Outcome::Restarted:
    case Engine::Outcome::ChannelFailed:
      return lost(reply.error);
    default:
      return fail(reply.error);
  }
}

Result<Arrival> LmsScanner::ask(const Request& request, const Engine::Limits& limits,
                                const std::stop_token& stop) {
  auto reply = engine_->ask(request, limits, stop);
  if (!reply.answered()) return failed(reply);
  return std::move(reply.arrival);
}

Status LmsScanner::mode(const Request& request, const std::string& what, const std::stop_token& stop) {
  const auto reply = ask(request, {kModeLimit, 3}, stop);
  if (!reply) return fail(reply.error());
  const auto data = reply->telegram.data();
  if (!data.empty() && data[0] == 0) return {};
  const bool password = !data.empty() && data[0] == 1;
  return fail("the scanner refuses " + what + (password ? ": the password is wrong" : ""), channel_->name(),
              password ? "give the password that was set in it" : "switch it off and on again");
}

Status LmsScanner::monitoring(const std::stop_token& stop) {
  const auto done = mode(request::onRequest(), "to measure on request", stop);
  if (done && state_ == LmsState::Streaming) state_ = LmsState::Ready;
  return done;
}

// Before anything is asked: connected, and not streaming.
Status LmsScanner::ready(const std::stop_token& stop) {
  if (!engine_ || state_ == LmsState::Disconnected || state_ == LmsState::Lost)
    return fail("the scanner is not connected", channel_ ? channel_->name() : "", "connect it first");
  return state_ == LmsState::Streaming ? stopStream(stop) : Status{};
}

Result<UnitStatus> LmsScanner::status(const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return fail(quiet.error());
  const auto reply = ask(request::status(), {}, stop);
  if (!reply) return fail(reply.error());
  auto status = parseStatus(reply->telegram);
  if (status) {
    report_.status = *status;
    for (std::string& warning : warningsOf({reply->telegram.status()}))
      if (std::ranges::find(report_.warnings, warning) == report_.warnings.end())
        report_.warnings.push_back(std::move(warning));
  }
  return status;
}

Result<std::vector<StoredError>> LmsScanner::storedErrors(const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return fail(quiet.error());
  const auto reply = ask(request::errors(), {}, stop);
  if (!reply) return fail(reply.error());
  return parseErrors(reply->telegram);
}

Result<Configuration> LmsScanner::readConfiguration(const std::stop_token& stop) {
  const auto reply = ask(request::readConfiguration(), {}, stop);
  if (!reply) return fail(reply.error());
  return parseConfiguration(reply->telegram);
}

std::size_t LmsScanner::scanSize(LmsStream kind) const {
  const bool indices = report_.configuration.plausible() && report_.configuration.sendsIndices();
  if (kind == LmsStream::Partials) return scanWireSize(181, indices);
  const int values = variant().values();
  return scanWireSize(values, indices) +
         (kind == LmsStream::Reflectivity ? 6 + static_cast<std::size_t>(values) : 0);
}

double LmsScanner::streamPeriod(LmsStream kind) const {
  const double scan = kTurn * (kind == LmsStream::Partials ? 1 : variant().turns());
  const double wire = static_cast<double>(scanSize(kind)) * 10.0 / report_.baud;
  return scan * std::ceil(wire / scan);
}

Result<LmsLine> LmsScanner::lineOf(const Arrival& arrival, int turns) {
  auto measurement = parseMeasurement(arrival.telegram);
  if (!measurement) return fail(measurement.error());
  LmsLine line;
  line.raw = std::move(*measurement);
  line.variant = line.raw.partial ? Variant{180, 100} : variant();
  if (report_.configuration.plausible()) line.measuring_mode = report_.configuration.measuringMode();
  line.status.raw = line.raw.status;
  line.first_byte = arrival.first_byte;
  line.last_byte = arrival.last_byte;
  line.unix_time_s = clock_.unixTime(arrival.last_byte);
  line.earliest_start = arrival.first_byte - durationOf(kTurn * turns + settings_.latency_s);
  if (const auto filled = fillCells(line); !filled) return fail(filled.error());
  ++past_.lines;
  return line;
}

Result<LmsLine> LmsScanner::polled(const Request& request, int turns, std::size_t size,
                                   const std::stop_token& stop,
                                   const std::function<void(Instant)>& measured) {
  if (const auto quiet = ready(stop); !quiet) return fail(quiet.error());
  const Duration wire = channel_->line().wireTime(size);
  // Silence is not repeated behind the caller's back for long: three requests, then it is known to be gone.
  for (int attempt = 0;; ++attempt) {
    const auto reply = engine_->ask(request, {kScanLimit + wire, 3}, stop, measured, size);
    if (reply.answered()) {
      auto line = lineOf(reply.arrival, turns);
      if (!line) return line;
      const std::size_t values = line->raw.partial ? (line->raw.partial == 0 ? 181U : 180U)
                                                   : static_cast<std::size_t>(variant().values());
      if (line->raw.values.size() != values)
        return fail("the scanner sent " + std::to_string(line->raw.values.size()) + " values instead of " +
                        std::to_string(values),
                    channel_->name(), "another program may have set it differently: connect anew");
      // The scan was complete after the request was heard, and takes so many turns.
      line->earliest_start = reply.asked - durationOf(kTurn * turns * settings_.polled_scans_old);
      return line;
    }
    if (reply.outcome == Engine::Outcome::Damaged) {
      ++past_.damaged;
      // Where nothing depends on when it is measured, it is simply asked for again.
      if (!measured && attempt < 2) continue;
    }
    return failed(reply);
  }
}

Result<LmsLine> LmsScanner::scan(const std::stop_token& stop, const std::function<void(Instant)>& measured) {
  // Types with reflectivity give it for a range of beams only: all of them.
  if (report_.type.sendsReflectivity())
    return polled(request::reflectivity(1, variant().values()), variant().turns(),
                  scanSize(LmsStream::Reflectivity), stop, measured);
  return polled(request::scan(), variant().turns(), scanSize(LmsStream::Scans), stop, measured);
}

Result<LmsLine> LmsScanner::partialScan(const std::stop_token& stop) {
  return polled(request::partialScan(), 1, scanSize(LmsStream::Partials), stop, {});
}

Status LmsScanner::startStream(LmsStream kind, const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return quiet;
  const Request request = kind == LmsStream::Partials ? request::streamPartial()
                          : kind == LmsStream::Reflectivity
                              ? request::streamReflectivity(1, variant().values())
                              : request::stream();
  if (const auto begun = mode(request, "to stream", stop); !begun) return begun;
  state_ = LmsState::Streaming;
  stream_ = kind;
  last_line_.reset();
  last_index_.reset();
  return {};
}

Result<LmsLine> LmsScanner::next(const std::stop_token& stop) {
  if (state_ != LmsState::Streaming)
    return fail("no stream is running", channel_ ? channel_->name() : "", "start one first");
  const double period = streamPeriod(stream_);
  const Instant limit = clock_.now() + 1s + durationOf(kSilentPeriods * period);
  for (;;) {
    auto arrival = engine_->next(limit, stop);
    if (!arrival) return lost(arrival.error());
    if (stop.stop_requested()) return fail("stopped", channel_->name(), "begin again");
    if (!*arrival)
      return lost({"the scanner has gone silent in the middle of a stream", channel_->name(),
                   "look at its power and its cable; connecting anew searches for it at every rate"});
    const Byte name = (*arrival)->telegram.command();
    if (name == command::kPowerOn)
      return lost({"the scanner was switched on just now: its power was interrupted", channel_->name(),
                   "look at its supply; it is set up again by connecting anew"});
    if (name != expected(stream_)) continue;  // a late answer of an earlier request
    auto line = lineOf(**arrival, stream_ == LmsStream::Partials ? 1 : variant().turns());
    if (!line) continue;  // whole by its checksum and yet no scan: not one of ours
    if (line->raw.indices && last_index_)
      line->lost_before = static_cast<Byte>(line->raw.indices->telegram - *last_index_ - 1);
    else if (last_line_)
      line->lost_before =
          std::max(0, static_cast<int>(std::lround(secondsOf(line->last_byte - *last_line_) / period)) - 1);
    if (line->raw.indices) last_index_ = line->raw.indices->telegram;
    last_line_ = line->last_byte;
    past_.lost_lines += static_cast<std::size_t>(line->lost_before);
    return line;
  }
}

Status LmsScanner::stopStream(const std::stop_token& stop) {
  if (state_ != LmsState::Streaming) return {};
  return monitoring(stop);
}

LmsScanner::Statistics LmsScanner::statistics() const {
  Statistics all = past_;
  if (engine_) {
    all.repeats += engine_->counts().repeats;
    all.noise_bytes += engine_->noise().noise;
    all.damaged += engine_->noise().bad_checksum;
  }
  return all;
}

}  // namespace tiltmap
