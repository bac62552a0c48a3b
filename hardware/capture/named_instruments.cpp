#include <filesystem>
#include <map>

#include "core/geometry/pose.h"
#include "hardware/capture/instruments.h"
#include "hardware/capture/lms_scanner_unit.h"
#include "hardware/cola/cola_scanner_unit.h"
#include "hardware/scip/scip_scanner_unit.h"
#include "hardware/tilt/epos_unit.h"
#include "hardware/tilt/mip50_unit.h"
#include "hardware/transport/channel_opener.h"
#include "hardware/transport/replay_channel.h"

namespace tiltmap {

namespace {

constexpr int kScannerBaud = 38400;
constexpr int kTiltBaud = 19200;
constexpr int kEposBaud = 115200;
constexpr int kUrgBaud = 115200;
constexpr double kScannerLatencyS = 0.002;

// The limits of a tilt from ?min= and ?max=, degrees.
Status readLimits(const DeviceUrl& url, double& minimum_rad, double& maximum_rad) {
  const auto low = url.number("min", -180.0, 180.0), high = url.number("max", -180.0, 180.0);
  if (!low) return fail(low.error());
  if (!high) return fail(high.error());
  if (*low) minimum_rad = **low * kDegree;
  if (*high) maximum_rad = **high * kDegree;
  if (!(minimum_rad < maximum_rad))
    return fail("min does not lie below max", url.text(), "give them in degrees");
  return {};
}

Result<LmsSettings> lmsSettings(const DeviceUrl& url) {
  LmsSettings settings;
  const auto baud = url.integer("baud", 9600, 500000);
  if (!baud) return fail(baud.error());
  settings.baud = baud->value_or(kScannerBaud);
  const auto angle = url.integer("angle", 90, 180);
  if (!angle) return fail(angle.error());
  const auto resolution = url.number("resolution", 0.25, 1.0);
  if (!resolution) return fail(resolution.error());
  settings.variant = {angle->value_or(180), static_cast<int>(resolution->value_or(0.5) * 100.0 + 0.5)};
  const auto latency = url.number("latency", 0.0, 100.0);
  if (!latency) return fail(latency.error());
  settings.latency_s = *latency ? 0.001 * **latency : kScannerLatencyS;
  if (const auto unit = url.option("unit")) {
    if (*unit != "cm" && *unit != "mm")
      return fail("unit=" + *unit + " is none", url.text(), "give unit=cm or unit=mm");
    settings.unit = *unit == "cm" ? lms2xx::Unit::Centimetre : lms2xx::Unit::Millimetre;
  }
  return settings;
}

// One opener for as long as the instruments are used, so that a record of the wire goes on when an instrument
// is found again. A scan that is gone on with has the same words as the one before: its record gets the next
// free number, session-2.wire, since a record is never written over.
std::shared_ptr<ChannelOpener> openerOf(DeviceUrl url, int baud, RealClock& clock) {
  if (const auto log = url.option("log")) {
    const std::filesystem::path wished = *log;
    std::error_code ignored;
    for (int number = 2; std::filesystem::exists(url.options["log"], ignored); ++number)
      url.options["log"] = (wished.parent_path() / (wished.stem().string() + "-" + std::to_string(number) +
                                                    wished.extension().string()))
                               .string();
  }
  return std::make_shared<ChannelOpener>(std::move(url), baud, clock);
}

Result<ColaSettings> colaSettings(const DeviceUrl& url) {
  ColaSettings settings;
  const auto resolution = url.number("resolution", 0.05, 5.0),
             frequency = url.number("frequency", 1.0, 200.0), latency = url.number("latency", 0.0, 1000.0);
  for (const auto* number : {&resolution, &frequency, &latency})
    if (!*number) return fail(number->error());
  settings.resolution_deg = *resolution;
  settings.frequency_hz = *frequency;
  if (*latency) settings.latency_s = 0.001 * **latency;
  return settings;
}

Result<ScipSettings> scipSettings(const DeviceUrl& url) {
  ScipSettings settings;
  const auto baud = url.integer("baud", 300, 4000000), intensity = url.integer("intensity", 0, 1);
  for (const auto* number : {&baud, &intensity})
    if (!*number) return fail(number->error());
  const auto latency = url.number("latency", 0.0, 1000.0);
  if (!latency) return fail(latency.error());
  if (*baud) settings.bauds = {**baud};
  settings.intensities = intensity->value_or(0) == 1;
  if (*latency) settings.latency_s = 0.001 * **latency;
  return settings;
}

using ScannerOpener = std::function<Result<std::unique_ptr<ScannerUnit>>()>;
// Opens a channel as often as it is asked; and what makes one for an instrument, whose rate is this where its
// URL names none.
using Channels = std::function<Result<std::unique_ptr<ByteChannel>>()>;
using MakeChannels = std::function<Channels(const DeviceUrl& url, int baud)>;

Result<ScannerOpener> scannerOpener(const DeviceUrl& url, Clock& clock, const MakeChannels& make) {
  if (url.scheme == "lms1xx") {
    const auto settings = colaSettings(url);
    if (!settings) return fail(settings.error());
    return [channels = make(url, kScannerBaud), s = *settings,
            &clock]() -> Result<std::unique_ptr<ScannerUnit>> {
      return std::make_unique<ColaScannerUnit>(channels, clock, s);
    };
  }
  if (url.scheme == "urg") {
    const auto settings = scipSettings(url);
    if (!settings) return fail(settings.error());
    return [channels = make(url, kUrgBaud), s = *settings, &clock]() -> Result<std::unique_ptr<ScannerUnit>> {
      return std::make_unique<ScipScannerUnit>(channels, clock, s);
    };
  }
  const auto settings = lmsSettings(url);
  if (!settings) return fail(settings.error());
  return
      [channels = make(url, kScannerBaud), s = *settings, &clock]() -> Result<std::unique_ptr<ScannerUnit>> {
        return std::make_unique<LmsScannerUnit>(channels, clock, s);
      };
}

struct TiltSettings {
  TiltDrive drive;
  Mip50Table table;
  int axis = 1;
};

Result<TiltSettings> mip50Settings(const DeviceUrl& url) {
  TiltSettings settings;
  if (const auto file = url.option("profile")) {
    auto table = readMip50Table(*file);
    if (!table) return fail(table.error());
    settings.table = std::move(*table);
  }
  const auto axis = url.integer("axis", 1, 127);
  if (!axis) return fail(axis.error());
  settings.axis = axis->value_or(1);
  const auto level = url.number("level", -1e9, 1e9);
  if (!level) return fail(level.error());
  settings.drive.level_count = static_cast<std::int64_t>(level->value_or(0.0));
  const auto counts = url.number("counts", -1e9, 1e9);
  if (!counts) return fail(counts.error());
  if (*counts) settings.drive.counts_per_turn = **counts;
  const auto velocity = url.number("velocity", 0.1, 200.0),
             acceleration = url.number("acceleration", 0.01, 20.0);
  if (!velocity) return fail(velocity.error());
  if (!acceleration) return fail(acceleration.error());
  if (*velocity) settings.drive.speed = **velocity;
  if (*acceleration) settings.drive.acceleration = **acceleration;
  if (Status status = readLimits(url, settings.drive.minimum_rad, settings.drive.maximum_rad); !status)
    return fail(status.error());
  if (Status status = settings.drive.check(); !status)
    return fail(status.error().what, url.text(), status.error().remedy);
  return settings;
}

Result<std::pair<TiltDrive, EposSettings>> eposSettings(const DeviceUrl& url) {
  auto common = mip50Settings(url);
  if (!common) return fail(common.error());
  EposSettings settings;
  if (const auto name = url.option("protocol")) {
    settings.protocol = eposProtocolNamed(*name);
    if (!settings.protocol)
      return fail("protocol=" + *name + " is none", url.text(), "give protocol=v1, v2 or usb");
  }
  const auto node = url.integer("node", 1, 127), home = url.integer("home", -4, 35),
             baud = url.integer("baud", 300, 4000000);
  for (const auto* number : {&node, &home, &baud})
    if (!*number) return fail(number->error());
  const auto impulses = url.number("encoder", 1.0, 100000.0);
  if (!impulses) return fail(impulses.error());
  settings.node = node->value_or(settings.node);
  settings.home_method = home->value_or(settings.home_method);
  if (*baud) settings.bauds = {**baud};
  if (*impulses) settings.counts_per_motor_turn = 4.0 * **impulses;
  return std::pair{common->drive, settings};
}

Result<std::function<Result<std::unique_ptr<TiltUnit>>()>> tiltOpener(const DeviceUrl& url, Clock& clock,
                                                                      AskOperator ask,
                                                                      const MakeChannels& make) {
  if (url.scheme == "manual") {
    if (!ask)
      return fail("there is nobody here to set the tilt by hand", url.text(),
                  "capture with `tiltmap capture` in a terminal, or name a motor: mip50:PORT");
    double low = TiltDrive{}.minimum_rad, high = TiltDrive{}.maximum_rad;
    if (Status status = readLimits(url, low, high); !status) return fail(status.error());
    return [&clock, ask, low, high]() -> Result<std::unique_ptr<TiltUnit>> {
      return std::make_unique<ManualTiltUnit>(clock, ask, low, high);
    };
  }
  if (url.scheme == "epos") {
    if (auto settings = eposSettings(url); !settings) return fail(settings.error());
    return [url, open = make(url, kEposBaud), &clock]() -> Result<std::unique_ptr<TiltUnit>> {
      auto channel = open();
      if (!channel) return fail(channel.error());
      return eposUnit(url, std::move(*channel), clock);
    };
  }
  auto settings = mip50Settings(url);
  if (!settings) return fail(settings.error());
  return [open = make(url, kTiltBaud), &clock, s = *settings]() -> Result<std::unique_ptr<TiltUnit>> {
    auto channel = open();
    if (!channel) return fail(channel.error());
    return std::make_unique<Mip50Unit>(std::move(*channel), clock, s.drive, s.table, s.axis);
  };
}

}  // namespace

Result<std::unique_ptr<ColaScannerUnit>> colaUnit(const DeviceUrl& url, ColaScannerUnit::Opener opener,
                                                  Clock& clock) {
  const auto settings = colaSettings(url);
  if (!settings) return fail(settings.error());
  return std::make_unique<ColaScannerUnit>(std::move(opener), clock, *settings);
}

Result<std::unique_ptr<ScipScannerUnit>> scipUnit(const DeviceUrl& url, ScipScannerUnit::Opener opener,
                                                  Clock& clock) {
  const auto settings = scipSettings(url);
  if (!settings) return fail(settings.error());
  return std::make_unique<ScipScannerUnit>(std::move(opener), clock, *settings);
}

Result<std::unique_ptr<EposUnit>> eposUnit(const DeviceUrl& url, std::unique_ptr<ByteChannel> channel,
                                           Clock& clock) {
  const auto settings = eposSettings(url);
  if (!settings) return fail(settings.error());
  return std::make_unique<EposUnit>(std::move(channel), clock, settings->first, settings->second);
}

namespace {

Result<Instruments> instrumentsOf(const std::string& scanner_url, const std::string& tilt_url, Clock& clock,
                                  AskOperator ask, const MakeChannels& make) {
  const auto scanner = parseDeviceUrl(scanner_url, scannerSchemes());
  if (!scanner) return fail(scanner.error());
  const auto tilt = parseDeviceUrl(tilt_url, tiltSchemes());
  if (!tilt) return fail(tilt.error());
  auto open_scanner = scannerOpener(*scanner, clock, make);
  if (!open_scanner) return fail(open_scanner.error());
  auto open_tilt = tiltOpener(*tilt, clock, std::move(ask), make);
  if (!open_tilt) return fail(open_tilt.error());
  Instruments instruments;
  instruments.clock = &clock;
  instruments.open_scanner = std::move(*open_scanner);
  instruments.open_tilt = std::move(*open_tilt);
  return instruments;
}

}  // namespace

Result<Instruments> namedInstruments(const std::string& scanner_url, const std::string& tilt_url,
                                     RealClock& clock, AskOperator ask) {
  return instrumentsOf(scanner_url, tilt_url, clock, std::move(ask),
                       [&clock](const DeviceUrl& url, int baud) {
                         return [opener = openerOf(url, baud, clock)] { return opener->open(); };
                       });
}

Result<Instruments> replayedInstruments(const std::string& scanner_url, const std::string& tilt_url,
                                        Clock& clock) {
  std::map<std::string, WireSession> sessions;  // by URL
  for (const bool scanner : {true, false}) {
    const auto url =
        parseDeviceUrl(scanner ? scanner_url : tilt_url, scanner ? scannerSchemes() : tiltSchemes());
    if (!url) return fail(url.error());
    auto session = readSession(url->port.substr(url->port.find(':') + 1));
    if (!session) return fail(session.error());
    sessions[url->text()] = std::move(*session);
  }
  return instrumentsOf(scanner_url, tilt_url, clock, {}, [&](const DeviceUrl& url, int) {
    const auto opener = std::make_shared<ReplayOpener>(std::move(sessions.at(url.text())), clock);
    return [opener] { return opener->open(); };
  });
}

}  // namespace tiltmap
