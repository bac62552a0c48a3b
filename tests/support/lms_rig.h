// An LMS 2xx driver and an emulated scanner at the two ends of a wire, on a virtual clock.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hardware/emulator/lms_emulator.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/transport/memory_channel.h"

namespace tiltmap::test {

// Another picture for each line, so that no line can be taken for another one.
class NumberedView : public SiteView {
 public:
  std::vector<Echo> line(const ScannerGeometry& geometry, const TiltFunction& tilt, double start_time_s,
                         std::uint64_t key) override {
    std::vector<Echo> echoes(static_cast<std::size_t>(geometry.columns));
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const double t = tilt(start_time_s + beamDelay(geometry, {}, static_cast<int>(i)));
      const auto centimetres = (key * 37 + i * 11 + static_cast<std::uint64_t>(1000.0 * (t + 10.0))) % 8000;
      if (centimetres % 50 == 0) {
        echoes[i].code = static_cast<CellCode>(8183 + centimetres / 50 % 9);
      } else {
        echoes[i].code = cell_code::kMeasured;
        echoes[i].range_m = static_cast<float>(static_cast<double>(centimetres) * 0.01);
        echoes[i].intensity = static_cast<float>(centimetres % 256);
      }
    }
    return echoes;
  }
};

// The scanner hangs on a new wire each time the driver opens one.
struct LmsRig {
  explicit LmsRig(LmsEmulatorSettings emulator_settings = {}, LmsSettings settings = {})
      : emulator(clock, view, std::move(emulator_settings)),
        scanner([this] { return open(); }, clock, std::move(settings)) {
    clock.attach(emulator);
    emulator.onScan([this](const LmsEmulator::SentScan& scan) { sent.push_back(scan); });
  }
  ~LmsRig() {
    scanner.disconnect();
    clock.detach(emulator);
  }
  Result<std::unique_ptr<ByteChannel>> open() {
    if (!plugged_in) {
      const Error error{"there is no such port", port, "plug it in again"};
      if (refused) refused(error);
      return fail(error);
    }
    MemoryPair pair = MemoryPair::make(clock, port);
    device = std::move(pair.device);
    unplug = pair.unplug;
    emulator.plug(device.get());
    if (wrap) return wrap(std::move(pair.host));
    return std::unique_ptr<ByteChannel>(std::move(pair.host));
  }
  double seconds() const { return secondsOf(clock.now() - Instant{}); }

  VirtualClock clock;
  NumberedView view;
  std::unique_ptr<MemoryChannel> device;
  std::function<void()> unplug;
  std::function<std::unique_ptr<ByteChannel>(std::unique_ptr<ByteChannel>)> wrap;
  std::function<void(const Error&)> refused;
  std::string port = "port A";
  bool plugged_in = true;
  std::vector<LmsEmulator::SentScan> sent;
  LmsEmulator emulator;
  LmsScanner scanner;
};

inline void expectUseful(const Error& error, const std::string& mentions) {
  EXPECT_NE(error.what.find(mentions), std::string::npos) << error.what;
  EXPECT_FALSE(error.where.empty());
  EXPECT_GT(error.remedy.size(), 10U);
}

// Every line that came is one that was sent.
inline void expectTrue(const LmsLine& line, const LmsRig& rig) {
  EXPECT_TRUE(std::ranges::any_of(rig.sent, [&](const auto& sent) { return sent.measurement == line.raw; }));
}

}  // namespace tiltmap::test
