// What is plugged in, and which of it is meant.
#include <QSerialPortInfo>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "hardware/transport/serial_port.h"

namespace tiltmap {

namespace {

std::map<std::string, std::string> stableNames() {
  std::map<std::string, std::string> names;
  std::error_code ended;
  for (std::filesystem::directory_iterator at("/dev/serial/by-id", ended), end; !ended && at != end;
       at.increment(ended)) {
    std::error_code dangling;
    const auto device = std::filesystem::canonical(at->path(), dangling);
    if (!dangling) names[device.string()] = at->path().string();
  }
  return names;
}

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string namesOf(const std::vector<const PortInfo*>& ports) {
  std::string text;
  for (const PortInfo* port : ports) {
    text += (text.empty() ? "" : ", ") + port->path;
    const std::string& about = port->description.empty() ? port->manufacturer : port->description;
    if (!about.empty()) text += " (" + about + ")";
  }
  return text;
}

}  // namespace

std::vector<PortInfo> listPorts() {
  const auto by_id = stableNames();
  std::vector<PortInfo> ports;
  for (const QSerialPortInfo& found : QSerialPortInfo::availablePorts()) {
    PortInfo port;
    port.path = found.systemLocation().toStdString();
    port.description = found.description().toStdString();
    port.manufacturer = found.manufacturer().toStdString();
    port.serial_number = found.serialNumber().toStdString();
    if (found.hasVendorIdentifier()) port.vendor_id = found.vendorIdentifier();
    if (found.hasProductIdentifier()) port.product_id = found.productIdentifier();
    if (const auto name = by_id.find(port.path); name != by_id.end()) port.by_id = name->second;
    ports.push_back(std::move(port));
  }
  std::ranges::sort(ports, {}, &PortInfo::path);
  return ports;
}

Result<std::string> resolvePort(const std::string& wanted, const std::vector<PortInfo>& ports) {
  if (wanted.empty()) return fail("no port is named", "", "`tiltmap devices` lists what is plugged in");
  if (wanted.find('/') != std::string::npos) return wanted;
  const std::string text = lowered(wanted);
  std::vector<const PortInfo*> fitting, all;
  for (const PortInfo& port : ports) {
    if (std::filesystem::path(port.path).filename() == wanted) return port.path;
    all.push_back(&port);
    for (const std::string* about : {&port.by_id, &port.manufacturer, &port.description, &port.serial_number})
      if (lowered(*about).find(text) != std::string::npos) {
        fitting.push_back(&port);
        break;
      }
  }
  if (fitting.size() == 1) return fitting[0]->by_id.empty() ? fitting[0]->path : fitting[0]->by_id;
  if (fitting.size() > 1)
    return fail("more than one port fits: " + namesOf(fitting), wanted,
                "name one of them by its path, or by its by-id path, which stays when it is plugged in anew");
  if (std::filesystem::exists("/dev/" + wanted)) return "/dev/" + wanted;
  return fail("no port fits", wanted,
              all.empty() ? "nothing is plugged in: connect the adapter, then look with `tiltmap devices`"
                          : "there are " + namesOf(all));
}

}  // namespace tiltmap
