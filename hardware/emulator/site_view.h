// What an emulated scanner looks at.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/pose.h"
#include "core/scan/scanner_geometry.h"
#include "core/world/simulated_scanner.h"

namespace tiltmap {

class SiteView {
 public:
  virtual ~SiteView() = default;
  // One line: an echo per column of `geometry`, each beam cast at the tilt of its own instant (`tilt` takes
  // seconds on the clock of start_time_s; beamDelay() says when a beam is fired). `key` tells lines apart:
  // equal arguments, equal echoes.
  virtual std::vector<Echo> line(const ScannerGeometry& geometry, const TiltFunction& tilt,
                                 double start_time_s, std::uint64_t key) = 0;
};

// The simulated site, seen from one stop of a drive.
class SimulatedSiteView : public SiteView {
 public:
  SimulatedSiteView(std::shared_ptr<const Site> site, std::uint64_t seed, const LmsBeam& beam = {});
  // The scanner stands there from now on. `stop` changes the noise, as simulating that stop would.
  void moveTo(int stop, const Pose& site_from_scan);
  int stop() const { return stop_; }
  std::vector<Echo> line(const ScannerGeometry& geometry, const TiltFunction& tilt, double start_time_s,
                         std::uint64_t key) override;

 private:
  std::shared_ptr<const Site> site_;
  std::uint64_t seed_;
  LmsBeam beam_;
  int stop_ = 0;
  Pose site_from_scan_;
};

// A wall all around at the same distance, for measurements of time alone.
class RoundView : public SiteView {
 public:
  explicit RoundView(float range_m = 5.0F) : range_m_(range_m) {}
  std::vector<Echo> line(const ScannerGeometry& geometry, const TiltFunction& tilt, double start_time_s,
                         std::uint64_t key) override;

 private:
  float range_m_;
};

}  // namespace tiltmap
