#include "hardware/emulator/mip50_emulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr std::array<std::pair<Mip50Fault, std::string_view>, 13> kFaultNames{{
    {Mip50Fault::Stall, "motor-stall"},
    {Mip50Fault::FollowError, "follow-error"},
    {Mip50Fault::LostSteps, "lost-steps"},
    {Mip50Fault::LateReply, "tilt-late-reply"},
    {Mip50Fault::LostDone, "tilt-lost-acknowledge"},
    {Mip50Fault::Silence, "tilt-silence"},
    {Mip50Fault::LostByte, "tilt-lost-byte"},
    {Mip50Fault::FlippedByte, "tilt-flipped-byte"},
    {Mip50Fault::InsertedByte, "tilt-inserted-byte"},
    {Mip50Fault::LostCommandByte, "tilt-lost-command-byte"},
    {Mip50Fault::FlippedCommandByte, "tilt-flipped-command-byte"},
    {Mip50Fault::PowerCut, "tilt-power-cut"},
    {Mip50Fault::Recover, "tilt-recover"},
}};

constexpr double kLateS = 1.5;
constexpr double kOffS = 2.0;      // a power cut
constexpr double kNoticeS = 0.05;  // until a follow error trips
constexpr double kShortCounts = 400.0;
constexpr int kUnknownError = 5;  // a position error; the real number is not public

double countsPerRadian(const Mip50EmulatorSettings& settings) {
  return settings.counts_per_turn / (2.0 * std::numbers::pi);
}

}  // namespace

std::string mip50FaultName(Mip50Fault fault) {
  for (const auto& [known, name] : kFaultNames)
    if (known == fault) return std::string(name);
  return "unknown";
}
std::optional<Mip50Fault> mip50FaultNamed(std::string_view name) {
  for (const auto& [fault, known] : kFaultNames)
    if (known == name) return fault;
  return std::nullopt;
}
std::vector<Mip50Fault> allMip50Faults() {
  std::vector<Mip50Fault> all;
  for (const auto& entry : kFaultNames) all.push_back(entry.first);
  return all;
}

std::int64_t Mip50EmulatorSettings::levelCount() const {
  return std::llround(-home_rad * counts_per_turn / (2.0 * std::numbers::pi));
}

// The encoder reads 0 wherever it stands at power-on.
Mip50Emulator::Mip50Emulator(Clock& clock, DeviceWire& wire, Mip50EmulatorSettings settings)
    : clock_(clock),
      wire_(&wire),
      settings_(std::move(settings)),
      reader_(settings_.table),
      motor_(0.0),
      random_(settings_.seed) {
  home_offset_ = (settings_.home_rad - settings_.start_rad) * countsPerRadian(settings_);
  boot(clock_.now());
}

void Mip50Emulator::boot(Instant now) {
  on_ = true;
  ascii_ = !settings_.text_menu;
  regulated_ = homed_ = homing_ = busy_ = stuck_ = false;
  trip_ = kNever;
  error_ = 0;
  reader_.clear();
  incoming_.clear();
  outgoing_.clear();
  wire_free_ = now;
  if (ascii_) answer(Mip50Banner{true}, now);
}

void Mip50Emulator::rewire(DeviceWire& wire) {
  wire_ = &wire;
  incoming_.clear();
  outgoing_.clear();
}

double Mip50Emulator::angle(Instant at) const {
  // In whole counts from level, so that who counts sees the very same angle.
  return (motor_.position(at, settings_.settle_s) - home_offset_ -
          static_cast<double>(settings_.levelCount())) /
         countsPerRadian(settings_);
}

bool Mip50Emulator::still(Instant at) const {
  return at >= motor_.arrival() + durationOf(settings_.settle_s);
}

bool Mip50Emulator::takeFault(Mip50Fault fault) {
  const auto found = faults_.find(fault);
  if (found == faults_.end()) return false;
  if (fault != Mip50Fault::Silence) faults_.erase(found);
  return true;
}

void Mip50Emulator::inject(Mip50Fault fault) {
  const Instant now = clock_.now();
  if (fault == Mip50Fault::Recover) {
    faults_.clear();
    return;
  }
  if (fault == Mip50Fault::PowerCut) {
    motor_.haltAt(now);
    // The encoder begins at 0 where the tilt stands now.
    const double here = motor_.rawPosition(now);
    motor_.shift(-here);
    home_offset_ -= here;
    on_ = busy_ = homing_ = stuck_ = false;
    trip_ = kNever;
    back_on_ = now + durationOf(kOffS);
    outgoing_.clear();
    return;
  }
  faults_.insert(fault);
}

Status Mip50Emulator::applyFault(const std::string& text) {
  const auto fault = mip50FaultNamed(text);
  if (!fault)
    return fail("the tilt unit has no fault `" + text + "`", text,
                "there are " + joined(knownFaults(), ", "));
  inject(*fault);
  return {};
}

std::vector<std::string> Mip50Emulator::knownFaults() const {
  std::vector<std::string> names;
  for (const Mip50Fault fault : allMip50Faults()) names.push_back(mip50FaultName(fault));
  return names;
}

void Mip50Emulator::garble(std::string& bytes) {
  const auto any = [&] { return static_cast<std::size_t>(random_.below(bytes.size())); };
  if (!bytes.empty() && takeFault(Mip50Fault::LostByte)) bytes.erase(any(), 1);
  if (!bytes.empty() && takeFault(Mip50Fault::FlippedByte)) {
    char& byte = bytes[any()];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << random_.below(7)));
  }
  if (takeFault(Mip50Fault::InsertedByte))
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(random_.below(bytes.size() + 1)),
                 static_cast<char>(random_.below(256)));
}

void Mip50Emulator::answer(const Mip50Answer& what, Instant now) {
  if (faults_.contains(Mip50Fault::Silence)) return;
  if (std::holds_alternative<Mip50Done>(what) && takeFault(Mip50Fault::LostDone)) return;
  std::string bytes = encodeAnswer(settings_.table, what);
  garble(bytes);
  Instant at = std::max(wire_free_, now + durationOf(settings_.answer_delay_s));
  if (takeFault(Mip50Fault::LateReply)) at += durationOf(kLateS);
  const LineSettings line{settings_.baud, Parity::None};
  for (const char byte : bytes) {
    at += line.wireTime(1);
    outgoing_.push_back({at, byte});
  }
  wire_free_ = at;
}

void Mip50Emulator::refuse(int number, const Mip50Command& command, Instant now) {
  const std::string text = encodeCommand(settings_.table, command);
  answer(Mip50Refusal{number, settings_.axis, text.empty() ? '?' : text.front()}, now);
}

void Mip50Emulator::beginMove(double target, double speed, Instant now) {
  const double here = motor_.rawPosition(now);
  // It gets no further than its end stops.
  const double low = home_offset_ + (settings_.lower_rad - settings_.home_rad) * countsPerRadian(settings_);
  const double high = home_offset_ + (settings_.upper_rad - settings_.home_rad) * countsPerRadian(settings_);
  const double reachable = std::clamp(target, std::min(low, high), std::max(low, high));
  double goal = reachable;
  bool trips = reachable != target;
  if (!homing_ && target != here) {
    if (takeFault(Mip50Fault::Stall)) {
      goal = here + 0.3 * (reachable - here);
      trips = true;
    } else if (takeFault(Mip50Fault::FollowError)) {
      goal = here + 0.8 * (reachable - here);
      trips = true;
    } else if (std::abs(target - here) > kShortCounts && takeFault(Mip50Fault::LostSteps)) {
      goal = target - (target < here ? -kShortCounts : kShortCounts);
    }
  }
  motor_.moveTo(now, goal, std::min(speed, settings_.most_speed),
                std::min(acceleration_, settings_.most_acceleration));
  busy_ = true;
  stuck_ = trips;
  trip_ = trips ? motor_.arrival() + durationOf(kNoticeS) : kNever;
}

void Mip50Emulator::endMotion(Instant now) {
  busy_ = false;
  if (homing_) {
    homing_ = false;
    homed_ = true;
    const double here = motor_.rawPosition(now);
    motor_.shift(-here);
    home_offset_ -= here;
  }
  answer(Mip50Done{}, now);
}

void Mip50Emulator::obey(const Mip50Command& command, Instant now) {
  if (command.axis != settings_.axis) return;
  if (busy_) return refuse(178, command, now);
  switch (command.verb) {
    case Mip50Verb::ClearError:
      answer(Mip50Value{settings_.table.error_number, {settings_.axis, std::exchange(error_, 0)}}, now);
      break;
    case Mip50Verb::Ramp:
      if (!(command.value > 0.0)) return refuse(174, command, now);
      acceleration_ = command.value;
      break;
    case Mip50Verb::Speed:
      if (!(command.value > 0.0 && command.value <= 1000.0)) return refuse(174, command, now);
      speed_ = command.value;
      break;
    case Mip50Verb::RegulationOn:
      if (error_ != 0) return refuse(176, command, now);
      regulated_ = true;
      break;
    case Mip50Verb::RegulationOff:
      regulated_ = false;
      break;
    case Mip50Verb::Home:
      if (!regulated_) return refuse(180, command, now);
      homing_ = true;
      return beginMove(home_offset_, settings_.home_speed, now);
    case Mip50Verb::MoveAbsolute:
    case Mip50Verb::MoveRelative:
      if (!regulated_) return refuse(180, command, now);
      if (!homed_) return refuse(177, command, now);
      return beginMove(
          command.verb == Mip50Verb::MoveAbsolute ? command.value : motor_.rawPosition(now) + command.value,
          speed_, now);
    case Mip50Verb::ReadPosition:
      answer(Mip50Value{settings_.table.position_number,
                        {settings_.axis, std::llround(motor_.rawPosition(now))}},
             now);
      break;
    case Mip50Verb::ReadParameter: {
      const std::array<std::pair<int, std::int64_t>, 6> known{{{1, settings_.axis},
                                                               {2, settings_.text_menu ? 0 : 2},
                                                               {3, settings_.baud},
                                                               {10, 512},
                                                               {15, 1526},
                                                               {38, 0}}};
      const auto* found =
          std::ranges::find_if(known, [&](const auto& entry) { return entry.first == command.parameter; });
      if (found == known.end()) return refuse(175, command, now);
      answer(Mip50Value{settings_.table.parameter_number, {settings_.axis, command.parameter, found->second}},
             now);
      break;
    }
    case Mip50Verb::WriteParameter:
      return refuse(177, command, now);
  }
  answer(Mip50Done{}, now);
}

// The text menu: a bare carriage return is EMERGENCY STOP, "$P" begins the ASCII mode.
void Mip50Emulator::typed(char key, Instant now) {
  if (key == '\r') {
    motor_.haltAt(now);
    regulated_ = busy_ = false;
    error_ = kUnknownError;
  }
  if (last_key_ == '$' && key == 'P') {
    ascii_ = true;
    reader_.clear();
    answer(Mip50Banner{true}, now);
  }
  last_key_ = key;
}

void Mip50Emulator::receive(Instant now) {
  std::array<Byte, 128> buffer;
  while (true) {
    const auto count = wire_->read(buffer, now);
    if (!count || *count == 0) break;
    // At another rate nothing arrives that means anything.
    if (!on_ || wire_->peerLine().baud != settings_.baud) continue;
    std::string bytes(reinterpret_cast<const char*>(buffer.data()), *count);
    if (takeFault(Mip50Fault::LostCommandByte))
      bytes.erase(static_cast<std::size_t>(random_.below(bytes.size())), 1);
    if (!bytes.empty() && takeFault(Mip50Fault::FlippedCommandByte)) {
      char& byte = bytes[static_cast<std::size_t>(random_.below(bytes.size()))];
      byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U << random_.below(7)));
    }
    // A wire in memory takes its time by itself.
    Instant at = incoming_.empty() ? now : std::max(now, incoming_.back().at);
    for (const char byte : bytes) {
      if (wire_->descriptor() >= 0) at += LineSettings{settings_.baud, Parity::None}.wireTime(1);
      incoming_.push_back({at, byte});
    }
  }
}

void Mip50Emulator::hear(char byte, Instant now) {
  if (!ascii_) return typed(byte, now);
  if (byte == 5) {
    echo_ = !echo_;
    return;
  }
  if (settings_.table.leave_ascii == std::string(1, byte) && reader_.between() &&
      (!busy_ || settings_.heeds_interrupt)) {
    ascii_ = false;
    return answer(Mip50Banner{false}, now);
  }
  std::vector<Mip50CommandReader::Item> items;
  reader_.take({&byte, 1}, items);
  for (const auto& item : items) {
    if (const auto* command = std::get_if<Mip50Command>(&item)) {
      obey(*command, now);
      continue;
    }
    const bool too_long = std::get<Mip50CommandReader::Trouble>(item) == Mip50CommandReader::Trouble::TooLong;
    answer(Mip50Refusal{too_long ? 173 : 172, settings_.axis, '?'}, now);
  }
}

Instant Mip50Emulator::nextEvent() const {
  Instant next = std::min(wire_->nextArrival(), back_on_);
  if (!incoming_.empty()) next = std::min(next, incoming_.front().at);
  if (!outgoing_.empty()) next = std::min(next, outgoing_.front().at);
  if (busy_) next = std::min(next, stuck_ ? trip_ : motor_.arrival());
  return next;
}

void Mip50Emulator::act(Instant now) {
  if (now >= back_on_) {
    back_on_ = kNever;
    boot(now);
  }
  if (on_ && busy_ && stuck_ && now >= trip_) {
    // The follow error: regulation goes off, and nobody is told.
    trip_ = kNever;
    busy_ = stuck_ = homing_ = false;
    regulated_ = false;
    error_ = kUnknownError;
  } else if (on_ && busy_ && !stuck_ && now >= motor_.arrival()) {
    endMotion(now);
  }
  receive(now);
  while (!incoming_.empty() && incoming_.front().at <= now) {
    const char byte = incoming_.front().byte;
    incoming_.pop_front();
    if (on_) hear(byte, now);
  }
  std::string due;
  while (!outgoing_.empty() && outgoing_.front().at <= now) {
    due += outgoing_.front().byte;
    outgoing_.pop_front();
  }
  if (!due.empty() && on_) (void)wire_->write({reinterpret_cast<const Byte*>(due.data()), due.size()});
}

}  // namespace tiltmap
