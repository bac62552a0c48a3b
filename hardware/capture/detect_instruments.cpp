#include "hardware/capture/detect_instruments.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>

#include "core/base/text.h"
#include "hardware/capture/instruments.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/tilt/mip50_unit.h"
#include "hardware/transport/channel_opener.h"
#include "hardware/transport/serial_port.h"
#include "hardware/transport/tcp_channel.h"

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

bool answersAsHokuyo(const DeviceUrl& url, const ScipScannerUnit::Opener& open, RealClock& clock,
                     const JobControl& job) {
  auto unit = scipUnit(url, open, clock);
  return unit && (*unit)->identify(job);
}

bool isHokuyo(const std::string& port, RealClock& clock, const JobControl& job) {
  const DeviceUrl url = urlOf("urg", port);
  ChannelOpener opener(url, 115200, clock);
  return answersAsHokuyo(
      url, [&opener] { return opener.open(); }, clock, job);
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

// Scanners at an address in a network.

constexpr double kAttemptS = 0.15;  // for a connection: who is in reach accepts within milliseconds
constexpr int kAttempts = 20;       // over a bad radio link
constexpr double kAnswerS = 3.0;    // one that is starting is found by looking again

// Short attempts, so that the stop token is looked at between them. An address that refuses is not asked
// again.
Result<std::unique_ptr<ByteChannel>> openWithin(const TcpAddress& address, RealClock& clock,
                                                const JobControl& job) {
  Error last{"nobody accepted", address.text(), "check supply and cable"};
  for (int attempt = 0; attempt < kAttempts && !job.stopRequested(); ++attempt) {
    const auto began = std::chrono::steady_clock::now();
    auto channel = TcpChannel::connect(address, clock, kAttemptS);
    if (channel) return std::unique_ptr<ByteChannel>(std::move(*channel));
    last = channel.error();
    if (std::chrono::steady_clock::now() - began < durationOf(kAttemptS)) break;
  }
  return fail(last);
}

// SCHEME:PORT of the scanner that answers, empty where none does.
std::string scannerAt(const std::string& network, RealClock& clock, const JobControl& job) {
  for (const char* scheme : {"lms1xx", "urg"}) {
    const auto known = std::ranges::find(scannerSchemes(), scheme, &DeviceScheme::name);
    const auto address = parseTcpAddress(network, std::max(known->tcp_port, known->usual_port));
    if (!address || job.stopRequested()) return {};
    const bool in_network_only = known->tcp_port != 0;
    DeviceUrl url = urlOf(scheme, (in_network_only ? "" : "tcp:") + network);
    url.tcp_port = known->tcp_port;
    url.usual_port = known->usual_port;
    const auto open = [&] { return openWithin(*address, clock, job); };
    if (in_network_only) {
      ColaSettings settings;
      settings.boot_s = kAnswerS;
      if (ColaScannerUnit(open, clock, settings).identify(job)) return url.text();
    } else if (answersAsHokuyo(url, open, clock, job)) {
      return url.text();
    }
  }
  return {};
}

// What has been found so far, by several who ask at the same time.
class Findings {
 public:
  explicit Findings(const JobControl& job)
      : job_(job), stopped_(job.stop, [this] { enough_.request_stop(); }) {}

  bool enough() const { return enough_.stop_requested(); }
  JobControl control() const {
    JobControl quiet;
    quiet.stop = enough_.get_token();
    return quiet;
  }
  bool has(bool scanner) {
    const std::lock_guard lock(mutex_);
    return !(scanner ? found_.scanner : found_.tilt).empty();
  }
  void add(bool scanner, const std::string& url) {
    const std::lock_guard lock(mutex_);
    std::string& place = scanner ? found_.scanner : found_.tilt;
    if (place.empty()) {
      place = url;
      job_.tell(-1.0, "found " + place);
    }
    if (!found_.scanner.empty() && !found_.tilt.empty()) enough_.request_stop();
  }
  const DetectedInstruments& found() const { return found_; }

 private:
  const JobControl& job_;
  std::mutex mutex_;
  DetectedInstruments found_;
  std::stop_source enough_;
  std::stop_callback<std::function<void()>> stopped_;
};

void askPort(const std::string& port, Findings& findings) {
  RealClock clock;
  for (const Question& question : questions()) {
    if (findings.enough()) return;
    if (findings.has(question.scanner) || !question.ask(port, clock, findings.control())) continue;
    return findings.add(question.scanner, std::string(question.scheme) + ":" + port);
  }
}

}  // namespace

Result<DetectedInstruments> detectInstruments(DetectionPlaces places, const JobControl& job) {
  std::vector<std::string>& ports = places.ports;
  if (ports.empty())
    for (const PortInfo& port : listPorts()) ports.push_back(port.path);
  if (!places.network.empty())
    if (const auto address = parseTcpAddress(places.network, 1); !address) return fail(address.error());
  std::vector<std::string> asked = ports;
  if (!places.network.empty()) asked.push_back(places.network);
  if (asked.empty())
    return fail("no serial port is plugged in", "",
                "connect the adapters and look again; an instrument in a network is named by its address");
  job.tell(-1.0, "asking " + joined(asked, ", "));
  Findings findings(job);
  {
    std::vector<std::jthread> askers;
    for (const std::string& port : ports) askers.emplace_back([&] { askPort(port, findings); });
    if (!places.network.empty())
      askers.emplace_back([&] {
        RealClock clock;
        const std::string url = scannerAt(places.network, clock, findings.control());
        if (!url.empty()) findings.add(true, url);
      });
  }
  const DetectedInstruments& found = findings.found();
  if (!found.scanner.empty() && !found.tilt.empty()) return found;
  if (job.stopRequested()) return fail(kCancelled, "looking for instruments", "look again");
  const bool none = found.scanner.empty() && found.tilt.empty();
  return fail(none                    ? "neither a scanner nor a tilt unit answers"
              : found.scanner.empty() ? "a tilt unit is there (" + found.tilt + ") and no scanner"
                                      : "a scanner is there (" + found.scanner + ") and no tilt unit",
              joined(asked, ", "),
              "check supply and cables (a scanner takes up to a minute to start), that no other program uses "
              "the ports, and look again; or name them");
}

}  // namespace tiltmap
