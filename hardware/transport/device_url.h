// How an instrument is named on a command line: SCHEME:PORT?option=value&option=value.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

struct DeviceScheme {
  std::string name;                  // "lms2xx"
  bool has_port = true;              // "manual:" has none
  std::vector<std::string> options;  // beside those of every port: baud, log, speed
  std::string example;
  int tcp_port = 0;    // PORT is HOST or HOST:PORT in a network, this port where none is given; 0: serial
  int usual_port = 0;  // of "tcp:HOST", for those that may be serial or in a network
};
// "lms2xx", "lms1xx" and "urg" are scanners; "mip50", "epos" and "manual" are tilt units.
const std::vector<DeviceScheme>& scannerSchemes();
const std::vector<DeviceScheme>& tiltSchemes();

// The scheme ends at the first colon, the options begin at the last question mark, so that a port's path may
// hold colons.
struct DeviceUrl {
  std::string scheme;
  std::string port;
  std::map<std::string, std::string> options;
  int tcp_port = 0, usual_port = 0;  // as DeviceScheme's

  std::string text() const;
  std::optional<std::string> option(const std::string& name) const;
  // Nothing where the option was not given; fails where it is no number or lies outside.
  Result<std::optional<double>> number(const std::string& name, double low, double high) const;
  Result<std::optional<int>> integer(const std::string& name, int low, int high) const;
};

// Fails with what would have been right: unknown scheme, missing port, unknown or doubled option.
Result<DeviceUrl> parseDeviceUrl(std::string_view text, const std::vector<DeviceScheme>& known);

// Opens what a URL names: a port as resolvePort() finds it, or "replay:FILE" (a recorded session, at ?speed=
// times its pace). ?log=FILE records the session. `baud` is used where the URL names none. The clock must
// outlive the channel. For a driver that connects again and again: ChannelOpener.
Result<std::unique_ptr<ByteChannel>> openChannel(const DeviceUrl& url, int baud, RealClock& clock);

}  // namespace tiltmap
