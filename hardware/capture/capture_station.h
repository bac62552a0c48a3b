// The instruments of a rig kept open on a thread of their own: driven by commands, read through snapshots.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hardware/capture/capture_run.h"

namespace tiltmap {

enum class StationState {
  Idle,          // not connected
  Connecting,    // looking for the instruments, homing the tilt
  Ready,         // both are there and stand still
  Moving,        // the tilt moves
  Scanning,      // a sweep
  Reconnecting,  // an instrument got lost, in a sweep or between sweeps, and is looked for
  Fault,         // it was not found again, or could not be connected
  Verdict        // as Ready, after a sweep of which every line has been stored
};

// One line as it was seen. Immutable.
struct StationLine {
  int row = -1;  // of the sweep; -1: between sweeps
  double tilt_rad = 0.0;
  std::vector<float> range_m;
  std::vector<CellCode> code;
};
using StationLinePtr = std::shared_ptr<const StationLine>;

struct StationInstrument {
  std::string name;  // empty: not there
  std::vector<InstrumentFact> facts;
};

// The sweep under way, or the last one.
struct StationSweep {
  int number = 0;  // counts sweeps; 0: there was none
  ScanId scan = 0;
  ScannerGeometry geometry;
  int rows_taken = 0;                     // those of an interrupted one included
  int retries = 0;                        // lines that were damaged and are taken again
  int recoveries = 0;                     // instruments found again
  std::size_t cells = 0, dead_cells = 0;  // of the lines of this sweep; dead: without a point
  // Read back minus wished, of the last line; nothing of lines that are taken while the tilt moves on.
  std::optional<double> tilt_error_rad;
  double worst_tilt_error_rad = 0.0;  // largest magnitude
  double elapsed_s = 0.0;             // real time
  std::optional<double> left_s;       // once enough lines are there to tell
  bool complete = false;
};

struct StationSnapshot {
  StationState state = StationState::Idle;
  std::string doing;           // "looking for the scanner"; may be empty
  std::optional<Error> error;  // of Fault and Reconnecting; else what the last command was refused for
  CaptureSettings source;      // what it is or was connected to
  bool replays = false;        // the source is a recorded session
  StationInstrument scanner, tilt;
  std::vector<std::string> warnings;
  bool live = true;  // lines between sweeps are told
  StationLinePtr line;
  std::size_t lines_seen = 0;
  int columns = 0;
  double azimuth_start_rad = 0.0, azimuth_step_rad = 0.0;
  std::optional<double> tilt_rad;    // where it stands; nothing while it moves or is not known
  std::optional<double> target_rad;  // of a move
  StationSweep sweep;
};

struct StationSettings {
  double patience_s = 60.0;        // an instrument lost between sweeps is looked for so long
  double park_rad = 0.0;           // level
  double look_s = 0.002;           // between two looks at the instruments
  std::vector<std::string> ports;  // where to look for instruments; empty: all that are plugged in
};

// Commands may be given by any thread; they return at once and are done one after the other. What cannot be
// done is told in the snapshot's error. stop() ends whatever goes on within 200 ms, drops what waits, and is
// accepted in every state; only a search for home under way goes on in the tilt unit itself.
class CaptureStation {
 public:
  // `changed` is called on the station's thread after each change of the snapshot; must return quickly.
  explicit CaptureStation(std::function<void()> changed = {}, StationSettings settings = {});
  // Stops and puts the instruments to rest.
  ~CaptureStation();
  CaptureStation(const CaptureStation&) = delete;
  CaptureStation& operator=(const CaptureStation&) = delete;

  StationSnapshot snapshot() const;
  // The lines of the present sweep that were not given before, in the order taken.
  std::vector<StationLinePtr> takeRows();

  // Named instruments, an emulated drive, or recordings ("lms2xx:replay:FILE"): those are opened by the sweep
  // that replays them, so that it finds every line where it was then.
  void connect(CaptureSettings source);
  // Goes over the ports, and asks at `network` where an address is given, and connects to the first scanner
  // and the first tilt unit; options of the tilt unit ("level=312525") cannot be found and are given.
  void connectToWhatIsThere(std::string tilt_options, std::string network = {});
  void reconnect();  // to the source of before
  void disconnect();
  void jogBy(double angle_rad);
  void jogTo(double angle_rad);
  void home();  // searched anew
  void park();
  void setLive(bool on);
  void stop();
  // Of the emulator: makes something go wrong, by the word that EmulatedRig::fault() knows or
  // "unplug-scanner", "unplug-tilt", "unplug".
  Status fault(const std::string& word);
  std::vector<std::string> faultNames() const;

  // A stop, captured with what is connected; returns when it is over. Not on the station's thread. `settings`
  // say lines, angles, mode and whether to resume; the rest is the source's.
  Result<OperationResult> capture(const SnapshotPtr& snapshot, const CaptureSettings& settings,
                                  std::optional<Pose> last_from_next, LiveProject& live,
                                  const JobControl& job);
  // Whether capture() could begin, as far as can be told without asking the instruments.
  Status checkCapture(const ProjectSnapshot& snapshot, const CaptureSettings& settings) const;

 private:
  struct Command {
    std::function<void(const std::stop_token&)> run;
    std::function<void()> dropped;
    std::stop_source stop{};
  };
  class FaultActor;

  void post(Command command);
  void run(const std::stop_token& end);
  void update(const std::function<void(StationSnapshot&)>& change);
  void setState(StationState state, std::string doing = {});
  void refuse(Error error);
  JobControl control(const std::stop_token& stop);
  CaptureSettings merged(const CaptureSettings& settings) const;

  // On the station's thread (capture_station_work.cpp).
  void connectNow(const CaptureSettings& source, const std::stop_token& stop);
  void detectNow(const std::string& tilt_options, const std::string& network, const std::stop_token& stop);
  void prepareNow(const std::stop_token& stop);
  void ready(StationState state = StationState::Ready);
  void putToRest(bool orderly);
  bool isReady();
  void moveNow(double angle_rad, const std::string& doing, const std::stop_token& stop);
  void homeNow(const std::stop_token& stop);
  bool standNow();
  void look();
  Status lookAtInstruments();
  void lost(const Error& error);
  void sleep();
  Result<OperationResult> captureNow(const SnapshotPtr& snapshot, const CaptureSettings& settings,
                                     const std::optional<Pose>& last_from_next, LiveProject& live,
                                     const JobControl& job);
  void afterFailure(const Error& why, bool replays);
  SweepEvents sweepEvents();
  void sweepBegins(ScanId scan, const ScannerGeometry& geometry, const std::vector<bool>& taken);
  void showInstruments();

  const std::function<void()> changed_;
  const StationSettings settings_;

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable_any wake_;
  std::deque<Command> waiting_;
  std::stop_source running_;  // of the command under way
  bool stop_wanted_ = false;
  StationSnapshot snapshot_;
  std::vector<StationLinePtr> rows_;
  mutable std::mutex bench_mutex_;  // whether there is a bench, for faults

  // Of the station's thread.
  std::unique_ptr<CaptureBench> bench_;
  std::unique_ptr<FaultActor> faults_;
  std::unique_ptr<Sweep> sweep_;
  bool listening_ = false;  // both instruments are open and are looked at
  bool moving_ = false;
  Instant last_heard_{};
  std::chrono::steady_clock::time_point sweep_began_{}, looked_{};

  std::jthread thread_;  // last
};

}  // namespace tiltmap
