// The instruments that a capture was asked for, real or emulated, and the clock that they live by.
#pragma once

#include <memory>
#include <optional>

#include "hardware/capture/capture_plan.h"
#include "hardware/capture/instruments.h"

namespace tiltmap {

// Whether the instruments are recordings.
bool replays(const CaptureSettings& settings);

class CaptureBench {
 public:
  // Of an emulated drive the first `stops` are there. Opens no real instrument yet; `ask` as for
  // makeCaptureOperation().
  static Result<std::unique_ptr<CaptureBench>> open(const CaptureSettings& settings, int stops,
                                                    const AskOperator& ask);

  Clock& clock();
  Instruments instruments() const { return instruments_; }
  // Recordings at their own pace, which is not that of the machine.
  bool replays() const { return replay_clock_ != nullptr; }
  // Nothing of real instruments.
  const std::optional<Experiment>& experiment() const { return experiment_; }
  EmulatedBench* emulated() { return emulated_.get(); }

 private:
  std::unique_ptr<RealClock> clock_;
  std::unique_ptr<VirtualClock> replay_clock_;
  std::optional<Experiment> experiment_;
  std::unique_ptr<EmulatedBench> emulated_;
  Instruments instruments_;
};

}  // namespace tiltmap
