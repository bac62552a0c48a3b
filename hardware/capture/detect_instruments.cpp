#include "hardware/capture/detect_instruments.h"

#include <functional>
#include <mutex>
#include <thread>

#include "core/base/text.h"
#include "hardware/capture/instruments.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/tilt/mip50_unit.h"
#include "hardware/transport/channel_opener.h"
#include "hardware/transport/serial_port.h"

namespace tiltmap {

namespace {

constexpr int kMip50Baud = 19200;

// One kind of instrument at one port. True: it is there.
struct Question {
  const char* scheme;
  bool scanner;
  std::function<bool(const std::string& port, RealClock& clock, const JobControl& job)> ask;
};

DeviceUrl urlOf(const char* scheme, const std::string& port) {
  DeviceUrl url;
  url.scheme = scheme;
  url.port = port;
  return url;
}

bool isLms(const std::string& port, RealClock& clock, const JobControl& job) {
  ChannelOpener opener(urlOf("lms2xx", port), 9600, clock);
  LmsSettings settings;
  settings.as_found = true;
  LmsScanner scanner([&opener] { return opener.open(); }, clock, settings);
  return scanner.connect(job.stop).has_value();
}

bool isHokuyo(const std::string& port, RealClock& clock, const JobControl& job) {
  const DeviceUrl url = urlOf("urg", port);
  ChannelOpener opener(url, 115200, clock);
  auto unit = scipUnit(
      url, [&opener] { return opener.open(); }, clock);
  return unit && (*unit)->identify(job);
}

bool isMip50(const std::string& port, RealClock& clock, const JobControl& job) {
  auto channel = ChannelOpener(urlOf("mip50", port), kMip50Baud, clock).open();
  if (!channel) return false;
  return Mip50Unit(std::move(*channel), clock, TiltDrive{}).identify(job).has_value();
}

bool isEpos(const std::string& port, RealClock& clock, const JobControl& job) {
  const DeviceUrl url = urlOf("epos", port);
  auto channel = ChannelOpener(url, 115200, clock).open();
  if (!channel) return false;
  auto unit = eposUnit(url, std::move(*channel), clock);
  return unit && (*unit)->identify(job);
}

const std::vector<Question>& questions() {
  // The tilt units answer fastest, and an LMS is looked for at every rate.
  static const std::vector<Question> list = {
      {"mip50", false, isMip50}, {"lms2xx", true, isLms}, {"epos", false, isEpos}, {"urg", true, isHokuyo}};
  return list;
}

}  // namespace

Result<DetectedInstruments> detectInstruments(std::vector<std::string> ports, const JobControl& job) {
  if (ports.empty())
    for (const PortInfo& port : listPorts()) ports.push_back(port.path);
  if (ports.empty())
    return fail("no serial port is plugged in", "",
                "connect the adapters and look again; an instrument in a network is named by its address");
  std::mutex mutex;
  DetectedInstruments found;
  std::stop_source enough;
  const std::stop_callback stopped(job.stop, [&enough] { enough.request_stop(); });
  job.tell(-1.0, "asking " + joined(ports, ", "));
  {
    std::vector<std::jthread> askers;
    for (const std::string& port : ports)
      askers.emplace_back([&, port] {
        RealClock clock;
        JobControl quiet;
        quiet.stop = enough.get_token();
        for (const Question& question : questions()) {
          if (enough.stop_requested()) return;
          {
            const std::lock_guard lock(mutex);
            if (!(question.scanner ? found.scanner : found.tilt).empty()) continue;
          }
          if (!question.ask(port, clock, quiet)) continue;
          const std::lock_guard lock(mutex);
          std::string& place = question.scanner ? found.scanner : found.tilt;
          if (place.empty()) {
            place = std::string(question.scheme) + ":" + port;
            job.tell(-1.0, "found " + place);
          }
          if (!found.scanner.empty() && !found.tilt.empty()) enough.request_stop();
          return;
        }
      });
  }
  if (!found.scanner.empty() && !found.tilt.empty()) return found;
  if (job.stopRequested()) return fail(kCancelled, "looking for instruments", "look again");
  const bool none = found.scanner.empty() && found.tilt.empty();
  return fail(none                    ? "neither a scanner nor a tilt unit answers"
              : found.scanner.empty() ? "a tilt unit is there (" + found.tilt + ") and no scanner"
                                      : "a scanner is there (" + found.scanner + ") and no tilt unit",
              joined(ports, ", "),
              "check supply and cables (a scanner takes up to a minute to start), that no other program uses "
              "the ports, and look again; or name them");
}

}  // namespace tiltmap
