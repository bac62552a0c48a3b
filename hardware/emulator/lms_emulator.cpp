#include "hardware/emulator/lms_emulator.h"

#include <algorithm>
#include <cmath>

namespace tiltmap {

using namespace lms2xx;

namespace {

constexpr Byte kHealthy = 0x10, kDirty = 0x80;

std::span<const Byte> bytesOf(const std::string& text) {
  return {reinterpret_cast<const Byte*>(text.data()), text.size()};
}

std::uint16_t rawOf(const Echo& echo, Unit unit, MeasuringMode mode) {
  Value value;
  if (!cell_code::hasPoint(echo.code)) {
    value.code = echo.code;
    return encodeValue(value, mode);
  }
  const long counts = std::lround(static_cast<double>(echo.range_m) / metresPerCount(unit));
  const long furthest = (1L << std::min(distanceBits(mode), 15)) - 10L;
  if (counts > furthest)
    value.code = cell_code::kLmsFirst;  // above the greatest value of this unit
  else
    value.distance = static_cast<std::uint16_t>(counts);
  return encodeValue(value, mode);
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

void LmsEmulator::handle(const Telegram& request, Instant now) {
  if (request.address != 0 && request.address != settings_.address) return;
  if (faults_.miss_request > 0) {
    --faults_.miss_request;
    return;
  }
  out_.clear();  // a request cuts what is being sent
  if (faults_.refuse_checksum > 0) {
    --faults_.refuse_checksum;
    queueBytes(now + durationOf(settings_.acknowledge_low_s), {kNak});
    return;
  }
  const auto data = request.data();
  switch (request.command()) {
    case command::kReset:
      return answer(command::kResetAccepted, {}, now, [this] { powerOn(clock_.now()); });
    case command::kMode:
      return handleMode(data, now);
    case command::kMeasure:
    case command::kMean:
    case command::kRange:
    case command::kReflectivity:
      return handleMeasure(request, now);
    case command::kStatus:
      return answer(0xB1, statusData(status()), now);
    case command::kErrors:
      return answer(0xB2, {}, now);
    case command::kType: {
      const auto text = bytesOf(settings_.type);
      return answer(0xBA, ByteVector(text.begin(), text.end()), now);
    }
    case command::kVariant:
      return handleVariant(data, now);
    case command::kReadConfiguration:
      return answer(0xF4, settings_.configuration.block(), now);
    case command::kWriteConfiguration:
      return handleConfiguration(data, now);
    case command::kPermanentRate:
      if (!installation_ || data.size() != 1 || data[0] > 1) return refuse(now);
      settings_.keeps_rate = data[0] == 1;
      settings_.baud = baud_;
      return answer(0xE6, {1}, now);
    default:
      return refuse(now);
  }
}

void LmsEmulator::answer(Byte name, const ByteVector& data, Instant now, std::function<void()> then) {
  const Instant acknowledged = acknowledge(now);
  double delay = name == 0xF7 ? settings_.configure_s : settings_.answer_s;
  if (faults_.late_answers > 0) {
    --faults_.late_answers;
    delay += faults_.late_s;
  }
  Outgoing outgoing;
  outgoing.start = std::max(acknowledged, now + durationOf(delay));
  // The status is that of the moment it is sent.
  outgoing.make = [this, name, data](Instant) {
    return encodeAnswer(name, data, statusByte(), settings_.address);
  };
  outgoing.then = std::move(then);
  out_.push_back(std::move(outgoing));
}

void LmsEmulator::answerMode(Byte result, Instant now, std::function<void()> then) {
  answer(0xA0, {result}, now, std::move(then));
}

void LmsEmulator::handleMode(std::span<const Byte> data, Instant now) {
  if (data.empty()) return refuse(now);
  const Byte sub = data[0];
  const auto enter = [&](bool installation) {
    installation_ = installation;
    mode_ = sub;
    mode_data_.assign(data.begin() + 1, data.end());
    answerMode(0, now);
  };
  const auto rate = [&](int baud) { answerMode(0, now, [this, baud] { baud_ = baud; }); };
  const auto with = [&](std::size_t count) { return data.size() == 1 + count; };
  switch (sub) {
    case mode::kInstallation:
    case mode::kTestPassword: {
      const bool right = std::ranges::equal(data.subspan(1), bytesOf(settings_.password));
      if (!right) return answerMode(1, now);
      return sub == mode::kInstallation ? enter(true) : answerMode(0, now);
    }
    case mode::kDiagnostic:
    case mode::kStream:
    case mode::kOnRequest:
    case mode::kStreamPartial:
      return with(0) ? enter(false) : refuse(now);
    case mode::kStreamMean:
      return with(1) && data[1] >= 2 && data[1] <= 250 ? enter(false) : refuse(now);
    case mode::kStreamRange: {
      if (!with(4)) return refuse(now);
      const int first = word(data, 1), last = word(data, 3);
      return first >= 1 && first <= last && last <= variant_.values() ? enter(false) : answerMode(2, now);
    }
    case mode::kStreamReflectivity: {
      if (!with(4) || !isS14()) return refuse(now);
      const int first = word(data, 1), last = word(data, 3);
      return first >= 1 && first <= last && last <= variant_.values() ? enter(false) : answerMode(2, now);
    }
    case mode::kRate9600:
      return rate(9600);
    case mode::kRate19200:
      return rate(19200);
    case mode::kRate38400:
      return rate(38400);
    case mode::kRate500000:
      return rate(500000);
    default:
      return refuse(now);
  }
}

void LmsEmulator::handleVariant(std::span<const Byte> data, Instant now) {
  if (data.size() != 4 || installation_) return refuse(now);
  const Variant wanted{word(data, 0), word(data, 2)};
  const bool legal = isS14() ? wanted == Variant{90, 50} : wanted.legal();
  if (mode_ != mode::kOnRequest) mode_ = mode::kOnRequest;  // changing it ends a stream
  const bool accepted = legal && !faults_.refuse_variant;
  if (accepted) variant_ = wanted;
  ByteVector reply{static_cast<Byte>(accepted ? 1 : 0)};
  addWord(reply, static_cast<unsigned>(variant_.angle_deg));
  addWord(reply, static_cast<unsigned>(variant_.resolution_cdeg));
  answer(0xBB, reply, now);
}

void LmsEmulator::handleConfiguration(std::span<const Byte> data, Instant now) {
  if (!installation_) return refuse(now);
  const bool accepted =
      data.size() == settings_.configuration.block().size() && !faults_.refuse_configuration;
  if (accepted) {
    settings_.configuration = Configuration(ByteVector(data.begin(), data.end()));
    ++configuration_writes_;
  }
  const ByteVector& block = settings_.configuration.block();
  ByteVector reply(block.size() + 1);
  reply.front() = accepted ? 1 : 0;
  std::ranges::copy(block, reply.begin() + 1);
  answer(0xF7, reply, now);
}

void LmsEmulator::handleMeasure(const Telegram& request, Instant now) {
  const auto data = request.data();
  Measurement shape;
  int turns = variant_.turns();
  if (installation_) return refuse(now);
  if (request.command() == command::kMeasure && data.size() == 1 && data[0] == 0x01) {
    shape.command = 0xB0;
  } else if (request.command() == command::kMeasure && data.size() == 1 && data[0] == 0x08) {
    shape = shapeOf(mode::kStreamPartial);
    turns = 1;
  } else if (request.command() == command::kMean && data.size() == 1 && data[0] >= 2) {
    shape.command = 0xB6;
    shape.mean_of = data[0];
    turns *= data[0];
  } else if (data.size() == 4 && (request.command() == command::kRange ||
                                  (request.command() == command::kReflectivity && isS14()))) {
    shape.command = request.command() == command::kRange ? 0xB7 : 0xC4;
    shape.first = word(data, 0);
    shape.last = word(data, 2);
    if (*shape.first < 1 || *shape.first > *shape.last || *shape.last > variant_.values()) return refuse(now);
  } else {
    return refuse(now);
  }
  const Instant acknowledged = acknowledge(now);
  Instant not_before = acknowledged;
  const Instant complete = scanEnd(now, turns);
  if (settings_.fresh_on_request)
    not_before = std::max(not_before, complete + durationOf(turns * settings_.turn_s));
  if (faults_.late_answers > 0) {
    --faults_.late_answers;
    not_before += durationOf(faults_.late_s);
  }
  queueScan(not_before, shape, turns);
}

Instant LmsEmulator::scanEnd(Instant at, int turns) const {
  const Duration length = turns * durationOf(settings_.turn_s);
  const auto done = (at - mirror_start_) / length;
  return mirror_start_ + (done + 1) * length;
}

void LmsEmulator::queueScan(Instant not_before, const Measurement& shape, int turns) {
  // Scans follow one another; the first that is complete once the line is free is sent at once.
  const Instant start = scanEnd(not_before - Duration(1), turns);
  Outgoing outgoing;
  outgoing.start = start;
  outgoing.make = [this, shape, turns](Instant end) { return measure(shape, turns, end); };
  out_.push_back(std::move(outgoing));
}

Measurement LmsEmulator::shapeOf(Byte mode) const {
  Measurement shape;
  switch (mode) {
    case mode::kStreamPartial:
      shape.partial = 0;
      break;  // which one is known at its end
    case mode::kStreamMean:
      shape.command = 0xB6;
      shape.mean_of = mode_data_[0];
      break;
    case mode::kStreamRange:
    case mode::kStreamReflectivity:
      shape.command = mode == mode::kStreamRange ? 0xB7 : 0xC4;
      shape.first = word(mode_data_, 0) & 0x7FFF;
      shape.last = word(mode_data_, 2);
      break;
    default:
      break;
  }
  return shape;
}

void LmsEmulator::queueStream(Instant now) {
  if (!streaming() || !out_.empty()) return;
  const int turns = mode_ == mode::kStreamPartial ? 1
                    : mode_ == mode::kStreamMean  ? variant_.turns() * mode_data_[0]
                                                  : variant_.turns();
  queueScan(now, shapeOf(mode_), turns);
}

ByteVector LmsEmulator::measure(Measurement shape, int turns, Instant end) {
  const Duration turn = durationOf(settings_.turn_s);
  const auto turn_number = (end - mirror_start_) / turn;
  ScannerGeometry geometry;
  geometry.rows = 1;
  Variant variant = variant_;
  int scans = std::max(1, shape.mean_of.value_or(1));
  double start_deg = variant.startDegrees();
  if (shape.partial) {
    shape.partial = static_cast<int>((turn_number - 1) % 4);
    variant = {180, 100};
    start_deg = 0.25 * *shape.partial;
    geometry.columns = *shape.partial == 0 ? 181 : 180;
  } else {
    geometry.columns = variant.values();
  }
  geometry.azimuth_start_rad = start_deg * kDegree;
  geometry.azimuth_step_rad = variant.resolution_cdeg * 0.01 * kDegree;

  SentScan sent;
  sent.measured_to = end;
  sent.measured_from = end - turns * turn;
  sent.first_byte = end;
  const TiltFunction tilt = [this, from = sent.measured_from](double seconds) {
    return tilt_ ? tilt_(from + durationOf(seconds)) : 0.0;
  };
  const Unit unit = settings_.configuration.unit();
  const MeasuringMode measuring = settings_.configuration.measuringMode();
  std::vector<double> sums;
  for (int k = 0; k < scans; ++k) {
    const double begin = k * secondsOf(turn) * variant.turns();
    sent.echoes = view_.line(geometry, tilt, begin, ++scans_);
    if (faults_.dazzled)
      for (Echo& echo : sent.echoes) echo = {0.0F, cell_code::kLmsDazzled, 0.0F};
    if (scans == 1) break;
    sums.resize(sent.echoes.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += static_cast<double>(sent.echoes[i].range_m) / scans;
  }
  const std::size_t first = shape.first ? static_cast<std::size_t>(*shape.first - 1) : 0;
  const std::size_t last = shape.last ? static_cast<std::size_t>(*shape.last) : sent.echoes.size();
  for (std::size_t i = first; i < last; ++i) {
    Echo echo = sent.echoes[i];
    if (!sums.empty() && cell_code::hasPoint(echo.code)) echo.range_m = static_cast<float>(sums[i]);
    shape.values.push_back(rawOf(echo, unit, measuring));
    if (shape.command == 0xC4) shape.reflectivity.push_back(static_cast<Byte>(echo.intensity));
  }
  shape.unit = unit;
  shape.status = statusByte();
  if (shape.command == 0xC4) {
    shape.reflectivity_first = *shape.first;
    shape.first.reset();
  }
  if (settings_.configuration.sendsIndices())
    shape.indices = Indices{static_cast<Byte>(turn_number & 255), telegram_index_};
  ++telegram_index_;
  sent.measurement = shape;
  if (on_scan_) on_scan_(sent);
  ByteVector bytes = encodeMeasurement(shape, settings_.address);
  if (faults_.cut_telegrams > 0) {
    --faults_.cut_telegrams;
    bytes.resize(std::min<std::size_t>(bytes.size(), 100));
  }
  return bytes;
}

Byte LmsEmulator::statusByte() const {
  return faults_.dirty_window ? Byte{kHealthy | kDirty} : kHealthy;
}

UnitStatus LmsEmulator::status() const {
  UnitStatus status;
  status.version = settings_.version;
  status.mode = mode_;
  status.motor_us = 148;
  status.measuring_mode = settings_.configuration.measuringMode();
  status.variant = variant_;
  status.baud = baud_;
  status.keeps_rate = settings_.keeps_rate;
  status.address = settings_.address;
  status.unit = settings_.configuration.unit();
  status.laser_on = true;
  status.boot_version = "V01.27";
  status.pollution.fill(faults_.dirty_window ? 900 : 100);
  status.reference_pollution.fill(100);
  return status;
}

// Sending -------------------------------------------------------------------------------------------------

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
