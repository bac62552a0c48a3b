#include "hardware/scip/scip_scanner_unit.h"

#include <array>
#include <utility>

#include "core/base/text.h"

namespace tiltmap {

using namespace scip;

namespace {

constexpr double kAnswerS = 1.0;
constexpr double kProbeS = 0.4;
constexpr int kTries = 3;
constexpr int kNetworkBaud = 1'000'000;  // a channel that is faster has no rate to be looked for
constexpr double kUnit = 0.001;
// From a scan's last beam until it is sent: not told anywhere, taken to be a turn at most.
constexpr double kTurnsBefore = 2.0;
constexpr int kClockReadings = 6;
constexpr double kClockOffS = 0.008;  // its clock must be known as well as this
// So long after it was read the clocks have not drifted apart; by then the shortest way of a scan is known.
constexpr double kClockHoldsS = 2.0;
constexpr double kRhythmS = 1.5;
constexpr std::size_t kRhythm = 4;  // scans that are looked at for it

}  // namespace

ScipScannerUnit::ScipScannerUnit(Opener opener, Clock& clock, ScipSettings settings)
    : opener_(std::move(opener)), clock_(clock), settings_(std::move(settings)) {}
ScipScannerUnit::~ScipScannerUnit() = default;

Status ScipScannerUnit::lost(Error error) {
  streaming_ = false;
  channel_.reset();
  return fail(std::move(error));
}

Status ScipScannerUnit::receive() {
  std::array<Byte, 4096> buffer;
  while (true) {
    const auto count = channel_->read(buffer, clock_.now());
    if (!count) return lost(count.error());
    if (*count == 0) return {};
    arrival_ = clock_.now();
    reader_.push({reinterpret_cast<const char*>(buffer.data()), *count}, items_);
  }
}

// Scans of a stream that is being stopped are passed over.
Result<std::optional<Reply>> ScipScannerUnit::ask(const std::string& command, const JobControl& job,
                                                  double limit_s) {
  const std::string line = command + "\n";
  items_.clear();
  if (Status status = channel_->write({reinterpret_cast<const Byte*>(line.data()), line.size()}); !status)
    return fail(lost(status.error()).error());
  const Instant end = clock_.now() + durationOf(limit_s);
  while (clock_.now() < end) {
    if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
    if (Status status = receive(); !status) return fail(status.error());
    for (auto& item : std::exchange(items_, {}))
      if (auto* reply = std::get_if<Reply>(&item); reply && reply->echo == command)
        return std::optional(std::move(*reply));
    clock_.sleepFor(durationOf(0.002));
  }
  return std::optional<Reply>();
}

Result<Reply> ScipScannerUnit::demand(const std::string& command, const JobControl& job) {
  for (int i = 0; i < kTries; ++i) {
    auto reply = ask(command, job, kAnswerS);
    if (!reply) return fail(reply.error());
    if (*reply) return std::move(**reply);
  }
  return fail(lost({"the scanner does not answer", name_, "check its supply and its cable"}).error());
}

Result<Properties> ScipScannerUnit::properties(const std::string& command, const JobControl& job) {
  Error last;
  for (int i = 0; i < kTries; ++i) {
    const auto reply = demand(command, job);
    if (!reply) return fail(reply.error());
    auto found = parseProperties(reply->lines);
    if (found) return found;
    last = found.error();
  }
  return fail(lost({last.what, name_, "check the cable"}).error());
}

// QT also ends a stream, so that what it left on its way has to run dry.
Result<bool> ScipScannerUnit::answersAt(int baud, const JobControl& job) {
  if (baud > 0)
    if (Status status = channel_->setLine({baud, Parity::None}); !status) return fail(status.error());
  reader_.clear();
  for (const char* greeting : {"", "SCIP2.0"}) {
    // Old firmware speaks another language until it is told.
    if (*greeting)
      if (const auto told = ask(greeting, job, 0.1); !told) return fail(told.error());
    const auto reply = ask("QT", job, kProbeS);
    if (!reply) return fail(reply.error());
    if (!*reply) continue;
    if ((*reply)->status == "0E") {
      // Somebody left it adjusting its clock.
      if (const auto ended = ask("TM2", job, kAnswerS); !ended) return fail(ended.error());
      if (const auto again = ask("QT", job, kProbeS); !again) return fail(again.error());
    }
    clock_.sleepFor(durationOf(0.1));
    if (Status status = channel_->discardInput(); !status) return fail(lost(status.error()).error());
    reader_.clear();
    return true;
  }
  return false;
}

Status ScipScannerUnit::connect(const JobControl& job) {
  streaming_ = false;
  channel_.reset();
  auto opened = opener_();
  if (!opened) return fail(opened.error());
  channel_ = std::move(*opened);
  name_ = "Hokuyo scanner at " + channel_->name();
  items_.clear();
  held_.reset();
  told_ = false;
  device_clock_.reset();
  std::vector<int> bauds = settings_.bauds;
  if (bauds.empty()) bauds = {115200, 19200, 38400};
  const bool network = channel_->line().baud > kNetworkBaud;
  if (network) bauds = {0};
  for (int round = 0; round < 2; ++round)
    for (const int baud : bauds) {
      const auto found = answersAt(baud, job);
      if (!found) return fail(found.error());
      if (*found) return {};
    }
  std::vector<std::string> tried;
  for (const int baud : bauds) tried.push_back(std::to_string(baud));
  return lost({"no Hokuyo scanner answers", name_,
               (network ? std::string("it may still be starting, or another program talks to it")
                        : "tried " + joined(tried, ", ") +
                              " Bd: check its supply and its cable, and that no other program uses it")});
}

// Asked what its clock shows, it answers at an instant between question and answer; of several such intervals
// the part that they share is left. Scanners that do not know the question are none the worse.
Status ScipScannerUnit::readClock(const JobControl& job) {
  clock_reading_.reset();
  auto adjusting = ask("TM0", job, kProbeS);
  if (!adjusting) return fail(adjusting.error());
  if (!*adjusting || (*adjusting)->status != "00") return {};
  const Duration tick = durationOf(kUnit);
  std::optional<std::uint32_t> first;
  Instant earliest = Instant::min(), latest = kNever;  // of the first reading
  for (int k = 0; k < kClockReadings; ++k) {
    const Instant asked = clock_.now() + channel_->line().wireTime(4);
    const auto reply = ask("TM1", job, kProbeS);
    if (!reply) return fail(reply.error());
    if (!*reply || (*reply)->status != "00" || (*reply)->lines.empty()) continue;
    const std::string& text = (*reply)->lines.front();
    if (text.size() != 5 || checkCharacter(text.substr(0, 4)) != text[4]) continue;
    const auto shown = decodeNumber(std::string_view(text).substr(0, 4));
    if (!shown) continue;
    if (!first) first = *shown;
    // It showed so much at some instant of the tick that follows.
    const Duration since = device_clock_.between(*first, *shown);
    const Instant from = asked - since - tick, to = arrival_ - since;
    earliest = std::max(earliest, from);
    latest = std::min(latest, to);
    clock_.sleepFor(durationOf(0.0013));  // at another part of the tick
  }
  if (const auto ended = ask("TM2", job, kAnswerS); !ended) return fail(ended.error());
  if (!first || latest < earliest || latest - earliest > 2 * durationOf(kClockOffS)) return {};
  clock_reading_ = Reading{earliest + (latest - earliest) / 2, *first};
  return {};
}

// From scan to scan are whole turns.
Status ScipScannerUnit::readRhythm(const JobControl& job) {
  period_s_ = 0.0;
  if (!clock_reading_) return {};
  std::vector<std::uint32_t> stamps;
  const Instant end = clock_.now() + durationOf(kRhythmS);
  while (stamps.size() < kRhythm && clock_.now() < end) {
    if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
    if (Status status = receive(); !status) return status;
    for (const auto& item : std::exchange(items_, {})) {
      const auto* reply = std::get_if<Reply>(&item);
      if (!reply || reply->echo != encodeOrder(order_) || reply->status != "99") continue;
      if (const auto data = parseScan(reply->lines, order_)) {
        stamps.push_back(data->time_ms);
        (void)timesOf(data->time_ms);
      }
    }
    clock_.sleepFor(durationOf(0.002));
  }
  double shortest_s = kRhythmS;
  for (std::size_t k = 1; k < stamps.size(); ++k)
    shortest_s = std::min(shortest_s, secondsOf(device_clock_.between(stamps[k - 1], stamps[k])));
  const double turns = std::round(shortest_s / turnDuration());
  if (stamps.size() >= 2 && turns >= 1.0 && std::abs(shortest_s - turns * turnDuration()) < 2.0 * kUnit)
    period_s_ = turns * turnDuration();
  return {};
}

Status ScipScannerUnit::prepare(const JobControl& job) {
  if (streaming_) return {};
  job.tell(-1.0, "looking for the scanner");
  if (Status status = connect(job); !status) return status;
  const auto version = properties("VV", job);
  if (!version) return fail(version.error());
  const auto described = properties("PP", job);
  if (!described) return fail(described.error());
  const auto parameters = parseParameters(*described);
  if (!parameters) return lost(parameters.error());
  parameters_ = *parameters;
  const std::string product = property(*version, "PROD");
  name_ = (product.empty() ? parameters_.model : product) + " at " + channel_->name();
  period_s_ = 0.0;
  if (Status status = readClock(job); !status) return status;
  // 02: it is on already.
  const auto laser = demand("BM", job);
  if (!laser) return fail(laser.error());
  if (laser->status != "00" && laser->status != "02")
    return lost({"the scanner does not switch its laser on: " + statusText(laser->status), name_,
                 "switch it off and on"});
  order_ = {settings_.intensities ? "ME" : "MD", parameters_.first, parameters_.last, 1, 0, 0};
  const auto begun = demand(encodeOrder(order_), job);
  if (!begun) return fail(begun.error());
  // The stream may have begun, and its first answer been lost.
  if (begun->status != "00" && begun->status != "99")
    return lost({"the scanner sends no scans: " + statusText(begun->status), name_,
                 settings_.intensities ? "it may have no intensities: leave intensity away"
                                       : "switch it off and on"});
  if (Status status = readRhythm(job); !status) return status;
  streaming_ = true;
  return {};
}

Result<ScipScannerUnit::Identity> ScipScannerUnit::identify(const JobControl& job) {
  if (Status status = connect(job); !status) return fail(status.error());
  Identity identity;
  identity.baud = channel_->line().baud > kNetworkBaud ? 0 : channel_->line().baud;
  auto version = properties("VV", job);
  if (!version) return fail(version.error());
  identity.version = std::move(*version);
  const auto described = properties("PP", job);
  if (!described) return fail(described.error());
  const auto parameters = parseParameters(*described);
  if (!parameters) return fail(parameters.error());
  identity.parameters = *parameters;
  return identity;
}

// The stamp is the scanner's; which instant of the scan it means does not matter, because it is compared with
// when the scans begin to arrive. (How long their bytes take is not known: behind USB the rate means
// nothing.)
LineTimes ScipScannerUnit::timesOf(std::uint32_t time_ms) {
  const Instant to = device_clock_.heard(time_ms, arrival_);
  LineTimes times{to - durationOf(kTurnsBefore * turnDuration() + settings_.latency_s), to};
  if (clock_reading_) {
    const Instant first_beam = clock_reading_->at + device_clock_.between(clock_reading_->time_ms, time_ms);
    // Later the clocks may have drifted apart; how long a scan takes to arrive has not changed.
    if (arrival_ - clock_reading_->at < durationOf(kClockHoldsS)) lag_ = to - first_beam;
    times.spare = lag_ - durationOf(turnDuration());
  }
  return times;
}

// The first three lines of a scan that is on its way: command, status, time stamp.
std::optional<ScannerEvent> ScipScannerUnit::beginning() {
  const auto& lines = reader_.begun();
  if (told_ || lines.size() < 3 || lines[0] != encodeOrder(order_) || lines[1] != "99b") return std::nullopt;
  const std::string_view stamp = lines[2];
  if (stamp.size() != 5 || checkCharacter(stamp.substr(0, 4)) != stamp[4]) return std::nullopt;
  const auto time_ms = decodeNumber(stamp.substr(0, 4));
  if (!time_ms) return std::nullopt;
  told_ = true;
  times_ = timesOf(*time_ms);
  return LineBegun{times_};
}

Result<std::optional<ScannerEvent>> ScipScannerUnit::whole(const Reply& reply) {
  const bool announced = std::exchange(told_, false);
  const auto spoiled = [&](const char* why) {
    return announced ? std::optional<ScannerEvent>(LineSpoiled{why}) : std::nullopt;
  };
  if (reply.echo != encodeOrder(order_)) return spoiled("it is another answer");
  if (reply.status == "00") return std::nullopt;
  if (reply.status != "99")
    return fail(lost({"the scanner has stopped: " + statusText(reply.status), name_, "switch it off and on"})
                    .error());
  const auto data = parseScan(reply.lines, order_);
  if (!data) return spoiled("a check character is wrong");
  LineTaken line;
  line.measured = announced ? times_ : timesOf(data->time_ms);
  const std::size_t count = data->values.size();
  line.range_m.resize(count, 0.0F);
  line.code.resize(count, cell_code::kMissing);
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = static_cast<int>(data->values[i]);
    if (value >= parameters_.nearest_mm && value <= parameters_.furthest_mm) {
      line.code[i] = cell_code::kMeasured;
      line.range_m[i] = static_cast<float>(kUnit * value);
    } else if (value <= 1 || value > parameters_.furthest_mm) {
      // 0 and 1 are said where nothing came back; other small values where it came back badly.
      line.code[i] = cell_code::kNoReturn;
    }
  }
  for (std::size_t i = 0; i < data->intensities.size(); ++i)
    line.intensity.push_back(line.code[i] == cell_code::kMeasured ? static_cast<float>(data->intensities[i])
                                                                  : 0.0F);
  if (announced) return std::optional<ScannerEvent>(std::move(line));
  const LineTimes times = line.measured;
  held_ = std::move(line);
  return std::optional<ScannerEvent>(LineBegun{times});
}

Result<std::optional<ScannerEvent>> ScipScannerUnit::poll() {
  if (!streaming_) return fail("the scanner is not ready", name_, "prepare it first");
  if (held_) return std::exchange(held_, std::nullopt);
  if (items_.empty())
    if (Status status = receive(); !status) return fail(status.error());
  while (!items_.empty()) {
    const auto item = std::move(items_.front());
    items_.erase(items_.begin());
    if (const auto* reply = std::get_if<Reply>(&item)) {
      auto event = whole(*reply);
      if (!event || *event) return event;
    } else if (std::exchange(told_, false)) {
      return std::optional<ScannerEvent>(LineSpoiled{"it arrived damaged"});
    }
  }
  return beginning();
}

Status ScipScannerUnit::release() {
  if (!std::exchange(streaming_, false) || !channel_) return {};
  return demand("QT", {}).map([](const auto&) {});
}

std::vector<std::string> ScipScannerUnit::takeWarnings() {
  return {};
}

}  // namespace tiltmap
