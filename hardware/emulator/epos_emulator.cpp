#include "hardware/emulator/epos_emulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr std::array<std::pair<EposFault, std::string_view>, 14> kFaultNames{{
    {EposFault::Stall, "motor-stall"},
    {EposFault::FollowError, "follow-error"},
    {EposFault::LostSteps, "lost-steps"},
    {EposFault::LateReply, "tilt-late-reply"},
    {EposFault::LostAcknowledge, "tilt-lost-acknowledge"},
    {EposFault::RefusedFrame, "tilt-refused-frame"},
    {EposFault::Silence, "tilt-silence"},
    {EposFault::LostByte, "tilt-lost-byte"},
    {EposFault::FlippedByte, "tilt-flipped-byte"},
    {EposFault::InsertedByte, "tilt-inserted-byte"},
    {EposFault::LostCommandByte, "tilt-lost-command-byte"},
    {EposFault::FlippedCommandByte, "tilt-flipped-command-byte"},
    {EposFault::PowerCut, "tilt-power-cut"},
    {EposFault::Recover, "tilt-recover"},
}};

constexpr double kLateS = 1.5;
constexpr double kOffS = 2.0;

double countsPerRadian(const EposEmulatorSettings& settings) {
  return settings.counts_per_turn / (2.0 * std::numbers::pi);
}

}  // namespace

std::string eposFaultName(EposFault fault) {
  for (const auto& [known, name] : kFaultNames)
    if (known == fault) return std::string(name);
  return "unknown";
}
std::optional<EposFault> eposFaultNamed(std::string_view name) {
  for (const auto& [fault, known] : kFaultNames)
    if (known == name) return fault;
  return std::nullopt;
}
std::vector<EposFault> allEposFaults() {
  std::vector<EposFault> all;
  for (const auto& entry : kFaultNames) all.push_back(entry.first);
  return all;
}

std::int64_t EposEmulatorSettings::levelCount() const {
  return std::llround(-home_rad * counts_per_turn / (2.0 * std::numbers::pi));
}

EposEmulator::EposEmulator(Clock& clock, DeviceWire& wire, EposEmulatorSettings settings)
    : clock_(clock),
      wire_(&wire),
      settings_(settings),
      motor_(0.0),
      random_(settings.seed),
      stream_(settings.protocol) {
  home_count_ = (settings_.home_rad - settings_.start_rad) * countsPerRadian(settings_);
  powerOn();
}

void EposEmulator::rewire(DeviceWire& wire) {
  wire_ = &wire;
  outgoing_.clear();
}

double EposEmulator::angle(Instant at) const {
  // In whole counts from level, so that who counts sees the very same angle.
  return (motor_.position(at, settings_.settle_s) - home_count_ -
          static_cast<double>(settings_.levelCount())) /
         countsPerRadian(settings_);
}

bool EposEmulator::still(Instant at) const {
  return at >= motor_.arrival() + durationOf(settings_.settle_s);
}

std::vector<std::string> EposEmulator::knownFaults() const {
  std::vector<std::string> names;
  for (const EposFault fault : allEposFaults()) names.push_back(eposFaultName(fault));
  return names;
}

Status EposEmulator::applyFault(const std::string& text) {
  const auto fault = eposFaultNamed(text);
  if (!fault)
    return tiltmap::fail("the tilt unit has no fault `" + text + "`", text,
                         "there are " + joined(knownFaults(), ", "));
  inject(*fault);
  return {};
}

bool EposEmulator::takeFault(EposFault fault) {
  const auto found = faults_.find(fault);
  if (found == faults_.end()) return false;
  if (fault != EposFault::Silence) faults_.erase(found);
  return true;
}

void EposEmulator::inject(EposFault fault) {
  const Instant now = clock_.now();
  if (fault == EposFault::Recover) {
    faults_.clear();
    return;
  }
  if (fault == EposFault::PowerCut) {
    motor_.haltAt(now);
    // The encoder begins at 0 where the tilt stands now.
    const double here = motor_.rawPosition(now);
    motor_.shift(-here);
    home_count_ -= here;
    on_ = moving_ = homing_ = false;
    trip_ = kNever;
    back_on_ = now + durationOf(kOffS);
    outgoing_.clear();
    return;
  }
  faults_.insert(fault);
}

// What is said goes out byte by byte; faults of the wire happen here.
void EposEmulator::say(ByteVector bytes, Instant now) {
  if (faults_.contains(EposFault::Silence) || takeFault(EposFault::LostAcknowledge)) return;
  const auto any = [&] { return static_cast<std::ptrdiff_t>(random_.below(bytes.size())); };
  if (!bytes.empty() && takeFault(EposFault::LostByte)) bytes.erase(bytes.begin() + any());
  if (!bytes.empty() && takeFault(EposFault::FlippedByte))
    bytes[static_cast<std::size_t>(any())] ^= static_cast<Byte>(1U << random_.below(8));
  if (takeFault(EposFault::InsertedByte)) bytes.insert(bytes.begin(), static_cast<Byte>(random_.below(256)));
  Instant at = std::max(wire_free_, now + durationOf(settings_.answer_delay_s));
  if (takeFault(EposFault::LateReply)) {
    at += durationOf(kLateS);
    // Busy with something: what comes meanwhile stays in its buffer.
    busy_until_ = at;
  }
  const LineSettings line{settings_.baud, Parity::None};
  for (const Byte byte : bytes) {
    at += line.wireTime(1);
    outgoing_.push_back({at, byte});
  }
  wire_free_ = at;
}

void EposEmulator::heardV1(Byte byte, Instant now) {
  switch (expecting_) {
    case Expecting::Code:
      if (byte != 0x10 && byte != 0x11) {
        say({epos::kRefused}, now);
        return;
      }
      body_.begin(byte);
      expecting_ = Expecting::Body;
      say({epos::kReady}, now);
      return;
    case Expecting::Body: {
      const auto state = body_.push(byte);
      if (state == EposBodyReader::State::Unfinished) return;
      if (state == EposBodyReader::State::Damaged || takeFault(EposFault::RefusedFrame)) {
        expecting_ = Expecting::Code;
        say({epos::kRefused}, now);
        return;
      }
      say({epos::kReady}, now);
      answer_ = encodeEpos(EposProtocol::V1,
                           eposFrame(answerTo(eposRequest(EposProtocol::V1, body_.frame()), now)));
      expecting_ = Expecting::Consent;
      say({answer_.front()}, now);
      return;
    }
    case Expecting::Consent:
      if (byte != epos::kReady) {
        expecting_ = Expecting::Code;
        return;
      }
      expecting_ = Expecting::Verdict;
      say({answer_.begin() + 1, answer_.end()}, now);
      return;
    case Expecting::Verdict:
      if (byte == epos::kRefused)
        say({answer_.begin() + 1, answer_.end()}, now);
      else
        expecting_ = Expecting::Code;
      return;
  }
}

void EposEmulator::heardV2(Byte byte, Instant now) {
  std::vector<EposStreamReader::Item> items;
  stream_.push({&byte, 1}, items);
  for (const auto& item : items) {
    const auto* frame = std::get_if<EposFrame>(&item);
    // A frame that is damaged is answered by an error.
    const EposAnswer answer = frame ? answerTo(eposRequest(settings_.protocol, *frame), now)
                                    : EposAnswer{epos::kBadChecksum, std::nullopt};
    say(encodeEpos(settings_.protocol, eposFrame(answer)), now);
  }
}

void EposEmulator::receive(Instant now) {
  std::array<Byte, 128> buffer;
  while (true) {
    const auto count = wire_->read(buffer, now);
    if (!count || *count == 0) break;
    // At another rate nothing arrives that means anything.
    if (!on_ || wire_->peerLine().baud != settings_.baud) continue;
    ByteVector bytes(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
    if (takeFault(EposFault::LostCommandByte))
      bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(random_.below(bytes.size())));
    if (!bytes.empty() && takeFault(EposFault::FlippedCommandByte))
      bytes[static_cast<std::size_t>(random_.below(bytes.size()))] ^=
          static_cast<Byte>(1U << random_.below(8));
    unheard_.insert(unheard_.end(), bytes.begin(), bytes.end());
  }
  if (now < busy_until_) return;
  if (!unheard_.empty() && now - last_heard_ >= durationOf(epos::kForgetsS)) {
    expecting_ = Expecting::Code;
    stream_.clear();
  }
  while (!unheard_.empty() && now >= busy_until_) {
    const Byte byte = unheard_.front();
    unheard_.pop_front();
    last_heard_ = now;
    if (settings_.protocol == EposProtocol::V1)
      heardV1(byte, now);
    else
      heardV2(byte, now);
  }
}

Instant EposEmulator::nextEvent() const {
  Instant next = std::min(wire_->nextArrival(), back_on_);
  if (!outgoing_.empty()) next = std::min(next, outgoing_.front().at);
  if (!unheard_.empty()) next = std::min(next, busy_until_);
  if (moving_) next = std::min(next, trips_ ? trip_ : motor_.arrival());
  return next;
}

void EposEmulator::act(Instant now) {
  if (now >= back_on_) {
    back_on_ = kNever;
    powerOn();
  }
  if (on_ && moving_ && trips_ && now >= trip_)
    fail402(0x8611, now);  // a following error
  else if (on_ && moving_ && !trips_ && now >= motor_.arrival())
    endMotion(now);
  receive(now);
  ByteVector due;
  while (!outgoing_.empty() && outgoing_.front().at <= now) {
    due.push_back(outgoing_.front().byte);
    outgoing_.pop_front();
  }
  if (!due.empty() && on_) (void)wire_->write(due);
}

}  // namespace tiltmap
