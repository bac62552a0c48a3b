#include "hardware/cola/cola_scanner_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/geometry/pose.h"

namespace tiltmap {

using namespace cola;

namespace {

constexpr const char* kLogin = "sMN SetAccessMode 03 F4724744";  // level "authorised client"
constexpr int kReady = 7;                                        // of STlms
constexpr double kStartS = 30.0;                                 // until the mirror turns and measures
constexpr double kFirstScanS = 3.0;
constexpr std::uint16_t kFirstDistance = 16;  // smaller values are codes
constexpr std::uint16_t kDazzled = 1;
constexpr double kUnit = 1e-4 * kDegree;
constexpr double kMostTurnS = 0.2;
constexpr double kMostPeriodS = 2.0;
constexpr double kMostTurnsOld = 5.0;  // when it is handed over
constexpr std::size_t kRhythm = 4;     // scans that are looked at for it

std::string hertz(std::uint32_t frequency_chz) {
  return shortestReal(frequency_chz / 100.0) + " Hz";
}
std::string degrees(std::uint32_t step) {
  return shortestReal(step / 10000.0) + " deg";
}

}  // namespace

ColaScannerUnit::ColaScannerUnit(Opener opener, Clock& clock, ColaSettings settings)
    : opener_(std::move(opener)), clock_(clock), settings_(settings) {}
ColaScannerUnit::~ColaScannerUnit() = default;

Status ColaScannerUnit::lost(Error error) {
  streaming_ = false;
  channel_.reset();
  return fail(std::move(error));
}

Status ColaScannerUnit::receive() {
  std::array<Byte, 4096> buffer;
  while (true) {
    const auto count = channel_->read(buffer, clock_.now());
    if (!count) return lost(count.error());
    if (*count == 0) return {};
    arrival_ = clock_.now();
    reader_.push(std::span(buffer).first(*count), items_);
  }
}

Error ColaScannerUnit::refused(const std::string& request, const std::string& code) const {
  const auto value = number(code);
  return {"the scanner refuses `" + request + "`: " + (value ? errorText(*value) : code), name_,
          "see whether another program is connected to it, and what it is set to with the maker's program"};
}

// The words behind verb and name of the answer. Scans that come meanwhile are passed over.
Result<std::vector<std::string>> ColaScannerUnit::ask(const std::string& request, const JobControl& job,
                                                      double limit_s, int tries) {
  const std::string wanted(splitWords(request)[1]);
  for (int i = 0; i < tries; ++i) {
    if (Status status = channel_->write(encode({Dialect::A, request})); !status)
      return fail(lost(status.error()).error());
    const Instant end = clock_.now() + durationOf(limit_s);
    while (clock_.now() < end) {
      if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
      if (Status status = receive(); !status) return fail(status.error());
      for (const auto& item : std::exchange(items_, {})) {
        const auto* telegram = std::get_if<Telegram>(&item);
        if (!telegram || telegram->dialect != Dialect::A) continue;
        const auto words = splitWords(telegram->text);
        if (words.size() >= 2 && words[0] == "sFA") return fail(refused(request, std::string(words[1])));
        if (words.size() < 2 || words[0] == "sSN" || words[1] != wanted) continue;
        std::vector<std::string> rest;
        for (std::size_t k = 2; k < words.size(); ++k) rest.emplace_back(words[k]);
        return rest;
      }
      clock_.sleepFor(durationOf(0.002));
    }
  }
  return fail("the scanner does not answer", name_,
              "it may still be starting; look at its lamps, and whether another program talks to it");
}

// Connected, but deaf to dialect A: perhaps it speaks B there.
Status ColaScannerUnit::speaksOtherDialect(const JobControl& job, Error otherwise) {
  if (Status status = channel_->write(encode({Dialect::B, "sRN DeviceIdent"})); !status)
    return lost(status.error());
  const Instant end = clock_.now() + durationOf(1.0);
  while (clock_.now() < end && !job.stopRequested()) {
    if (Status status = receive(); !status) return status;
    for (const auto& item : std::exchange(items_, {}))
      if (const auto* telegram = std::get_if<Telegram>(&item); telegram && telegram->dialect == Dialect::B)
        return fail("the scanner speaks CoLa-B at this port, and Tiltmap speaks CoLa-A", name_,
                    "try port 2111, or set the scanner to CoLa-A with the maker's program");
    clock_.sleepFor(durationOf(0.01));
  }
  return fail(std::move(otherwise));
}

// A network that connects proves nothing: the scanner may still be starting. Only an answer does.
Status ColaScannerUnit::connect(const JobControl& job) {
  streaming_ = false;
  channel_.reset();
  auto opened = opener_();
  if (!opened) return fail(opened.error());
  channel_ = std::move(*opened);
  name_ = "SICK scanner at " + channel_->name();
  reader_.clear();
  items_.clear();
  held_.reset();
  warned_ = 0;
  device_clock_.reset();
  auto device = ask("sRN DeviceIdent", job, 1.5, 1);
  if (!device && device.error().what == kCancelled) return fail(device.error());
  if (!device && channel_ && device.error().what.find("refuses") == std::string::npos) {
    if (Status other = speaksOtherDialect(job, device.error());
        !other && other.error().what.find("CoLa-B") != std::string::npos)
      return lost(other.error());
    const Instant end = clock_.now() + durationOf(settings_.boot_s);
    job.tell(-1.0, "the scanner is connected and does not answer yet");
    while (!device && channel_ && clock_.now() < end) {
      device = ask("sRN DeviceIdent", job, 2.0, 1);
      if (!device && device.error().what == kCancelled) return fail(device.error());
    }
  }
  if (!channel_) return fail(device.error());
  if (device) {
    // Texts come with their lengths: "10 LMS10x_FieldEval 10 V1.31-09.12.2009".
    std::string text;
    for (std::size_t i = 1; i < device->size(); i += 2) text += (text.empty() ? "" : " ") + (*device)[i];
    if (!text.empty()) name_ = text + " at " + channel_->name();
  } else if (device.error().what.find("refuses") == std::string::npos) {
    return lost(device.error());
  }
  // A stream that an earlier program ordered ends here.
  (void)ask("sEN LMDscandata 0", job, 1.0, 2);
  if (!channel_) return fail("the connection is lost", name_, "check the scanner's supply and its cable");
  if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
  return {};
}

// Nothing for scanners that have no such state (TiM).
Result<std::optional<int>> ColaScannerUnit::state(const JobControl& job) {
  const auto words = ask("sRN STlms", job);
  if (!words) {
    if (words.error().what.find("refuses") != std::string::npos) return std::optional<int>();
    return fail(words.error());
  }
  const auto value = words->empty() ? std::nullopt : number(words->front());
  if (!value) return fail("the scanner's state is not understood", name_, "record the session and report it");
  return std::optional(static_cast<int>(*value));
}

Result<ScanSetting> ColaScannerUnit::setting(const JobControl& job) {
  const auto words = ask("sRN LMPscancfg", job);
  if (!words) return fail(words.error());
  return parseSetting({words->begin(), words->end()});
}

Status ColaScannerUnit::configure(const JobControl& job) {
  if (!settings_.resolution_deg && !settings_.frequency_hz) return {};
  const auto now = setting(job);
  if (!now) return fail(now.error());
  ScanSetting wanted = *now;
  if (settings_.resolution_deg)
    wanted.step = static_cast<std::uint32_t>(std::lround(*settings_.resolution_deg * 10000.0));
  if (settings_.frequency_hz)
    wanted.frequency_chz = static_cast<std::uint32_t>(std::lround(*settings_.frequency_hz * 100.0));
  if (wanted == *now) return {};
  const auto login = ask(kLogin, job);
  if (!login) return fail(login.error());
  if (login->empty() || number(login->front()) != 1U)
    return fail("the scanner does not let us in to change its setting", name_,
                "its password was changed: set frequency and resolution with the maker's program, and leave "
                "them away here");
  const auto answer = ask(settingRequest(wanted), job, 5.0, 1);
  if (!answer) return fail(answer.error());
  const auto result = answer->empty() ? std::nullopt : number(answer->front());
  const auto read = setting(job);
  if (!read) return fail(read.error());
  // What it says counts less than what it is set to.
  if (result != 0U || read->step != wanted.step || read->frequency_chz != wanted.frequency_chz)
    return fail("the scanner does not take " + degrees(wanted.step) + " at " + hertz(wanted.frequency_chz),
                name_,
                "it is set to " + degrees(read->step) + " at " + hertz(read->frequency_chz) +
                    "; an LMS1xx takes 0.25 deg at 25 Hz and 0.5 deg at 25 or 50 Hz");
  return {};
}

Status ColaScannerUnit::startMeasuring(const JobControl& job) {
  auto now = state(job);
  if (!now) return fail(now.error());
  if (!*now || **now == kReady) {
    (void)ask("sMN Run", job, 1.0, 1);
    if (!channel_) return fail("the connection is lost", name_, "check the scanner's supply and its cable");
    return {};
  }
  for (const char* request : {kLogin, "sMN LMCstartmeas", "sMN Run"})
    if (const auto done = ask(request, job, 5.0); !done) return fail(done.error());
  const Instant end = clock_.now() + durationOf(kStartS);
  while (clock_.now() < end) {
    now = state(job);
    if (!now) return fail(now.error());
    if (!*now || **now == kReady) return {};
    job.tell(-1.0, "the scanner is starting");
    clock_.sleepFor(durationOf(0.2));
  }
  return fail("the scanner does not get ready (state " + std::to_string(now->value_or(0)) + ")", name_,
              "switch it off and on, and look at its lamps");
}

// A scan is stamped when its turn begins and when it is handed over, which can be no more than some turns
// later. From scan to scan are whole turns.
void ColaScannerUnit::readRhythm(const std::vector<cola::Scan>& scans) {
  period_s_ = 0.0;
  double shortest_s = kMostPeriodS;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const double age_s = secondsOf(device_clock_.between(scans[k].measured_us, scans[k].sent_us));
    if (age_s < 0.5 * turn_s_ || age_s > kMostTurnsOld * turn_s_) return;
    if (k == 0) continue;
    const double way_s = secondsOf(device_clock_.between(scans[k - 1].measured_us, scans[k].measured_us));
    const double turns = way_s / turn_s_;
    if (turns < 0.9 || std::abs(turns - std::round(turns)) > 0.1 * std::round(turns)) return;
    shortest_s = std::min(shortest_s, way_s);
  }
  if (shortest_s < kMostPeriodS) period_s_ = turn_s_ * std::round(shortest_s / turn_s_);
}

Status ColaScannerUnit::awaitFirstScan(const JobControl& job) {
  const Instant end = clock_.now() + durationOf(kFirstScanS);
  std::vector<cola::Scan> scans;
  while (clock_.now() < end) {
    if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
    if (Status status = receive(); !status) return status;
    for (const auto& item : std::exchange(items_, {})) {
      const auto* telegram = std::get_if<Telegram>(&item);
      if (!telegram || telegram->dialect != Dialect::A || !isScan(telegram->text)) continue;
      const auto scan = parseScan(telegram->text);
      if (!scan) return lost({scan.error().what, name_, scan.error().remedy});
      const Channel* distances = scan->channel("DIST1");
      if (!distances || distances->values.size() < 2 || distances->step == 0)
        return lost({"the scanner sends no distances", name_,
                     "switch the channel DIST1 on with the maker's program"});
      columns_ = static_cast<int>(distances->values.size());
      azimuth_start_rad_ = distances->start * kUnit;
      azimuth_step_rad_ = distances->step * kUnit;
      turn_s_ = scan->frequency_chz > 0 ? std::min(kMostTurnS, 100.0 / scan->frequency_chz) : kMostTurnS;
      (void)device_clock_.heard(scan->sent_us, arrival_);
      watch(scan->status_low);
      scans.push_back(*scan);
      if (scans.size() < kRhythm) continue;
      readRhythm(scans);
      return {};
    }
    clock_.sleepFor(durationOf(0.002));
  }
  readRhythm(scans);
  if (!scans.empty()) return {};
  return lost({"the scanner answers and sends no scans", name_, "switch it off and on"});
}

Status ColaScannerUnit::prepare(const JobControl& job) {
  if (streaming_) return {};
  job.tell(-1.0, "looking for the scanner");
  if (Status status = connect(job); !status) return status;
  for (const auto step : {&ColaScannerUnit::configure, &ColaScannerUnit::startMeasuring})
    if (Status status = (this->*step)(job); !status) return status;
  if (const auto begun = ask("sEN LMDscandata 1", job); !begun) return fail(begun.error());
  if (Status status = awaitFirstScan(job); !status) return status;
  streaming_ = true;
  return {};
}

Result<ColaScannerUnit::Identity> ColaScannerUnit::identify(const JobControl& job) {
  if (Status status = connect(job); !status) return fail(status.error());
  Identity identity;
  identity.device = name_;
  const auto now = state(job);
  if (!now) return fail(now.error());
  identity.state = *now;
  const auto read = setting(job);
  if (!read) return fail(read.error());
  identity.setting = *read;
  return identity;
}

void ColaScannerUnit::watch(std::uint32_t device_status) {
  const std::uint32_t fresh = device_status & ~std::exchange(warned_, warned_ | device_status);
  if (fresh & (kDirty | kVeryDirty))
    warnings_.push_back(std::string("the scanner's window is ") + ((fresh & kVeryDirty) ? "very " : "") +
                        "dirty: wipe it with a soft cloth");
  if (fresh & kDeviceError)
    warnings_.push_back("the scanner reports an error of its own: ask it with the maker's program");
}

Result<LineTaken> ColaScannerUnit::lineOf(const cola::Scan& scan) {
  const Channel* distances = scan.channel("DIST1");
  if (!distances || static_cast<int>(distances->values.size()) != columns_ ||
      std::abs(distances->start * kUnit - azimuth_start_rad_) > 1e-9 ||
      std::abs(distances->step * kUnit - azimuth_step_rad_) > 1e-9)
    return fail(lost({"the scanner was set differently while it was used", name_,
                      "see that no other program is connected to it"})
                    .error());
  LineTaken line;
  // By its own clock; a telegram that was held up is older than it looks. Whether the stamp is that of the
  // first beam or the last one is not sure, so a whole turn is left to it.
  line.measured.to = device_clock_.heard(scan.sent_us, arrival_);
  const Duration age = device_clock_.between(scan.measured_us, scan.sent_us);
  line.measured.from = line.measured.to - durationOf(turn_s_ + settings_.latency_s) -
                       (age < durationOf(1.0) ? age : Duration(0));
  if (period_s_ > 0.0) line.measured.spare = age - durationOf(turn_s_);
  const std::size_t count = distances->values.size();
  line.range_m.resize(count, 0.0F);
  line.code.resize(count, cell_code::kNoReturn);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint16_t value = distances->values[i];
    const float range_m = 0.001F * (static_cast<float>(value) * distances->scale + distances->offset);
    if (value == kDazzled) {
      line.code[i] = cell_code::kLmsDazzled;
    } else if (value >= kFirstDistance && range_m > 0.0F) {
      line.code[i] = cell_code::kMeasured;
      line.range_m[i] = range_m;
    }
  }
  if (const Channel* light = scan.channel("RSSI1"); light && light->values.size() == count)
    for (std::size_t i = 0; i < count; ++i)
      line.intensity.push_back(line.code[i] == cell_code::kMeasured
                                   ? static_cast<float>(light->values[i]) * light->scale + light->offset
                                   : 0.0F);
  watch(scan.status_low);
  return line;
}

Result<std::optional<ScannerEvent>> ColaScannerUnit::poll() {
  if (!streaming_) return fail("the scanner is not ready", name_, "prepare it first");
  if (held_) return std::exchange(held_, std::nullopt);
  if (items_.empty())
    if (Status status = receive(); !status) return fail(status.error());
  while (!items_.empty()) {
    const auto item = std::move(items_.front());
    items_.erase(items_.begin());
    const auto* telegram = std::get_if<Telegram>(&item);
    // What was cut off or garbled is missed; the next turn of the mirror brings another one.
    if (!telegram || telegram->dialect != Dialect::A || !isScan(telegram->text)) continue;
    const auto scan = parseScan(telegram->text);
    if (!scan) continue;
    auto line = lineOf(*scan);
    if (!line) return fail(line.error());
    // A network brings it in one piece: its beginning is told first all the same.
    const LineTimes times = line->measured;
    held_ = std::move(*line);
    return std::optional<ScannerEvent>(LineBegun{times});
  }
  return std::optional<ScannerEvent>();
}

Status ColaScannerUnit::release() {
  if (!std::exchange(streaming_, false) || !channel_) return {};
  return ask("sEN LMDscandata 0", {}).map([](const auto&) {});
}

std::vector<std::string> ColaScannerUnit::takeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace tiltmap
