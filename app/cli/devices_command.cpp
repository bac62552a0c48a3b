// tiltmap devices
#include <cstdio>

#include "app/cli/command.h"
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

}  // namespace

void addDevices(CLI::App& app, Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("devices", "List the serial ports that instruments may be plugged into");
  command->callback([&chosen] { chosen.body = listDevices; });
}

}  // namespace tiltmap::cli
