#include "hardware/emulator/line_scanner_emulator.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr std::size_t kPiece = 512;

struct NamedFault {
  double usual;  // where no value is given
  double most;
  bool garbles;
  std::function<void(LineScannerEmulator&, double)> apply;
};

const std::map<std::string, NamedFault>& named() {
  using E = LineScannerEmulator;
  const auto count = [](double value) { return static_cast<int>(value); };
  static const std::map<std::string, NamedFault> all{
      {"lose-byte", {0.0005, 1.0, true, [](E& e, double v) { e.faults().lose_byte = v; }}},
      {"flip-bit", {0.0005, 1.0, true, [](E& e, double v) { e.faults().flip_bit = v; }}},
      {"duplicate-byte", {0.0005, 1.0, true, [](E& e, double v) { e.faults().duplicate_byte = v; }}},
      {"insert-byte", {0.0005, 1.0, true, [](E& e, double v) { e.faults().insert_byte = v; }}},
      {"split", {0.2, 1.0, false, [](E& e, double v) { e.faults().split = v; }}},
      {"merge", {0.05, 1.0, false, [](E& e, double v) { e.faults().merge_s = v; }}},
      {"noise", {1, 1e6, false, [count](E& e, double v) { e.faults().noise = count(v); }}},
      {"cut-telegram", {1, 1e6, false, [count](E& e, double v) { e.faults().cut_telegrams = count(v); }}},
      {"miss-request", {1, 1e6, false, [count](E& e, double v) { e.faults().miss_requests = count(v); }}},
      {"late-answer",
       {3.0, 60.0, false,
        [](E& e, double v) {
          e.faults().late_answers = 1;
          e.faults().late_s = v;
        }}},
      {"refuse-configuration",
       {1, 1, false, [](E& e, double v) { e.faults().refuse_configuration = v > 0.0; }}},
      {"dirty-window", {1, 1, false, [](E& e, double v) { e.faults().dirty_window = v > 0.0; }}},
      {"dazzled", {1, 1, false, [](E& e, double v) { e.faults().dazzled = v > 0.0; }}},
      {"power-cut", {1.0, 3600.0, false, [](E& e, double v) { e.cutPower(durationOf(v)); }}},
      {"silent", {1, 1, false, [](E& e, double v) { e.faults().silent = v > 0.0; }}},
  };
  return all;
}

}  // namespace

LineScannerEmulator::LineScannerEmulator(const Clock& clock, SiteView& view, LineScannerTiming timing)
    : clock_(clock), view_(view), timing_(timing), random_(timing.seed) {
  const Instant now = clock_.now();
  power_ = timing_.booted ? Power::On : Power::Booting;
  // A mirror that has been turning for a while.
  mirror_start_ = now - durationOf(timing_.booted ? 1000.37 * timing_.turn_s : 0.0);
  if (!timing_.booted) power_event_ = now + durationOf(timing_.boot_s);
}

std::vector<std::string> LineScannerEmulator::knownFaults() const {
  std::vector<std::string> names;
  for (const auto& [name, fault] : named())
    if (!fault.garbles || garbles()) names.push_back(name);
  names.emplace_back("hang-up");
  names.emplace_back("none");
  return names;
}

Status LineScannerEmulator::applyFault(const std::string& text) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  if (name == "none") {
    faults_ = {};
    return {};
  }
  if (name == "hang-up") {
    hangUp();
    return {};
  }
  const auto names = knownFaults();
  if (std::ranges::find(names, name) == names.end()) {
    const auto nearest = nearestName(name, names);
    return fail("the scanner has no fault `" + name + "`", text,
                (nearest ? "did you mean " + *nearest + "? " : "") + "there are " + joined(names, ", "));
  }
  const NamedFault& fault = named().at(name);
  double value = fault.usual;
  if (equals != std::string::npos) {
    const auto given = parseReal(text.substr(equals + 1));
    if (!given || !(*given >= 0.0 && *given <= fault.most))
      return fail("`" + text.substr(equals + 1) + "` is no value for it", text,
                  "give a number from 0 to " + shortestReal(fault.most));
    value = *given;
  }
  fault.apply(*this, value);
  return {};
}

void LineScannerEmulator::hangUp() {
  if (wire_) wire_->hangUp();
  out_.clear();
  held_.clear();
  forgetOrders();
}

void LineScannerEmulator::plug(DeviceWire* wire) {
  wire_ = wire;
  client_ = wire ? wire->clients() : 0;
  out_.clear();
  held_.clear();
  forgetOrders();
}

void LineScannerEmulator::cutPower(Duration off) {
  power_ = Power::Off;
  power_event_ = clock_.now() + off;
  out_.clear();
  held_.clear();
  if (wire_) wire_->hangUp();
  forgetOrders();
  forgetSettings();
}

void LineScannerEmulator::powerOn(Instant now) {
  if (power_ == Power::Off) {
    power_ = Power::Booting;
    mirror_start_ = now;
    power_event_ = now + durationOf(timing_.boot_s);
  } else {
    power_ = Power::On;
    power_event_ = kNever;
  }
}

void LineScannerEmulator::garble(ByteVector& bytes) {
  const LineScannerFaults& f = faults_;
  if (f.lose_byte + f.flip_bit + f.duplicate_byte + f.insert_byte <= 0.0) return;
  ByteVector sent;
  for (Byte byte : bytes) {
    if (random_.uniform() < f.insert_byte) sent.push_back(static_cast<Byte>(random_.below(256)));
    if (random_.uniform() < f.lose_byte) continue;
    if (random_.uniform() < f.flip_bit) byte ^= static_cast<Byte>(1U << random_.below(8));
    sent.push_back(byte);
    if (random_.uniform() < f.duplicate_byte) sent.push_back(byte);
  }
  bytes = std::move(sent);
}

void LineScannerEmulator::queue(ByteVector bytes, Instant start) {
  if (faults_.noise > 0) {
    --faults_.noise;
    ByteVector noise(20 + random_.below(40));
    for (Byte& byte : noise) byte = static_cast<Byte>(random_.below(256));
    bytes.insert(bytes.begin(), noise.begin(), noise.end());
  }
  garble(bytes);
  Instant at = std::max(start, wire_free_);
  for (std::size_t i = 0; i < bytes.size(); i += kPiece) {
    const std::size_t size = std::min(kPiece, bytes.size() - i);
    at += durationOf(static_cast<double>(size) / timing_.bytes_per_s);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(i);
    out_.push_back({at, {begin, begin + static_cast<std::ptrdiff_t>(size)}});
    if (faults_.split > 0.0 && random_.uniform() < faults_.split) at += durationOf(faults_.split_s);
  }
  wire_free_ = at;
}

void LineScannerEmulator::answer(ByteVector bytes, Instant now) {
  if (faults_.silent) return;
  double delay_s = timing_.answer_s;
  if (faults_.late_answers > 0) {
    --faults_.late_answers;
    delay_s += faults_.late_s;
  }
  queue(std::move(bytes), now + durationOf(delay_s));
}

Instant LineScannerEmulator::lastTurnEnd(Instant now) const {
  const Duration turn = durationOf(timing_.turn_s);
  return mirror_start_ + (now - mirror_start_) / turn * turn;
}

// A turn begins where the first beam is fired; the line is over when the last one was.
LineScannerEmulator::SentLine LineScannerEmulator::measure(Instant end) {
  const ScannerGeometry& shape = geometry();
  SentLine line;
  line.from = end - durationOf(timing_.turn_s);
  const double way = std::abs(shape.azimuth_step_rad) * (shape.columns - 1) / (2.0 * std::numbers::pi);
  line.to = line.from + durationOf(way * timing_.turn_s);
  const TiltFunction tilt = [this, from = line.from](double seconds) {
    return tilt_ ? tilt_(from + durationOf(seconds)) : 0.0;
  };
  line.echoes = view_.line(shape, tilt, 0.0, ++lines_);
  if (faults_.dazzled)
    for (Echo& echo : line.echoes) echo = {0.0F, cell_code::kLmsDazzled, 0.0F};
  return line;
}

void LineScannerEmulator::listen(Instant now) {
  if (!wire_) return;
  std::array<Byte, 1024> buffer;
  while (true) {
    const auto count = wire_->read(buffer, now);
    if (wire_->clients() != client_) {
      // Somebody else.
      client_ = wire_->clients();
      out_.clear();
      held_.clear();
      forgetOrders();
    }
    if (!count || *count == 0) return;
    if (power_ != Power::On || faults_.silent) continue;
    if (baud() != 0 && wire_->peerLine().baud != baud()) continue;
    hear(std::span(buffer).first(*count), now);
  }
}

void LineScannerEmulator::deliver(Instant now) {
  while (!out_.empty() && out_.front().at <= now) {
    held_.insert(held_.end(), out_.front().bytes.begin(), out_.front().bytes.end());
    out_.pop_front();
    if (held_until_ == kNever) held_until_ = now + durationOf(faults_.merge_s);
  }
  if (held_.empty() || now < held_until_) return;
  held_until_ = kNever;
  const ByteVector bytes = std::exchange(held_, {});
  if (wire_ && power_ == Power::On && !faults_.silent) (void)wire_->write(bytes);
}

Instant LineScannerEmulator::nextEvent() const {
  Instant next = power_event_;
  if (wire_) next = std::min(next, wire_->nextArrival());
  if (!out_.empty()) next = std::min(next, out_.front().at);
  if (!held_.empty()) next = std::min(next, held_until_);
  return std::min(next, next_turn_);
}

void LineScannerEmulator::act(Instant now) {
  if (now >= power_event_) powerOn(now);
  listen(now);
  const bool sends = power_ == Power::On && streaming() && !faults_.silent;
  if (!sends) {
    next_turn_ = kNever;
  } else if (next_turn_ == kNever) {
    // The first line is one that begins after it was ordered.
    next_turn_ = lastTurnEnd(now) + 2 * durationOf(timing_.turn_s);
  } else if (now >= next_turn_) {
    const Instant end = lastTurnEnd(now);
    next_turn_ = end + durationOf(timing_.turn_s);
    // While the wire is busy a turn is left out.
    if (wire_free_ <= now) {
      const SentLine line = measure(end);
      ByteVector bytes = lineTelegram(line, now);
      if (faults_.cut_telegrams > 0) {
        --faults_.cut_telegrams;
        bytes.resize(bytes.size() / 2);
      }
      if (!bytes.empty()) {
        if (on_line_) on_line_(line);
        queue(std::move(bytes), now + durationOf(timing_.process_s));
      }
    }
  }
  deliver(now);
}

}  // namespace tiltmap
