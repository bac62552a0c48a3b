// Scanners found by asking at an address in the network, with the tilt unit at a serial port.
#include "hardware/capture/detect_instruments.h"

#include <gtest/gtest.h>

#include "hardware/emulator/terminal_rig.h"
#include "hardware/transport/tcp_channel.h"

namespace tiltmap {
namespace {

struct Make {
  const char* scanner;
  const char* tilt;
};

class DetectInstruments : public ::testing::TestWithParam<Make> {};

TEST_P(DetectInstruments, FindsBothWhereverTheyAre) {
  RigSettings settings;
  ASSERT_TRUE(settings.chooseScanner(GetParam().scanner));
  ASSERT_TRUE(settings.chooseTilt(GetParam().tilt));
  RealClock clock;
  auto rig = TerminalRig::open(clock, *Experiment::make(ExperimentId::Exp1, 7), settings);
  ASSERT_TRUE(rig) << rig.error().what;
  DetectionPlaces places;
  places.ports = {(*rig)->tiltPort()};
  ASSERT_TRUE(settings.scannerOverNetwork());
  places.network = (*rig)->scannerPort();
  std::vector<std::string> told;
  JobControl job;
  job.report = [&](const Progress& progress) { told.push_back(progress.message); };
  const auto found = detectInstruments(places, job);
  ASSERT_TRUE(found) << found.error().what << " " << found.error().where;
  EXPECT_EQ(found->scanner, settings.scannerUrl((*rig)->scannerPort()));
  const std::string tilt = settings.tiltUrl((*rig)->tiltPort());
  EXPECT_EQ(found->tilt, tilt.substr(0, tilt.find('?')));
  EXPECT_NE(told.front().find((*rig)->scannerPort()), std::string::npos) << told.front();
}
INSTANTIATE_TEST_SUITE_P(Makes, DetectInstruments,
                         ::testing::Values(Make{"lms511", "epos"}, Make{"lms111", "mip50"},
                                           Make{"utm30lx-ew", "epos-v1"}),
                         [](const auto& test) {
                           std::string name = std::string(test.param.scanner) + "_" + test.param.tilt;
                           std::erase(name, '-');
                           return name;
                         });

TEST(DetectInstrumentsAtNothing, SaysWhatIsMissingAndWhereItLooked) {
  RealClock clock;
  auto rig = TerminalRig::open(clock, *Experiment::make(ExperimentId::Exp1, 7), {});
  ASSERT_TRUE(rig);
  // Somebody who accepts and never says a word, and an address that refuses.
  auto mute = TcpWire::listen(clock);
  ASSERT_TRUE(mute);
  for (const std::string& network : {(*mute)->name(), std::string("127.0.0.1:1")}) {
    const auto none = detectInstruments({{(*rig)->tiltPort()}, network}, {});
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().what.find("a tilt unit is there"), std::string::npos) << none.error().what;
    EXPECT_NE(none.error().where.find(network), std::string::npos) << none.error().where;
  }
  const auto wrong = detectInstruments({{(*rig)->tiltPort()}, "127.0.0.1:99999"}, {});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().where.find("99999"), std::string::npos) << wrong.error().where;
}

TEST(DetectInstrumentsAtNothing, EndsWhenItIsStopped) {
  RealClock clock;
  auto mute = TcpWire::listen(clock);
  ASSERT_TRUE(mute);
  std::stop_source stop;
  JobControl job;
  job.stop = stop.get_token();
  job.report = [&](const Progress&) { stop.request_stop(); };
  // A port that is none, so that nothing plugged into this machine is asked.
  const auto stopped = detectInstruments({{"/dev/none"}, (*mute)->name()}, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().what, kCancelled);
}

}  // namespace
}  // namespace tiltmap
