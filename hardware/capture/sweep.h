// One stop's lines: each measured while the tilt stands still, or all while it moves on steadily.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <vector>

#include "core/project/project.h"
#include "core/scan/scanner_geometry.h"
#include "hardware/capture/scanner_unit.h"
#include "hardware/tilt/tilt_unit.h"

namespace tiltmap {

// How the instruments are reached, again and again where they get lost.
struct Instruments {
  Clock* clock = nullptr;
  std::function<Result<std::unique_ptr<ScannerUnit>>()> open_scanner;
  std::function<Result<std::unique_ptr<TiltUnit>>()> open_tilt;
};

struct SweepOptions {
  // The tilt moves on at one speed and every beam gets the tilt of its own instant. Lines are stored once the
  // tilt has told that it ended when and where it should have: until then their angles are not certain.
  bool steady = false;
  // What fails is tried again; so long after the first failure without a new line, and the sweep gives up.
  double patience_s = 60.0;
  double first_pause_s = 1.0, longest_pause_s = 10.0;  // between tries to reach an instrument
  double silence_s = 3.0;                              // a scanner that sends nothing for so long is lost
};

struct SweepReport {
  int taken = 0;       // lines of this sweep
  int spoiled = 0;     // begun, and taken again
  int recoveries = 0;  // instruments found anew
  double duration_s =
      0.0;  // on the instruments' clock, from the first way to the first line on to the last byte
  double slowest_store_s = 0.0;  // real time, from a line's last byte until it was durable
  std::vector<std::string> warnings;
};

// What a sweep tells while it goes on, on its own thread; must return quickly. Each may be empty.
struct SweepEvents {
  // A line is about to be stored; `wished_rad` is where the tilt should have stood.
  std::function<void(int row, double wished_rad, const ScanLine& line)> line;
  std::function<void(int so_far)> spoiled;
  std::function<void(const Error& why)> lost;  // an instrument failed and is being looked for
  std::function<void(int so_far)> found;       // it is back
};

// Keeps the instruments between stops, so that home is searched once.
class Sweep {
 public:
  using Store = std::function<std::future<Status>(int row, ScanLine line)>;

  Sweep(Instruments instruments, SweepOptions settings);
  ~Sweep();
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;

  const SweepOptions& settings() const { return settings_; }
  // Between sweeps.
  void setSettings(const SweepOptions& settings) { settings_ = settings; }

  // Scanner and tilt found and ready: what the geometry's columns and azimuths must be is known afterwards.
  Status prepare(const JobControl& job);
  ScannerGeometry geometry(int lines, double start_rad, double step_rad) const;
  // Whether the tilt may go to every line of it. Asked before anything is stored or moves.
  Status check(const ScannerGeometry& geometry) const;

  // Takes every row of the geometry that `taken` does not have, in one sweep upwards and, for rows that were
  // spoiled, further ones. A steady one goes back below the first row at its end. When it returns,
  // successfully or not, every line handed to `store` has been stored or has failed to be. Cancelling stops
  // the tilt within 200 ms.
  Result<SweepReport> run(const ScannerGeometry& geometry, std::vector<bool> taken, const Store& store,
                          const JobControl& job, const SweepEvents& events = {});
  // The instruments between sweeps, for who moves the tilt and looks at lines himself; null while they are
  // not open.
  ScannerUnit* scanner() { return scanner_.get(); }
  TiltUnit* tilt() { return tilt_.get(); }
  // Lets both instruments go and finds them anew, with growing pauses (pause_s, 0 at first), until that works
  // or patience has ended, counted from `since`. `meanwhile` is called during the pauses and ends it by
  // failing.
  Status findAgain(const Error& why, const JobControl& job, Instant since, double& pause_s,
                   const std::function<Status()>& meanwhile = {});
  // Puts the instruments to rest.
  Status release();
  // Of both instruments, "LMS291;S05 at /dev/ttyUSB0, MIP 50 at ...".
  std::string instrumentNames() const;

 private:
  struct Run;
  struct SteadyPass;
  Status look(Run& run);
  Status aimAtNext(Run& run);
  Status happened(Run& run, const ScannerEvent& event);
  Status spoiled(Run& run);
  Status silent(const Run& run) const;
  SteadyPass steadyPass(const ScannerGeometry& geometry, int first, int last) const;
  Status checkSteady(const ScannerGeometry& geometry) const;
  Status passSteadily(Run& run);
  Status watch(Run& run, SteadyPass& pass, const std::function<bool()>& done);
  Status goBelow(Run& run, SteadyPass& pass);
  Status storeSteady(Run& run, const SteadyPass& pass);
  void park(const ScannerGeometry& geometry);
  Status recover(const Error& why, Run& run);
  void noteWarnings(std::vector<std::string>& warnings);

  Instruments instruments_;
  SweepOptions settings_;
  std::unique_ptr<ScannerUnit> scanner_;
  std::unique_ptr<TiltUnit> tilt_;
};

}  // namespace tiltmap
