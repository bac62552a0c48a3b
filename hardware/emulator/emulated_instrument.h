// What an emulated rig asks of its instruments, whatever make they are.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hardware/transport/byte_channel.h"

namespace tiltmap {

class EmulatedScanner : public Actor {
 public:
  // The wire it is plugged into; nullptr: none. The wire must outlive it or be replaced.
  virtual void plug(DeviceWire* wire) = 0;
  // Radians at an instant that has passed; level where there is none.
  virtual void setTilt(std::function<double(Instant)> tilt) = 0;
  // "dirty-window", "power-cut=2": what `fault` on a control line says; "none" ends all.
  virtual Status applyFault(const std::string& text) = 0;
  virtual std::vector<std::string> knownFaults() const = 0;
};

class EmulatedTilt : public Actor {
 public:
  // For another end of the wire, after a plug was pulled and put back.
  virtual void rewire(DeviceWire& wire) = 0;
  // Where the scanner looks, for any instant of the last few seconds; radians, positive up.
  virtual double angle(Instant at) const = 0;
  // Standing, settled, since then.
  virtual bool still(Instant at) const = 0;
  virtual Status applyFault(const std::string& text) = 0;
  virtual std::vector<std::string> knownFaults() const = 0;
};

}  // namespace tiltmap
