// What an emulated LMS 2xx answers to each request.
#include <algorithm>

#include "hardware/emulator/lms_emulator.h"

namespace tiltmap {

using namespace lms2xx;

namespace {

std::span<const Byte> bytesOf(const std::string& text) {
  return {reinterpret_cast<const Byte*>(text.data()), text.size()};
}

}  // namespace

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

Byte LmsEmulator::statusByte() const {
  constexpr Byte kHealthy = 0x10, kDirty = 0x80;
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

}  // namespace tiltmap
