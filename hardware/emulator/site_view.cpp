#include "hardware/emulator/site_view.h"

#include <stdexcept>

namespace tiltmap {

SimulatedSiteView::SimulatedSiteView(std::shared_ptr<const Site> site, std::uint64_t seed,
                                     const LmsBeam& beam)
    : site_(std::move(site)), seed_(seed), beam_(beam) {
  if (!site_) throw std::invalid_argument("SimulatedSiteView: there is no site");
}

void SimulatedSiteView::moveTo(int stop, const Pose& site_from_scan) {
  stop_ = stop;
  site_from_scan_ = site_from_scan;
}

std::vector<Echo> SimulatedSiteView::line(const ScannerGeometry& geometry, const TiltFunction& tilt,
                                          double start_time_s, std::uint64_t key) {
  return castLine(*site_, site_from_scan_, geometry, tilt, start_time_s,
                  RandomStream::keyed({seed_, static_cast<std::uint64_t>(stop_), key}), beam_);
}

std::vector<Echo> RoundView::line(const ScannerGeometry& geometry, const TiltFunction&, double,
                                  std::uint64_t) {
  Echo echo;
  echo.range_m = range_m_;
  echo.code = cell_code::kMeasured;
  echo.intensity = 100.0F;
  return std::vector<Echo>(static_cast<std::size_t>(geometry.columns), echo);
}

}  // namespace tiltmap
