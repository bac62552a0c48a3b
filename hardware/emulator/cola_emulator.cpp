#include "hardware/emulator/cola_emulator.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/geometry/pose.h"

namespace tiltmap {

using namespace cola;

namespace {

constexpr double kUnit = 1e-4 * kDegree;
constexpr std::uint16_t kNoEcho = 0, kDazzled = 1, kFirstDistance = 16;
constexpr std::uint32_t kNoMethod = 2, kNoVariable = 3, kDenied = 1;

std::string lengthAndText(const std::string& text) {
  return hexNumber(static_cast<std::uint32_t>(text.size())) + " " + text;
}

std::uint32_t microseconds(Duration duration) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::microseconds>(duration).count());
}

}  // namespace

ColaEmulatorSettings ColaEmulatorSettings::lms1xx() {
  return {};
}

ColaEmulatorSettings ColaEmulatorSettings::lms5xx() {
  ColaEmulatorSettings settings;
  settings.type = "LMS511";
  settings.setting = {5000, 5000, -50000, 1850000};
  settings.scale = 2.0F;
  return settings;
}

bool ColaEmulatorSettings::allows(const ScanSetting& wanted) const {
  // Rates of the mirror, and the finest step of each, in units of the telegrams.
  const bool large = type.starts_with("LMS5");
  if (wanted.start != setting.start || wanted.end != setting.end) return false;
  if (large)
    return (wanted.frequency_chz == 2500 && (wanted.step == 2500 || wanted.step == 1667)) ||
           (wanted.frequency_chz == 5000 && (wanted.step == 5000 || wanted.step == 3333)) ||
           (wanted.frequency_chz == 7500 && (wanted.step == 5000 || wanted.step == 10000));
  return (wanted.frequency_chz == 2500 && (wanted.step == 2500 || wanted.step == 5000)) ||
         (wanted.frequency_chz == 5000 && wanted.step == 5000);
}

ColaEmulator::ColaEmulator(const Clock& clock, SiteView& view, ColaEmulatorSettings settings)
    : LineScannerEmulator(clock, view,
                          [&] {
                            LineScannerTiming timing = settings.timing;
                            timing.turn_s = 100.0 / settings.setting.frequency_chz;
                            return timing;
                          }()),
      settings_(std::move(settings)),
      at_power_on_(settings_.setting),
      measuring_(settings_.measuring),
      now_(clock.now()) {
  ready_at_ = measuring_ ? now_ : kNever;
  applySetting();
}

void ColaEmulator::applySetting() {
  const ScanSetting& s = settings_.setting;
  geometry_.azimuth_start_rad = s.start * kUnit;
  geometry_.azimuth_step_rad = s.step * kUnit;
  geometry_.columns = static_cast<int>((s.end - s.start) / static_cast<std::int32_t>(s.step)) + 1;
  setTurn(100.0 / s.frequency_chz);
}

void ColaEmulator::forgetOrders() {
  streaming_ = logged_in_ = false;
  reader_.clear();
}

void ColaEmulator::forgetSettings() {
  settings_.setting = at_power_on_;
  measuring_ = settings_.measuring;
  ready_at_ = measuring_ ? Instant{} : kNever;
  applySetting();
}

void ColaEmulator::say(const std::string& text, Instant now) {
  answer(encode({Dialect::A, text}), now);
}

void ColaEmulator::hear(std::span<const Byte> bytes, Instant now) {
  now_ = now;
  std::vector<Reader::Item> items;
  reader_.push(bytes, items);
  for (const auto& item : items) {
    const auto* telegram = std::get_if<Telegram>(&item);
    // What is no telegram of its own dialect is not answered.
    if (!telegram || (telegram->dialect == Dialect::B) != settings_.binary) continue;
    if (faults().miss_requests > 0) {
      --faults().miss_requests;
      continue;
    }
    if (settings_.binary) {
      if (telegram->text == "sRN DeviceIdent")
        answer(encode({Dialect::B, "sRA DeviceIdent " + settings_.type}), now);
      continue;
    }
    obey(telegram->text, now);
  }
}

std::string ColaEmulator::configured(const ScanSetting& wanted) {
  if (!logged_in_) return "sFA " + hexNumber(kDenied);
  const bool taken = !faults().refuse_configuration && settings_.allows(wanted);
  if (taken) {
    settings_.setting = wanted;
    applySetting();
  }
  return std::string("sAN mLMPsetscancfg ") + (taken ? "0 " : "2 ") + settingWords(settings_.setting);
}

void ColaEmulator::obey(const std::string& request, Instant now) {
  const auto words = splitWords(request);
  if (words.size() < 2) return say("sFA " + hexNumber(kNoMethod), now);
  const std::string_view verb = words[0], name = words[1];
  const auto third = words.size() > 2 ? words[2] : std::string_view();
  if (verb == "sRN") {
    if (name == "DeviceIdent")
      return say("sRA DeviceIdent " + lengthAndText(settings_.type) + " " + lengthAndText(settings_.version),
                 now);
    if (name == "STlms" && settings_.has_state)
      return say("sRA STlms " +
                     std::string(!measuring_       ? "2"
                                 : now < ready_at_ ? "4"
                                                   : "7") +
                     " 0 8 00:00:00 A 01.01.1970 0 0 0",
                 now);
    if (name == "LMPscancfg") return say("sRA LMPscancfg " + settingWords(settings_.setting), now);
    if (name == "LMDscandata" && measuring_ && now >= ready_at_) return sayScan(now);
    return say("sFA " + hexNumber(kNoVariable), now);
  }
  if (verb == "sEN" && name == "LMDscandata" && (third == "0" || third == "1")) {
    streaming_ = third == "1";
    return say("sEA LMDscandata " + std::string(third), now);
  }
  if (verb == "sMN") {
    if (name == "SetAccessMode") {
      logged_in_ = words.size() == 4 && third == "03" && words[3] == settings_.password;
      return say(std::string("sAN SetAccessMode ") + (logged_in_ ? "1" : "0"), now);
    }
    if (const auto wanted = requestedSetting(request)) return say(configured(*wanted), now);
    if (name == "Run") {
      logged_in_ = false;
      return say("sAN Run 1", now);
    }
    if (name == "LMCstartmeas" || name == "LMCstopmeas") {
      if (!logged_in_) return say("sFA " + hexNumber(kDenied), now);
      measuring_ = name == "LMCstartmeas";
      ready_at_ = measuring_ ? now + durationOf(settings_.start_s) : kNever;
      return say("sAN " + std::string(name) + " 0", now);
    }
  }
  say("sFA " + hexNumber(kNoMethod), now);
}

cola::Scan ColaEmulator::scanOf(const SentLine& line, Instant now) {
  cola::Scan scan;
  scan.serial = 0x89A27F;
  if (faults().dirty_window) scan.status_low = kDirty;
  scan.telegrams = ++telegrams_ & 0xFFFF;
  scan.scans = static_cast<std::uint32_t>((line.from - poweredOn()) / durationOf(timing().turn_s)) & 0xFFFF;
  scan.measured_us = microseconds(line.from - poweredOn());
  scan.sent_us = microseconds(now - poweredOn());
  scan.outputs_high = 7;
  scan.frequency_chz = settings_.setting.frequency_chz;
  scan.measuring_frequency = 0x168;
  Channel distances{"DIST1", settings_.scale, 0.0F, settings_.setting.start, settings_.setting.step, {}};
  Channel light{"RSSI1", 1.0F, 0.0F, settings_.setting.start, settings_.setting.step, {}};
  for (const Echo& echo : line.echoes) {
    std::uint16_t value = echo.code == cell_code::kLmsDazzled ? kDazzled : kNoEcho;
    const long units = std::lround(1000.0F * echo.range_m / settings_.scale);
    if (cell_code::hasPoint(echo.code) && units >= kFirstDistance && units <= 0xFFFF)
      value = static_cast<std::uint16_t>(units);
    distances.values.push_back(value);
    light.values.push_back(static_cast<std::uint16_t>(std::clamp(echo.intensity, 0.0F, 255.0F)));
  }
  scan.channels16.push_back(std::move(distances));
  if (settings_.intensities) scan.channels8.push_back(std::move(light));
  scan.rest = {"0", "0", "0", "0", "0"};
  return scan;
}

ByteVector ColaEmulator::lineTelegram(const SentLine& line, Instant now) {
  now_ = now;
  return encode({Dialect::A, scanText(scanOf(line, now))});
}

// The scan that was complete last, when it is asked for.
void ColaEmulator::sayScan(Instant now) {
  cola::Scan scan = scanOf(measure(lastTurnEnd(now)), now);
  scan.asked = true;
  say(scanText(scan), now);
}

}  // namespace tiltmap
