#include "hardware/emulator/scip_emulator.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace tiltmap {

using namespace scip;

namespace {

constexpr std::size_t kLongestCommand = 128;
constexpr std::uint32_t kNoEcho = 0, kBadEcho = 6;
constexpr std::uint32_t kMostIn2 = 4095;

std::uint32_t milliseconds(Duration duration) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count()) &
         0xFFFFFF;
}

LineScannerTiming timingOf(const ScipEmulatorSettings& settings) {
  LineScannerTiming timing = settings.timing;
  timing.turn_s = 60.0 / settings.parameters.rpm;
  timing.bytes_per_s = settings.baud > 0 ? settings.baud / 10.0 : settings.network ? 1e7 : 1e6;
  timing.boot_s = 5.0;
  return timing;
}

}  // namespace

ScipEmulatorSettings ScipEmulatorSettings::urg04lx() {
  ScipEmulatorSettings settings;
  settings.parameters.model = "URG-04LX(Hokuyo Automatic Co.,Ltd.)";
  return settings;
}

ScipEmulatorSettings ScipEmulatorSettings::utm30lx() {
  ScipEmulatorSettings settings;
  settings.parameters = {"UTM-30LX[Hokuyo Automatic Co.,Ltd.]", 23, 60000, 1440, 0, 1080, 540, 2400};
  settings.product = "SOKUIKI Sensor TOP-URG UTM-30LX";
  settings.intensities = true;
  return settings;
}

ScipEmulatorSettings ScipEmulatorSettings::utm30lxEw() {
  ScipEmulatorSettings settings = utm30lx();
  settings.parameters.model = "UTM-30LX-EW";
  settings.product = "SOKUIKI Sensor UTM-30LX-EW";
  settings.network = true;
  return settings;
}

ScipEmulator::ScipEmulator(const Clock& clock, SiteView& view, ScipEmulatorSettings settings)
    : LineScannerEmulator(clock, view, timingOf(settings)), settings_(std::move(settings)) {
  baud_ = settings_.baud;
  scip2_ = !settings_.old_firmware;
  geometry_.columns = settings_.parameters.columns();
  geometry_.azimuth_start_rad = settings_.parameters.azimuthStart();
  geometry_.azimuth_step_rad = settings_.parameters.azimuthStep();
}

// A plug that is pulled out of a serial port stops nothing; a network's client takes its orders along.
void ScipEmulator::forgetOrders() {
  line_.clear();
  if (settings_.network) order_.reset();
}

void ScipEmulator::forgetSettings() {
  order_.reset();
  laser_ = adjusting_ = false;
  scip2_ = !settings_.old_firmware;
  baud_ = settings_.baud;
  setWire(timingOf(settings_).bytes_per_s);
}

void ScipEmulator::say(const std::string& echo, const std::string& status, std::vector<std::string> lines,
                       Instant now) {
  const std::string text = encodeReply({echo, status, std::move(lines)});
  answer({text.begin(), text.end()}, now);
}

void ScipEmulator::hear(std::span<const Byte> bytes, Instant now) {
  for (const Byte byte : bytes) {
    const char c = static_cast<char>(byte);
    if (c != '\n' && c != '\r') {
      if (line_.size() < kLongestCommand) line_ += c;
      continue;
    }
    if (line_.empty()) continue;
    const std::string command = std::exchange(line_, {});
    if (faults().miss_requests > 0) {
      --faults().miss_requests;
      continue;
    }
    obey(command, now);
  }
}

std::vector<std::string> ScipEmulator::described(const Properties& properties) const {
  std::vector<std::string> lines = encodeProperties(properties);
  if (settings_.other_check)
    for (std::string& line : lines)
      line.back() = checkCharacter(std::string_view(line).substr(0, line.size() - 1));
  return lines;
}

void ScipEmulator::obey(const std::string& command, Instant now) {
  if (command == "SCIP2.0") {
    const bool known = scip2_;
    scip2_ = true;
    if (!known)
      answer({'S', 'C', 'I', 'P', '2', '.', '0', '\n', '0', '\n', '\n'}, now);
    else
      say(command, "0E", {}, now);
    return;
  }
  // In the old language it is a command that does not exist.
  if (!scip2_) return answer({'?', '\n', 'E', '\n', '\n'}, now);
  if (adjusting_ && !command.starts_with("TM")) return say(command, "0E", {}, now);
  if (command == "QT") {
    order_.reset();
    laser_ = false;
    return say(command, "00", {}, now);
  }
  if (command == "BM") return say(command, std::exchange(laser_, true) ? "02" : "00", {}, now);
  if (command == "VV")
    return say(command, "00",
               described({{"VEND", "Hokuyo Automatic Co., Ltd."},
                          {"PROD", settings_.product},
                          {"FIRM", settings_.firmware},
                          {"PROT", "SCIP 2.0"},
                          {"SERI", settings_.serial}}),
               now);
  if (command == "PP") return say(command, "00", described(parameterProperties(settings_.parameters)), now);
  if (command == "II")
    return say(command, "00",
               described({{"MODL", settings_.parameters.model},
                          {"LASR", laser_ ? "ON" : "OFF"},
                          {"MESM", order_ ? "Measuring" : "IDLE"},
                          {"STAT", faults().dirty_window ? "Window dirty" : "Sensor works well."}}),
               now);
  if (command == "RS") {
    forgetSettings();
    return say(command, "00", {}, now);
  }
  if (command == "TM0" || command == "TM2") {
    adjusting_ = command == "TM0";
    return say(command, "00", {}, now);
  }
  if (command == "TM1" && adjusting_) {
    const std::string stamp = encodeNumber(milliseconds(now - poweredOn()), 4);
    return say(command, "00", {stamp + checkCharacter(stamp)}, now);
  }
  if (command.size() == 8 && command.starts_with("SS") && settings_.baud > 0) {
    const auto rate = parseInteger(command.substr(2));
    if (!rate || (*rate != 19200 && *rate != 38400 && *rate != 57600 && *rate != 115200))
      return say(command, "03", {}, now);
    // From the next line on; the answer leaves at the old rate.
    say(command, "00", {}, now);
    baud_ = static_cast<int>(*rate);
    setWire(baud_ / 10.0);
    return;
  }
  if (const auto wanted = parseOrder(command)) return order(command, *wanted, now);
  say(command, "0E", {}, now);
}

void ScipEmulator::order(const std::string& command, const ScanOrder& wanted, Instant now) {
  const Parameters& p = settings_.parameters;
  if (wanted.intensities() && !settings_.intensities) return say(command, "0E", {}, now);
  if (wanted.first < p.first || wanted.last > p.last) return say(command, "04", {}, now);
  if (faults().refuse_configuration) return say(command, "05", {}, now);
  if (wanted.stream()) {
    laser_ = true;
    order_ = wanted;
    sent_ = turns_ = 0;
    return say(command, "00", {}, now);
  }
  if (!laser_) return say(command, "10", {}, now);
  ScanData data = dataOf(measure(lastTurnEnd(now)), wanted);
  data.time_ms = milliseconds(now - poweredOn());
  say(command, "00", encodeScan(data, wanted.characters()), now);
}

ScanData ScipEmulator::dataOf(const SentLine& line, const ScanOrder& order) const {
  const Parameters& p = settings_.parameters;
  ScanData data;
  data.time_ms = milliseconds(line.from - poweredOn());
  for (int step = order.first; step <= order.last; step += order.cluster) {
    // The nearest of a cluster.
    std::uint32_t value = kNoEcho, light = 0;
    for (int k = step; k < step + order.cluster && k <= order.last; ++k) {
      const Echo& echo = line.echoes[static_cast<std::size_t>(k - p.first)];
      std::uint32_t one = cell_code::isFar(echo.code) ? kNoEcho : kBadEcho;
      if (cell_code::hasPoint(echo.code)) {
        const auto mm = static_cast<int>(std::lround(1000.0F * echo.range_m));
        one = mm < p.nearest_mm ? kBadEcho : static_cast<std::uint32_t>(std::min(mm, p.furthest_mm));
      }
      if (order.characters() == 2) one = std::min(one, kMostIn2);
      if (k == step || (one >= static_cast<std::uint32_t>(p.nearest_mm) && one < value)) {
        value = one;
        light = static_cast<std::uint32_t>(std::max(0.0F, echo.intensity));
      }
    }
    data.values.push_back(value);
    if (order.intensities()) data.intensities.push_back(light);
  }
  return data;
}

ByteVector ScipEmulator::lineTelegram(const SentLine& line, Instant) {
  ScanOrder& order = *order_;
  if (turns_++ % (order.skip + 1) != 0) return {};
  ScanOrder echo = order;
  // It tells how many are still to come.
  if (order.count > 0) echo.count = order.count - ++sent_;
  const std::string text =
      encodeReply({encodeOrder(echo), "99", encodeScan(dataOf(line, order), order.characters())});
  if (order.count > 0 && sent_ == order.count) order_.reset();
  return {text.begin(), text.end()};
}

}  // namespace tiltmap
