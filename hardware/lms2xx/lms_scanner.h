// Driver of the SICK LMS 2xx: finds it, sets it up, takes lines, and says what went wrong.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "hardware/lms2xx/lms_line.h"
#include "hardware/lms2xx/request_engine.h"

namespace tiltmap {

struct LmsSettings {
  int baud = 38400;                  // to work at; 9600, 19200, 38400 or 500000
  lms2xx::Variant variant{180, 50};  // 90/50 is taken by itself for types that know no other
  std::optional<lms2xx::Unit> unit;  // nothing: as the scanner is configured
  std::optional<bool> indices;       // real-time indices in each scan; nothing: as configured
  std::optional<lms2xx::MeasuringMode> measuring_mode;
  std::string password = std::string(lms2xx::kFactoryPassword);
  // How much later than on the wire a byte may be seen (USB adapters hold bytes back).
  double latency_s = 0.020;
  // A single request gives the next scan to be complete, which may have begun before it. A unit that is found
  // to answer with an older one needs more here.
  int polled_scans_old = 1;
  // Look and leave everything as it is: rate, variant and configuration.
  bool as_found = false;
};

// What connecting found.
struct LmsReport {
  lms2xx::UnitType type;
  lms2xx::UnitStatus status;
  lms2xx::Configuration configuration;
  int found_at_baud = 0;
  int baud = 0;
  std::string port;
  std::vector<std::string> warnings;
};

enum class LmsStream { Scans, Partials, Reflectivity };
enum class LmsState { Disconnected, Ready, Streaming, Lost };

// Blocking calls of one thread; each ends within its limit or soon after a stop. After a failure state()
// tells whether the next call may work (Ready) or the scanner must be connected anew (Lost): recover() does,
// however it came back: at 9600 after a power cut, or at a port of another name.
class LmsScanner {
 public:
  using Opener = std::function<Result<std::unique_ptr<ByteChannel>>()>;
  // The clock must outlive it. The opener is asked at each connecting, so that a port is looked for anew.
  LmsScanner(Opener opener, Clock& clock, LmsSettings settings = {});
  ~LmsScanner();

  // Searches for it at every rate, stops a stream that an earlier program left, reads type, status and
  // configuration, sets rate, variant and what else is wished. Two rounds before it gives up.
  Result<LmsReport> connect(const std::stop_token& stop = {});
  // connect() again and again, with pauses of 1 to 10 s, for so long.
  Result<LmsReport> recover(double patience_s, const std::stop_token& stop = {});
  void disconnect();

  LmsState state() const { return state_; }
  const LmsReport& report() const { return report_; }
  const lms2xx::Variant& variant() const { return report_.status.variant; }
  ScannerGeometry geometry() const { return geometryOf(variant()); }

  // One line, asked for. `measured` is called as soon as its measurement is over, while its bytes still come:
  // the tilt may move from then on. A line that arrives damaged after that is not asked for again by itself.
  Result<LmsLine> scan(const std::stop_token& stop = {}, const std::function<void(Instant)>& measured = {});
  Result<LmsLine> partialScan(const std::stop_token& stop = {});

  // Lines as the mirror turns. next() waits for one; a damaged one is left out and counted in lost_before of
  // the next.
  Status startStream(LmsStream kind = LmsStream::Scans, const std::stop_token& stop = {});
  Result<LmsLine> next(const std::stop_token& stop = {});
  Status stopStream(const std::stop_token& stop = {});
  // Seconds between lines of a stream at the present rate: scans go on being measured while one is sent.
  double streamPeriod(LmsStream kind = LmsStream::Scans) const;

  // Each stops a stream first.
  Result<lms2xx::UnitStatus> status(const std::stop_token& stop = {});
  Result<std::vector<lms2xx::StoredError>> storedErrors(const std::stop_token& stop = {});
  Status setVariant(const lms2xx::Variant& variant, const std::stop_token& stop = {});
  Status setBaud(int baud, const std::stop_token& stop = {});
  // Reads the configuration, changes it, and writes it only where a byte differs (the memory bears a few
  // thousand writes); the answer and its echo are compared with what was sent. True: it was written.
  Result<bool> configure(const std::function<void(lms2xx::Configuration&)>& change,
                         const std::stop_token& stop = {});
  // The rate after power-on: this one, or 9600. Only ever on the operator's explicit wish: a unit kept at
  // 500000 Bd is reached through RS-422 alone.
  Status setPermanentRate(bool keep_this, const std::stop_token& stop = {});

  struct Statistics {
    std::size_t lines = 0, lost_lines = 0, repeats = 0, noise_bytes = 0, damaged = 0;
  };
  Statistics statistics() const;

 private:
  using Engine = lms2xx::RequestEngine;
  Result<int> search(const std::stop_token& stop);
  Result<bool> answersAt(int baud, const std::stop_token& stop);
  Result<LmsReport> setUp(const std::stop_token& stop);
  Status applyConfiguration(const std::stop_token& stop);
  Result<lms2xx::Arrival> ask(const lms2xx::Request& request, const Engine::Limits& limits,
                              const std::stop_token& stop);
  tl::unexpected<Error> failed(const Engine::Reply& reply);
  tl::unexpected<Error> lost(Error error);
  Status mode(const lms2xx::Request& request, const std::string& what, const std::stop_token& stop);
  Status monitoring(const std::stop_token& stop);
  Status ready(const std::stop_token& stop);
  Result<lms2xx::Configuration> readConfiguration(const std::stop_token& stop);
  Result<LmsLine> polled(const lms2xx::Request& request, int turns, std::size_t size,
                         const std::stop_token& stop, const std::function<void(Instant)>& measured);
  Result<LmsLine> lineOf(const lms2xx::Arrival& arrival, int turns);
  std::size_t scanSize(LmsStream kind) const;

  Opener opener_;
  Clock& clock_;
  LmsSettings settings_;
  std::unique_ptr<ByteChannel> channel_;
  std::unique_ptr<Engine> engine_;
  LmsState state_ = LmsState::Disconnected;
  LmsReport report_;
  int last_baud_ = 0;
  LmsStream stream_ = LmsStream::Scans;
  std::optional<Instant> last_line_;
  std::optional<Byte> last_index_;
  Statistics past_;  // of channels that are gone
};

}  // namespace tiltmap
