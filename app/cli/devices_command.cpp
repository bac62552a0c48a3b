// tiltmap devices [URL]
#include <algorithm>
#include <cstdio>

#include "app/cli/command.h"
#include "core/base/text.h"
#include "hardware/capture/instruments.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/transport/channel_opener.h"
#include "hardware/transport/serial_port.h"

namespace tiltmap::cli {

namespace {

std::string usbId(const PortInfo& port) {
  if (port.vendor_id == 0) return {};
  char text[16];
  std::snprintf(text, sizeof text, "%04x:%04x", port.vendor_id, port.product_id);
  return text;
}

std::string portText(const PortInfo& port) {
  std::string about = port.manufacturer;
  const auto add = [&](const std::string& more) {
    if (!more.empty()) about += (about.empty() ? "" : ", ") + more;
  };
  add(port.description);
  if (!port.serial_number.empty()) add("serial number " + port.serial_number);
  add(usbId(port));
  std::string text = port.path + "\n";
  if (!about.empty()) text += "  " + about + "\n";
  if (!port.by_id.empty()) text += "  stays the same when plugged in anew: " + port.by_id + "\n";
  return text;
}

nlohmann::json portJson(const PortInfo& port) {
  return {{"path", port.path},
          {"by_id", port.by_id},
          {"description", port.description},
          {"manufacturer", port.manufacturer},
          {"serial_number", port.serial_number},
          {"usb", usbId(port)}};
}

int listDevices(Context& context) {
  const auto ports = listPorts();
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const PortInfo& port : ports) {
    text += portText(port);
    list.push_back(portJson(port));
  }
  if (ports.empty()) text = "No serial port is plugged in. Connect the adapter and look again.\n";
  context.console.print(text);
  context.console.printJson({{"ports", list}});
  return kDone;
}

std::string degreesText(const lms2xx::Variant& variant) {
  return std::to_string(variant.angle_deg) + " degrees by " + fixedReal(variant.resolution_cdeg / 100.0, 2);
}

std::string dirtText(const lms2xx::UnitStatus& status) {
  std::string text;
  for (const int value : status.pollution) text += (text.empty() ? "" : " ") + std::to_string(value);
  text += ", reference";
  for (const int value : status.reference_pollution) text += " " + std::to_string(value);
  return text;
}

std::string scannerText(const LmsReport& report, const std::vector<lms2xx::StoredError>& errors) {
  const lms2xx::UnitStatus& status = report.status;
  std::string text = report.type.text + " at " + report.port + "\n";
  const auto row = [&text](std::string name, const std::string& value) {
    name.resize(22, ' ');
    text += "  " + name + value + "\n";
  };
  row("rate", std::to_string(report.baud) + " Bd" +
                  (status.keeps_rate ? ", kept at power-on" : "; 9600 at power-on"));
  row("firmware", status.version + ", boot " + status.boot_version);
  row("field of view", degreesText(status.variant));
  row("unit", status.unit == lms2xx::Unit::Millimetre ? "mm (to 8 m)" : "cm (to 80 m)");
  if (report.configuration.plausible())
    row("real-time indices", report.configuration.sendsIndices() ? "sent" : "not sent");
  row("dirt on the window", dirtText(status));
  row("stored errors", errors.empty() ? "none" : std::to_string(errors.size()));
  for (const lms2xx::StoredError& error : errors)
    row("", "type " + std::to_string(error.type) + ", number " + std::to_string(error.number));
  return text;
}

nlohmann::json scannerJson(const LmsReport& report, const std::vector<lms2xx::StoredError>& errors) {
  nlohmann::json stored = nlohmann::json::array();
  for (const lms2xx::StoredError& error : errors)
    stored.push_back({{"type", error.type}, {"number", error.number}});
  return {{"port", report.port},
          {"type", report.type.text},
          {"baud", report.baud},
          {"keeps_rate", report.status.keeps_rate},
          {"firmware", report.status.version},
          {"angle_deg", report.status.variant.angle_deg},
          {"resolution_deg", report.status.variant.resolution_cdeg / 100.0},
          {"unit", report.status.unit == lms2xx::Unit::Millimetre ? "mm" : "cm"},
          {"configuration", hexText(report.configuration.block())},
          {"pollution", report.status.pollution},
          {"reference_pollution", report.status.reference_pollution},
          {"errors", stored},
          {"warnings", warningsJson(report.warnings)}};
}

// Finds the scanner at whatever rate it is, and leaves it as it is.
int askScanner(Context& context, const std::string& text) {
  const auto url = parseDeviceUrl(text, scannerSchemes());
  if (!url) return context.console.wrongUsage(url.error());
  RealClock clock;
  ChannelOpener opener(*url, 9600, clock);
  LmsSettings settings;
  settings.as_found = true;
  LmsScanner scanner([&opener] { return opener.open(); }, clock, settings);
  context.console.note("Looking for the scanner at every rate.");
  const auto report = scanner.connect(context.stop);
  if (!report) return context.console.failed(report.error());
  const auto errors = scanner.storedErrors(context.stop);
  if (!errors) return context.console.failed(errors.error());
  for (const std::string& warning : report->warnings) context.console.warn(warning);
  context.console.print(scannerText(*report, *errors));
  context.console.printJson(scannerJson(*report, *errors));
  return kDone;
}

// A tilt controller: what it says of itself. Nothing moves.
int askTilt(Context& context, const std::string& text) {
  const auto url = parseDeviceUrl(text, tiltSchemes());
  if (!url) return context.console.wrongUsage(url.error());
  if (url->scheme != "epos")
    return context.console.wrongUsage({"only an EPOS can be asked how it is", text,
                                       "name a scanner or epos:PORT; `tiltmap devices` lists ports"});
  RealClock clock;
  auto channel = ChannelOpener(*url, 115200, clock).open();
  if (!channel) return context.console.failed(channel.error());
  auto unit = eposUnit(*url, std::move(*channel), clock);
  if (!unit) return context.console.wrongUsage(unit.error());
  context.console.note("Looking for the controller at every rate.");
  JobControl job;
  job.stop = context.stop;
  const auto found = (*unit)->identify(job);
  if (!found) return context.console.failed(found.error());
  char status[8], error[8];
  std::snprintf(status, sizeof status, "%04X", static_cast<unsigned>(found->status & 0xFFFF));
  std::snprintf(error, sizeof error, "%04X", static_cast<unsigned>(found->error & 0xFFFF));
  context.console.print("EPOS at " + url->port + "\n  protocol              " +
                        eposProtocolName(found->protocol) + "\n  rate                  " +
                        std::to_string(found->baud) + " Bd\n  status                " + status +
                        "\n  last error            " + (found->error == 0 ? "none" : error) +
                        "\n  position              " + std::to_string(found->position) + " counts\n");
  context.console.printJson({{"port", url->port},
                             {"type", "EPOS"},
                             {"protocol", eposProtocolName(found->protocol)},
                             {"baud", found->baud},
                             {"status", status},
                             {"error", error},
                             {"position", found->position}});
  return kDone;
}

// A SICK scanner at a network. Nothing in it is changed.
int askCola(Context& context, const std::string& text) {
  const auto url = parseDeviceUrl(text, scannerSchemes());
  if (!url) return context.console.wrongUsage(url.error());
  RealClock clock;
  ChannelOpener opener(*url, 9600, clock);
  auto unit = colaUnit(
      *url, [&opener] { return opener.open(); }, clock);
  if (!unit) return context.console.wrongUsage(unit.error());
  JobControl job;
  job.stop = context.stop;
  const auto found = (*unit)->identify(job);
  if (!found) return context.console.failed(found.error());
  const auto degrees = [](double units) { return fixedReal(units / 10000.0, 2); };
  const cola::ScanSetting& setting = found->setting;
  std::string state = "not told";
  if (found->state) state = std::to_string(*found->state) + (*found->state == 7 ? " (measures)" : "");
  context.console.print(found->device + "\n  state                 " + state + "\n  field of view         " +
                        degrees(setting.start) + " to " + degrees(setting.end) + " degrees by " +
                        degrees(setting.step) + "\n  rate                  " +
                        fixedReal(setting.frequency_chz / 100.0, 2) + " Hz\n");
  context.console.printJson({{"port", url->port},
                             {"type", found->device},
                             {"state", found->state ? nlohmann::json(*found->state) : nlohmann::json()},
                             {"start_deg", setting.start / 10000.0},
                             {"end_deg", setting.end / 10000.0},
                             {"resolution_deg", setting.step / 10000.0},
                             {"frequency_hz", setting.frequency_chz / 100.0}});
  return kDone;
}

// A Hokuyo scanner. It does not measure for that.
int askScip(Context& context, const std::string& text) {
  const auto url = parseDeviceUrl(text, scannerSchemes());
  if (!url) return context.console.wrongUsage(url.error());
  RealClock clock;
  ChannelOpener opener(*url, 115200, clock);
  auto unit = scipUnit(
      *url, [&opener] { return opener.open(); }, clock);
  if (!unit) return context.console.wrongUsage(unit.error());
  JobControl job;
  job.stop = context.stop;
  const auto found = (*unit)->identify(job);
  if (!found) return context.console.failed(found.error());
  const scip::Parameters& p = found->parameters;
  const double step_deg = 360.0 / p.steps_per_turn, start_deg = 90.0 + (p.first - p.front) * step_deg;
  const auto say = [&](const char* key) { return scip::property(found->version, key); };
  context.console.print(say("PROD") + " at " + url->port + "\n  model                 " + p.model +
                        "\n  firmware              " + say("FIRM") + "\n  serial number         " +
                        say("SERI") + "\n  field of view         " + fixedReal(start_deg, 2) + " to " +
                        fixedReal(start_deg + (p.last - p.first) * step_deg, 2) + " degrees by " +
                        fixedReal(step_deg, 4) + "\n  rate                  " + fixedReal(p.rpm / 60.0, 2) +
                        " Hz\n  ranges                " + std::to_string(p.nearest_mm) + " to " +
                        std::to_string(p.furthest_mm) + " mm\n");
  context.console.printJson({{"port", url->port},
                             {"type", say("PROD")},
                             {"model", p.model},
                             {"firmware", say("FIRM")},
                             {"serial_number", say("SERI")},
                             {"baud", found->baud},
                             {"start_deg", start_deg},
                             {"resolution_deg", step_deg},
                             {"values", p.columns()},
                             {"frequency_hz", p.rpm / 60.0}});
  return kDone;
}

int askInstrument(Context& context, const std::string& text) {
  const std::string scheme = text.substr(0, text.find(':'));
  const bool tilt = std::ranges::find(tiltSchemes(), scheme, &DeviceScheme::name) != tiltSchemes().end();
  if (tilt) return askTilt(context, text);
  if (scheme == "urg") return askScip(context, text);
  return scheme == "lms1xx" ? askCola(context, text) : askScanner(context, text);
}

}  // namespace

void addDevices(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand(
      "devices",
      "List the serial ports that instruments may be plugged into, or ask an instrument how it is");
  auto url = std::make_shared<std::string>();
  command->add_option("url", *url,
                      "What to ask, as lms2xx:PORT, lms1xx:HOST, urg:PORT or epos:PORT; nothing in it is "
                      "changed, nothing moves");
  command->callback([&chosen, url] {
    chosen.body = [url](Context& context) {
      return url->empty() ? listDevices(context) : askInstrument(context, *url);
    };
  });
}

}  // namespace tiltmap::cli
