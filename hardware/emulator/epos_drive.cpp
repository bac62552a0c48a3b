// The objects, states and motions of an emulated EPOS.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "hardware/emulator/epos_emulator.h"

namespace tiltmap {

namespace {

constexpr double kNoticeS = 0.05;  // until a following error trips
constexpr double kShortCounts = 400.0;
constexpr std::uint32_t kFollowingError = 0x8611;

constexpr std::uint32_t kNoObject = 0x06020000, kNoSub = 0x06090011, kNotReadable = 0x06010001,
                        kNotWritable = 0x06010002, kOutOfRange = 0x06090030, kWrongState = 0x08000022,
                        kWrongNode = 0x0F00FFB9, kIllegal = 0x0F00FFBF;

double countsPerRadian(const EposEmulatorSettings& settings) {
  return settings.counts_per_turn / (2.0 * std::numbers::pi);
}

}  // namespace

// Everything as after switching on: what was set is forgotten, and so is home.
void EposEmulator::powerOn() {
  constexpr std::int64_t kWord = 0xFFFF, kLong = 0x7FFFFFFF;
  on_ = true;
  drive_ = Drive::SwitchOnDisabled;
  moving_ = homing_ = homed_ = taken_ = trips_ = false;
  reached_ = true;
  trip_ = kNever;
  error_ = 0;
  expecting_ = Expecting::Code;
  stream_.clear();
  outgoing_.clear();
  unheard_.clear();
  objects_ = {
      {{0x1000, 0}, {true, false, 0, 0, 0x00020192}},
      {{0x1001, 0}, {true, false, 0, 0, 0}},
      {{0x603F, 0}, {true, false, 0, 0, 0}},
      {{0x6040, 0}, {true, true, 0, kWord, 0}},
      {{0x6041, 0}, {true, false, 0, 0, 0}},
      {{0x6060, 0}, {true, true, -128, 127, 1}},
      {{0x6061, 0}, {true, false, 0, 0, 1}},
      {{0x6062, 0}, {true, false, 0, 0, 0}},
      {{0x6064, 0}, {true, false, 0, 0, 0}},
      {{0x6065, 0}, {true, true, 0, kLong, 2000}},
      {{0x607A, 0}, {true, true, -kLong - 1, kLong, 0}},
      {{0x607C, 0}, {true, true, -kLong - 1, kLong, 0}},
      {{0x607D, 1}, {true, true, -kLong - 1, kLong, 0x80000000}},
      {{0x607D, 2}, {true, true, -kLong - 1, kLong, 0x7FFFFFFF}},
      {{0x607F, 0}, {true, true, 1, 50000, 25000}},
      {{0x6081, 0}, {true, true, 1, 50000, 1000}},
      {{0x6083, 0}, {true, true, 1, kLong, 10000}},
      {{0x6084, 0}, {true, true, 1, kLong, 10000}},
      {{0x6085, 0}, {true, true, 1, kLong, 10000}},
      {{0x6086, 0}, {true, true, 0, 1, 0}},
      {{0x6098, 0}, {true, true, -4, 35, 7}},
      {{0x6099, 1}, {true, true, 1, 50000, 100}},
      {{0x6099, 2}, {true, true, 1, 50000, 10}},
      {{0x609A, 0}, {true, true, 1, kLong, 1000}},
  };
}

std::uint32_t EposEmulator::object(std::uint16_t index, Byte sub) const {
  return objects_.at({index, sub}).value;
}

std::uint32_t EposEmulator::statusWord(Instant) const {
  std::uint32_t word = 0x0200;  // remote
  switch (drive_) {
    case Drive::SwitchOnDisabled:
      word |= 0x0040;
      break;
    case Drive::ReadyToSwitchOn:
      word |= 0x0021;
      break;
    case Drive::SwitchedOn:
      word |= 0x0033;
      break;
    case Drive::OperationEnabled:
      word |= 0x0037;
      break;
    case Drive::Fault:
      word |= 0x0008;
      if (error_ == kFollowingError) word |= 0x2000;
      break;
  }
  const bool homing_mode = static_cast<std::int8_t>(object(0x6060)) == 6;
  if (reached_) word |= 0x0400;
  if (homing_mode ? homed_ && !homing_ : taken_) word |= 0x1000;
  return word;
}

std::uint32_t EposEmulator::read(std::uint16_t index, Instant now) const {
  const auto position = static_cast<std::uint32_t>(std::llround(motor_.rawPosition(now)));
  switch (index) {
    case 0x1001:
      return error_ != 0 ? 1 : 0;
    case 0x603F:
      return error_;
    case 0x6041:
      return statusWord(now);
    case 0x6061:
      return object(0x6060);
    case 0x6062:
    case 0x6064:
      return position;
    default:
      return 0;
  }
}

EposAnswer EposEmulator::answerTo(const std::optional<EposRequest>& request, Instant now) {
  if (!request) return {kIllegal, std::nullopt};
  if (request->node != settings_.node) return {kWrongNode, std::nullopt};
  const auto found = objects_.find({request->index, request->sub});
  if (found == objects_.end()) {
    const auto same = [&](const auto& entry) { return entry.first.first == request->index; };
    return {std::ranges::any_of(objects_, same) ? kNoSub : kNoObject, std::nullopt};
  }
  if (request->write) return write(*request, now);
  if (!found->second.readable) return {kNotReadable, std::nullopt};
  const bool stored = found->second.writable;
  return {0, stored                         ? found->second.value
             : found->first.first == 0x1000 ? found->second.value
                                            : read(request->index, now)};
}

EposAnswer EposEmulator::write(const EposRequest& request, Instant now) {
  Entry& entry = objects_.at({request.index, request.sub});
  if (!entry.writable) return {kNotWritable, std::nullopt};
  const auto value = static_cast<std::int64_t>(static_cast<std::int32_t>(request.value));
  if (value < entry.low || value > entry.high) return {kOutOfRange, std::nullopt};
  if (request.index == 0x6060) {
    if (value != 1 && value != 3 && value != 6) return {kOutOfRange, std::nullopt};
    if (moving_) return {kWrongState, std::nullopt};
  }
  if (request.index == 0x6098) {
    constexpr std::array<int, 17> kMethods{-4, -3, -2, -1, 1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35, 0, 0};
    if (std::ranges::find(kMethods, static_cast<int>(value)) == kMethods.end())
      return {kOutOfRange, std::nullopt};
  }
  if (request.index == 0x6040) {
    control(request.value, now);
    return {0, std::nullopt};
  }
  entry.value = request.value;
  return {0, std::nullopt};
}

// The transitions of CiA 402, each from its own state alone.
void EposEmulator::control(std::uint32_t word, Instant now) {
  const std::uint32_t before = std::exchange(objects_.at({0x6040, 0}).value, word);
  if (drive_ == Drive::Fault) {
    if ((word & 0x80) && !(before & 0x80)) {
      drive_ = Drive::SwitchOnDisabled;
      error_ = 0;
    }
    return;
  }
  const auto rest = [&](Drive next) {
    motor_.haltAt(now);
    moving_ = homing_ = taken_ = false;
    drive_ = next;
  };
  if (!(word & 0x02)) {
    rest(Drive::SwitchOnDisabled);
    return;
  }
  if (!(word & 0x04)) {
    rest(Drive::SwitchOnDisabled);  // a quick stop
    return;
  }
  switch (word & 0x0F) {
    case 0x06:
      rest(Drive::ReadyToSwitchOn);
      return;
    case 0x07:
      if (drive_ == Drive::ReadyToSwitchOn || drive_ == Drive::OperationEnabled) rest(Drive::SwitchedOn);
      return;
    case 0x0F:
      if (drive_ == Drive::SwitchedOn) drive_ = Drive::OperationEnabled;
      if (drive_ == Drive::OperationEnabled) command(word, before, now);
      return;
    default:
      return;
  }
}

void EposEmulator::command(std::uint32_t word, std::uint32_t before, Instant now) {
  const auto mode = static_cast<std::int8_t>(object(0x6060));
  if (word & 0x0100) {
    motor_.haltAt(now);
    moving_ = homing_ = taken_ = false;
    reached_ = true;
    return;
  }
  const bool edge = (word & 0x10) && !(before & 0x10);
  if (!(word & 0x10)) taken_ = false;
  if (!edge) return;
  if (mode == 6) {
    startHoming(now);
  } else if (mode == 1 && (!moving_ || (word & 0x20))) {
    taken_ = true;
    const double wanted = static_cast<std::int32_t>(object(0x607A));
    const double to_counts_ms = settings_.counts_per_motor_turn / 60000.0;
    const double speed = std::min(object(0x6081), object(0x607F)) * to_counts_ms;
    moveTo((word & 0x40) ? motor_.rawPosition(now) + wanted : wanted, speed,
           object(0x6083) * to_counts_ms / 1000.0, now);
  }
}

void EposEmulator::startHoming(Instant now) {
  const double here = motor_.rawPosition(now);
  const double lower = home_count_ + (settings_.lower_rad - settings_.home_rad) * countsPerRadian(settings_);
  const double upper = home_count_ + (settings_.upper_rad - settings_.home_rad) * countsPerRadian(settings_);
  homed_ = false;
  homing_ = true;
  home_value_ = 0.0;
  switch (static_cast<std::int8_t>(object(0x6098))) {
    case 35:
    case 33:
    case 34:
      home_target_ = here;
      break;
    case 1:
    case 17:
    case -2:
    case -4:
      home_target_ = lower;
      break;
    case 2:
    case 18:
    case -1:
    case -3:
      home_target_ = upper;
      break;
    default:
      home_target_ = home_count_;
      break;
  }
  const double to_counts_ms = settings_.counts_per_motor_turn / 60000.0;
  moveTo(home_target_, object(0x6099, 1) * to_counts_ms, object(0x609A) * to_counts_ms / 1000.0, now);
}

void EposEmulator::moveTo(double target, double speed, double acceleration, Instant now) {
  const double here = motor_.rawPosition(now);
  const double low = home_count_ + (settings_.lower_rad - settings_.home_rad) * countsPerRadian(settings_);
  const double high = home_count_ + (settings_.upper_rad - settings_.home_rad) * countsPerRadian(settings_);
  const double reachable = std::clamp(target, std::min(low, high), std::max(low, high));
  double goal = reachable;
  trips_ = reachable != target;
  if (!homing_ && target != here) {
    if (takeFault(EposFault::Stall)) {
      goal = here + 0.3 * (reachable - here);
      trips_ = true;
    } else if (takeFault(EposFault::FollowError)) {
      goal = here + 0.8 * (reachable - here);
      trips_ = true;
    } else if (std::abs(target - here) > kShortCounts && takeFault(EposFault::LostSteps)) {
      goal = target - (target < here ? -kShortCounts : kShortCounts);
    }
  }
  motor_.moveTo(now, goal, std::min(speed, settings_.most_speed),
                std::min(acceleration, settings_.most_acceleration));
  moving_ = true;
  reached_ = false;
  trip_ = trips_ ? motor_.arrival() + durationOf(kNoticeS) : kNever;
}

void EposEmulator::endMotion(Instant now) {
  moving_ = false;
  reached_ = true;
  if (!std::exchange(homing_, false)) return;
  homed_ = true;
  const double shift = home_value_ - motor_.rawPosition(now);
  motor_.shift(shift);
  home_count_ += shift;
}

void EposEmulator::fail402(std::uint32_t code, Instant now) {
  motor_.haltAt(now);
  moving_ = homing_ = taken_ = trips_ = false;
  reached_ = false;
  drive_ = Drive::Fault;
  error_ = code;
}

}  // namespace tiltmap
