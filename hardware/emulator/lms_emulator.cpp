#include "hardware/emulator/lms_emulator.h"

#include <algorithm>
#include <cmath>

namespace tiltmap {

using namespace lms2xx;

namespace {

std::span<const Byte> bytesOf(const std::string& text) {
  return {reinterpret_cast<const Byte*>(text.data()), text.size()};
}

}  // namespace

LmsEmulator::LmsEmulator(const Clock& clock, SiteView& view, LmsEmulatorSettings settings)
    : clock_(clock), view_(view), settings_(std::move(settings)), random_(settings_.seed) {
  const Instant now = clock_.now();
  if (isS14()) variant_ = {90, 50};
  if (settings_.booted) {
    power_ = Power::On;
    mirror_start_ = now;
    baud_ = settings_.baud;
  } else {
    powerOn(now);
    baud_ = settings_.baud;
  }
}

bool LmsEmulator::isS14() const {
  return parseType(bytesOf(settings_.type)).sendsReflectivity();
}

void LmsEmulator::plug(DeviceWire* wire) {
  wire_ = wire;
  framer_.clear();
  out_.clear();
  burst_.clear();
  held_.clear();
  held_until_ = kNever;
}

void LmsEmulator::cutPower(Duration off) {
  power_ = Power::Off;
  power_event_ = clock_.now() + off;
  out_.clear();
  framer_.clear();
}

void LmsEmulator::powerOn(Instant now) {
  power_ = Power::Booting;
  power_event_ = now + durationOf(settings_.boot_s);
  mirror_start_ = now;
  mode_ = mode::kOnRequest;
  installation_ = false;
  variant_ = isS14() ? Variant{90, 50} : Variant{};
  baud_ = settings_.keeps_rate ? settings_.baud : 9600;
}

Instant LmsEmulator::nextEvent() const {
  if (faults_.silent) return kNever;
  Instant event = power_event_;
  if (power_ == Power::On) event = std::min(event, transmitDue());
  event = std::min(event, held_until_);
  if (wire_) event = std::min(event, wire_->nextArrival());
  return event;
}

void LmsEmulator::act(Instant now) {
  if (faults_.silent) return;
  if (power_event_ <= now) {
    power_event_ = kNever;
    if (power_ == Power::Off) {
      powerOn(now);
    } else {
      power_ = Power::On;
      queueBytes(now,
                 encodeAnswer(command::kPowerOn, bytesOf(settings_.type), statusByte(), settings_.address));
    }
  }
  listen(now);
  if (power_ == Power::On) {
    queueStream(now);
    transmit(now);
  }
  if (held_until_ <= now) {
    held_until_ = kNever;
    deliver(held_);
    held_.clear();
  }
}

void LmsEmulator::listen(Instant now) {
  if (!wire_) return;
  std::array<Byte, 256> buffer;
  for (;;) {
    const auto count = wire_->read(buffer, Instant::min());
    if (!count || *count == 0) return;
    // At another rate, or without power, there is nothing to be understood.
    if (power_ != Power::On || wire_->peerLine().baud != baud_) {
      framer_.clear();
      continue;
    }
    hear(std::span(buffer).first(*count), now);
  }
}

void LmsEmulator::hear(std::span<const Byte> bytes, Instant now) {
  if (framer_.waiting() && now - last_heard_ > durationOf(settings_.host_gap_s)) framer_.clear();
  last_heard_ = now;
  // A byte at a time: a wrong checksum is answered where it stands, and ends what was heard so far.
  for (const Byte byte : bytes) {
    const std::size_t bad = framer_.counts().bad_checksum;
    framer_.push(std::span(&byte, 1));
    const auto token = framer_.next();
    if (token) {
      handle(std::get<Telegram>(*token), now);
    } else if (framer_.counts().bad_checksum != bad) {
      framer_.clear();
      out_.clear();
      queueBytes(now + durationOf(settings_.acknowledge_low_s), {kNak});
    }
  }
}

void LmsEmulator::queueBytes(Instant start, ByteVector bytes) {
  Outgoing outgoing;
  outgoing.start = start;
  outgoing.make = [bytes = std::move(bytes)](Instant) { return bytes; };
  out_.push_back(std::move(outgoing));
}

Instant LmsEmulator::acknowledge(Instant now) {
  const double delay = random_.uniform(settings_.acknowledge_low_s, settings_.acknowledge_high_s);
  const Instant start = now + durationOf(delay);
  if (faults_.lose_acknowledge > 0)
    --faults_.lose_acknowledge;
  else
    queueBytes(start, {kAck});
  return start + LineSettings{baud_}.wireTime(1);
}

bool LmsEmulator::streaming() const {
  return mode_ == mode::kStream || mode_ == mode::kStreamPartial || mode_ == mode::kStreamMean ||
         mode_ == mode::kStreamRange || mode_ == mode::kStreamReflectivity;
}

Instant LmsEmulator::transmitDue() const {
  if (out_.empty()) {
    // A stream that has nothing under way yet is looked after at once.
    return streaming() ? clock_.now() : kNever;
  }
  const Outgoing& outgoing = out_.front();
  if (!outgoing.begun) return outgoing.start;
  return outgoing.start + LineSettings{baud_}.wireTime(outgoing.sent + 1);
}

void LmsEmulator::transmit(Instant now) {
  while (!out_.empty()) {
    Outgoing& outgoing = out_.front();
    if (outgoing.start > now) return;
    if (!outgoing.begun) {
      outgoing.begun = true;
      outgoing.bytes = outgoing.make(outgoing.start);
    }
    while (outgoing.sent < outgoing.bytes.size() &&
           outgoing.start + LineSettings{baud_}.wireTime(outgoing.sent + 1) <= now)
      emit(outgoing.bytes[outgoing.sent++], outgoing);
    flush();
    if (outgoing.sent < outgoing.bytes.size()) return;
    const Instant end = outgoing.start + LineSettings{baud_}.wireTime(outgoing.bytes.size());
    const auto then = std::move(outgoing.then);
    out_.pop_front();
    if (!out_.empty()) out_.front().start = std::max(out_.front().start, end);
    if (then) then();
    queueStream(end);
  }
}

void LmsEmulator::emit(Byte byte, Outgoing& outgoing) {
  // Bytes of one moment go out together, as a system call for each would cost more than the rest.
  ByteVector& sent = faults_.merge_s > 0.0 ? held_ : burst_;
  const auto happens = [this](double probability) {
    return probability > 0.0 && random_.uniform() < probability;
  };
  if (happens(faults_.insert_byte)) sent.push_back(static_cast<Byte>(random_.below(256)));
  if (!happens(faults_.lose_byte)) {
    if (happens(faults_.flip_bit)) byte = static_cast<Byte>(byte ^ 1U << random_.below(8));
    sent.push_back(byte);
    if (happens(faults_.duplicate_byte)) sent.push_back(byte);
  }
  if (happens(faults_.split)) outgoing.start += durationOf(faults_.split_s);
  if (!held_.empty() && held_until_ == kNever) held_until_ = clock_.now() + durationOf(faults_.merge_s);
}

void LmsEmulator::flush() {
  deliver(burst_);
  burst_.clear();
}

void LmsEmulator::deliver(std::span<const Byte> bytes) {
  if (!wire_ || bytes.empty()) return;
  if (wire_->peerLine().baud == baud_) {
    // Nobody may be there to hear it; that is not the scanner's business.
    (void)wire_->write(bytes);
    return;
  }
  // Bits sampled at another rate: runs of ones and zeros.
  constexpr std::array<Byte, 8> kGarbage{0x00, 0x80, 0xE0, 0xF8, 0xFE, 0xFF, 0x78, 0x06};
  ByteVector garbage;
  for (const Byte byte : bytes) garbage.push_back(kGarbage[(byte ^ byte >> 3) & 7U]);
  (void)wire_->write(garbage);
}

}  // namespace tiltmap
