// Faults ordered of emulated instruments while a driver talks to them. For the files of CaptureStation alone.
#pragma once

#include <algorithm>
#include <mutex>
#include <string>
#include <vector>

#include "hardware/capture/capture_station.h"

namespace tiltmap {

// Where time is virtual, emulators run on the thread of who waits: what is ordered happens there.
class CaptureStation::FaultActor : public Actor {
 public:
  explicit FaultActor(EmulatedBench& bench)
      : bench_(bench), clock_(dynamic_cast<VirtualClock*>(&bench.clock())) {
    if (clock_) clock_->attach(*this);
    names_ = bench.rig().faultNames();
    if (clock_)
      names_.emplace_back("unplug");
    else
      names_.insert(names_.end(), {"unplug-scanner", "unplug-tilt"});
  }
  ~FaultActor() override {
    if (clock_) clock_->detach(*this);
  }
  FaultActor(const FaultActor&) = delete;
  FaultActor& operator=(const FaultActor&) = delete;

  const std::vector<std::string>& names() const { return names_; }

  Status order(const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    const auto known = [&name](const std::string& other) { return other.substr(0, other.find('=')) == name; };
    if (std::ranges::none_of(names_, known))
      return fail("the emulator knows no fault `" + word + "`", "", "choose one of the list");
    if (!clock_) return bench_.fault(word);
    const std::lock_guard lock(mutex_);
    ordered_.push_back(word);
    return {};
  }

  Instant nextEvent() const override {
    const std::lock_guard lock(mutex_);
    return ordered_.empty() ? kNever : clock_->now();
  }
  void act(Instant) override {
    std::vector<std::string> now;
    {
      const std::lock_guard lock(mutex_);
      now.swap(ordered_);
    }
    for (const std::string& word : now)
      if (word == "unplug")
        bench_.unplug();
      else
        (void)bench_.fault(word);
  }

 private:
  EmulatedBench& bench_;
  VirtualClock* clock_;
  std::vector<std::string> names_;
  mutable std::mutex mutex_;
  std::vector<std::string> ordered_;
};

}  // namespace tiltmap
