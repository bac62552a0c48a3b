// Runs emulated instruments in real time, each at its pseudo terminal.
#pragma once

#include <mutex>
#include <thread>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

// Sleeps until bytes arrive or something is due, then lets the instruments act.
class EmulatorThread {
 public:
  struct Instrument {
    Actor* actor = nullptr;
    DeviceWire* wire = nullptr;  // may be none
  };
  // Nothing is owned; everything must outlive the thread.
  EmulatorThread(RealClock& clock, std::vector<Instrument> instruments);
  ~EmulatorThread();
  EmulatorThread(const EmulatorThread&) = delete;
  EmulatorThread& operator=(const EmulatorThread&) = delete;

  // While no instrument acts: for faults, stops, other wires.
  template <class Task>
  auto locked(Task&& task) {
    const std::lock_guard lock(mutex_);
    return task();
  }
  // Call inside of locked(): the instrument at `index` hangs on another wire from now on.
  void setWire(std::size_t index, DeviceWire* wire) { instruments_[index].wire = wire; }

 private:
  void run(const std::stop_token& stop);
  RealClock& clock_;
  std::mutex mutex_;
  std::vector<Instrument> instruments_;
  std::jthread thread_;
};

}  // namespace tiltmap
