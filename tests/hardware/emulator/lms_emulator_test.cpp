// The emulated scanner as a stranger's program meets it: bytes written by hand, bytes and times read.
#include "hardware/emulator/lms_emulator.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "hardware/emulator/emulator_thread.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/transport/memory_channel.h"
#include "hardware/transport/pseudo_terminal.h"
#include "hardware/transport/serial_port.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

constexpr const char* kStatus = "02 00 01 00 31 15 12";
constexpr const char* kScan = "02 00 02 00 30 01 31 18";
constexpr const char* kModeDone = "02 80 03 00 A0 00 10 16 0A";
constexpr const char* kRefused = "02 80 02 00 92 10 7F 33";

// Collects what comes, with the time of each byte.
struct Wire {
  explicit Wire(LmsEmulatorSettings settings = {}) : emulator(clock, view, std::move(settings)) {
    emulator.plug(pair.device.get());
    clock.attach(emulator);
  }
  ~Wire() { clock.detach(emulator); }
  void send(const std::string& text) { ASSERT_TRUE(pair.host->write(parseHex(text).value())); }
  void sendEnded() { clock.sleepFor(pair.host->line().wireTime(1)); }
  // All bytes of so many seconds.
  std::string hear(double seconds) {
    ByteVector all;
    times.clear();
    const Instant end = clock.now() + durationOf(seconds);
    std::array<Byte, 1> buffer;
    while (const auto count = pair.host->read(buffer, end).value()) {
      all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
      times.push_back(secondsOf(clock.now() - Instant{}));
    }
    return hexText(all);
  }
  std::string ask(const std::string& text, double seconds = 1.0) {
    send(text);
    return hear(seconds);
  }
  void rate(int baud) { ASSERT_TRUE(pair.host->setLine({baud})); }

  VirtualClock clock;
  RoundView view;
  MemoryPair pair = MemoryPair::make(clock);
  LmsEmulator emulator;
  std::vector<double> times;
};

TEST(LmsEmulator, AnswersAsPrinted) {
  LmsEmulatorSettings settings;
  settings.type = "LMS200;301063;V02.10 ";
  settings.answer_s = 0.01;
  Wire wire(settings);
  EXPECT_EQ(wire.ask("02 00 01 00 3A 1E 12"),
            "06 02 80 17 00 BA 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 22 61");
  EXPECT_EQ(wire.ask("02 00 02 00 20 25 35 08"), std::string("06 ") + kModeDone);
  EXPECT_EQ(wire.ask("02 00 05 00 3B B4 00 32 00 3B 1F"), "06 02 80 07 00 BB 01 B4 00 32 00 10 03 9D");
  EXPECT_EQ(wire.ask("02 00 01 00 32 16 12"), "06 02 80 02 00 B2 10 3F 13");
  EXPECT_EQ(wire.ask("02 00 01 00 74 50 12"),
            "06 02 80 24 00 F4 00 00 46 00 00 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 0A 0A "
            "50 64 00 00 00 00 02 00 10 AA 4F");
  EXPECT_EQ(wire.ask("02 00 0A 00 20 30 53 49 43 4B 5F 4C 4D 53 EE F5"), std::string("06 ") + kModeDone)
      << "testing the password changes no mode";
  EXPECT_EQ(wire.emulator.mode(), lms2xx::mode::kOnRequest);
  const std::string scan = wire.ask(kScan, 2.0);
  EXPECT_TRUE(scan.starts_with("06 02 80 D6 02 B0 69 01 F4 01")) << scan.substr(0, 40);
  EXPECT_TRUE(scan.ends_with("F4 01 F4 01 10 C4 59"));
  EXPECT_EQ(wire.ask("02 00 01 00 10 34 12").substr(0, 29), "06 02 80 02 00 91 10 79 30")
      << "and after booting it tells so";
  EXPECT_EQ(wire.hear(10.0),
            "02 80 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 63 5E");
}

TEST(LmsEmulator, TheStatusTelegramAsComputedByHand) {
  Wire wire;
  const std::string status = wire.ask(kStatus, 2.0);
  EXPECT_TRUE(status.starts_with("06 02 80 9A 00 B1 56 30 32 2E 33 30 20 25 00")) << status;
  EXPECT_EQ(wire.times.size(), 161U);
}

TEST(LmsEmulator, RefusesWhatTheListingRefuses) {
  Wire wire;
  const std::string refused = std::string("06 ") + kRefused;
  // Outside of the installation mode.
  EXPECT_EQ(wire.ask("02 00 02 00 66 01 9D 4E"), refused);
  EXPECT_EQ(wire.ask("02 00 23 00 77 00 00 46 00 00 00 00 00 00 02 02 02 00 00 0A 0A 50 64 00 0A 0A 50 64 00 "
                     "0A 0A 50 64 00 00 00 00 02 00 5A D2"),
            refused);
  // Commands that it does not know, or its type does not.
  EXPECT_EQ(wire.ask("02 00 05 00 44 01 00 B5 00 68 37"), refused);
  EXPECT_EQ(wire.ask("02 00 06 00 20 50 01 00 B5 00 68 B6"), refused);
  // A wrong password.
  EXPECT_EQ(wire.ask("02 00 0A 00 20 00 53 49 43 B4 5F 4C 4D 53 5F B2"), "06 02 80 03 00 A0 01 10 14 0B");
  // A configuration of another length: rejected with what stays in force. Many programs take that for
  // success.
  EXPECT_EQ(wire.ask("02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"), std::string("06 ") + kModeDone);
  EXPECT_TRUE(
      wire.ask("02 00 21 00 77 00 00 00 00 00 00 01 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 "
               "00 00 00 00 00 00 00 00 FC 7E")
          .starts_with("06 02 80 25 00 F7 00 00 00 46"));
  EXPECT_EQ(wire.ask(kScan), refused) << "no measuring in the installation mode";
  EXPECT_EQ(wire.ask("02 00 02 00 66 01 9D 4E"), "06 02 80 03 00 E6 01 10 0C 86");
}

TEST(LmsEmulator, IsSilentOrSaysNakWhereARealOneDoes) {
  Wire wire;
  EXPECT_EQ(wire.ask("02 00 01 00 31 15 13"), "15") << "wrong checksum";
  EXPECT_EQ(wire.ask("02 01 01 00 31 1D 16"), "") << "another unit";
  EXPECT_EQ(wire.ask("02 00 01 00 3A"), "") << "half a request";
  EXPECT_NE(wire.ask(kStatus), "") << "which is forgotten after a pause";
  wire.send("02 00 01");
  wire.clock.sleepFor(wire.pair.host->line().wireTime(3) + 7ms);
  EXPECT_EQ(wire.ask("00 31 15 12"), "") << "a pause of more than 6 ms inside a request";
  wire.send("02 00 01");
  wire.clock.sleepFor(wire.pair.host->line().wireTime(3) + 4ms);
  EXPECT_NE(wire.ask("00 31 15 12"), "") << "a shorter one is allowed";
  wire.rate(19200);
  EXPECT_EQ(wire.ask(kStatus), "") << "at another rate";
  wire.rate(9600);
  EXPECT_NE(wire.ask(kStatus), "");
  wire.emulator.cutPower(1h);
  EXPECT_EQ(wire.ask(kStatus), "");
}

TEST(LmsEmulator, BytesTakeTheTimeOfTheRate) {
  Wire wire;
  wire.ask(kScan, 2.0);
  ASSERT_EQ(wire.times.size(), 733U);
  const double byte = 10.0 / 9600;
  for (std::size_t i = 2; i < wire.times.size(); ++i)
    EXPECT_NEAR(wire.times[i] - wire.times[i - 1], byte, 1e-6);
  EXPECT_LT(wire.times[0], 8 * byte + 0.060 + byte) << "acknowledged within 60 ms";
  EXPECT_LT(wire.times[1], 8 * byte + 0.060 + 2 * byte) << "and the scan begins within 60";
}

TEST(LmsEmulator, ChangesTheRateAfterTheAnswer) {
  Wire wire;
  EXPECT_EQ(wire.ask("02 00 02 00 20 40 50 08"), std::string("06 ") + kModeDone) << "at the old rate";
  EXPECT_EQ(wire.emulator.baud(), 38400);
  EXPECT_EQ(wire.ask(kStatus), "");
  wire.rate(38400);
  EXPECT_NE(wire.ask(kStatus), "");
  wire.emulator.cutPower(1s);
  wire.clock.sleepFor(10s);
  wire.hear(0.1);
  EXPECT_EQ(wire.ask(kStatus), "") << "9600 again";
  EXPECT_EQ(wire.emulator.baud(), 9600);
}

TEST(LmsEmulator, ARequestCutsWhatIsBeingSent) {
  Wire wire;
  EXPECT_TRUE(wire.ask("02 00 02 00 20 24 34 08", 0.1).starts_with(std::string("06 ") + kModeDone));
  wire.hear(0.5);  // in the middle of a scan
  const std::string rest = wire.ask("02 00 02 00 20 25 35 08", 1.0);
  EXPECT_TRUE(rest.ends_with(std::string("06 ") + kModeDone)) << rest;
  EXPECT_LT(rest.size(), 3U * 300U);
  EXPECT_EQ(wire.hear(2.0), "") << "the stream has ended";
}

TEST(LmsEmulator, AVariantEndsAStream) {
  Wire wire;
  wire.ask("02 00 02 00 20 24 34 08", 0.1);
  EXPECT_TRUE(wire.ask("02 00 05 00 3B 64 00 19 00 E7 72", 1.0).find("BB 01 64 00 19 00") !=
              std::string::npos);
  EXPECT_EQ(wire.hear(2.0), "");
  EXPECT_TRUE(wire.ask(kScan, 2.0).starts_with("06 02 80 26 03 B0 91 01"));
}

TEST(LmsEmulator, LooksAtTheSiteAtTheTiltOfEachInstant) {
  // A beam straight ahead meets the floor where it looks down and the wall where it does not.
  VirtualClock clock;
  LmsBeam quiet;
  quiet.noise_m = 0.0;
  const Ground floor([](double, double) { return 0.0; }, {-20.0, -20.0}, {20.0, 20.0});
  const Hull wall = Hull::box(Eigen::Isometry3d::Identity(), {-10.0, 6.0, 0.0}, {10.0, 7.0, 5.0}, 0.6);
  SimulatedSiteView view(std::make_shared<Site>(floor, std::vector<Shape>{wall}), 3, quiet);
  view.moveTo(0, Pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}));
  LmsEmulator emulator(clock, view);
  MemoryPair pair = MemoryPair::make(clock);
  emulator.plug(pair.device.get());
  clock.attach(emulator);
  double tilt = 0.0;
  emulator.setTilt([&tilt](Instant) { return tilt; });
  std::vector<float> ahead;
  emulator.onScan([&](const LmsEmulator::SentScan& scan) { ahead.push_back(scan.echoes[180].range_m); });
  for (const double degrees : {0.0, -45.0, 0.0}) {
    tilt = degrees * kDegree;
    ASSERT_TRUE(pair.host->write(parseHex(kScan).value()));
    clock.sleepFor(2s);
  }
  clock.detach(emulator);
  ASSERT_EQ(ahead.size(), 3U);
  EXPECT_NEAR(ahead[1], std::sqrt(2.0), 0.06) << "the floor, a metre below";
  EXPECT_NEAR(ahead[0], 6.0, 0.02) << "the wall";
  EXPECT_NEAR(ahead[2], 6.0, 0.02);
}

TEST(LmsEmulator, RealPortPseudoTerminalAndDriverTogether) {
  RealClock clock(4.0);
  auto terminal = PseudoTerminal::open(clock);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  RoundView view;
  LmsEmulator emulator(clock, view);
  emulator.plug(terminal->get());
  EmulatorThread thread(clock, {{&emulator, terminal->get()}});
  LmsSettings settings;
  settings.baud = 500000;
  LmsScanner scanner(
      [&]() -> Result<std::unique_ptr<ByteChannel>> {
        auto port = SerialPort::open((*terminal)->name(), {9600}, clock);
        if (!port) return fail(port.error());
        return std::move(*port);
      },
      clock, settings);
  const auto report = scanner.recover(120.0);
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(report->found_at_baud, 9600);
  EXPECT_EQ(report->baud, 500000);
  const auto line = scanner.scan();
  ASSERT_TRUE(line) << line.error().what;
  EXPECT_EQ(line->range_m, std::vector<float>(361, 5.0F));
  ASSERT_TRUE(scanner.startStream());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(scanner.next());
  EXPECT_TRUE(scanner.stopStream());
}

}  // namespace
}  // namespace tiltmap
