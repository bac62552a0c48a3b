// The driver against the emulated scanner: what an operator does with one that works.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/lms_rig.h"

namespace tiltmap {
namespace {

using namespace lms2xx;
using namespace std::chrono_literals;
using test::LmsRig;

void expectSame(const LmsLine& line, const LmsEmulator::SentScan& sent) {
  EXPECT_EQ(line.raw, sent.measurement);
  ASSERT_EQ(line.range_m.size(), sent.echoes.size());
  for (std::size_t i = 0; i < sent.echoes.size(); ++i) {
    ASSERT_EQ(line.code[i], sent.echoes[i].code) << i;
    ASSERT_NEAR(line.range_m[i], sent.echoes[i].range_m, 1e-4) << i;
  }
  EXPECT_LE(line.earliest_start, sent.measured_from) << "the promise that a capture relies on";
  EXPECT_GE(line.first_byte, sent.measured_to);
  EXPECT_GT(line.last_byte, line.first_byte);
}

TEST(LmsScanner, FindsItAtEveryRateAndWorksAtEveryRate) {
  for (const int there : {9600, 19200, 38400, 500000})
    for (const int wished : {9600, 19200, 38400, 500000}) {
      LmsEmulatorSettings emulator;
      emulator.baud = there;
      LmsSettings settings;
      settings.baud = wished;
      LmsRig rig(emulator, settings);
      const auto report = rig.scanner.connect();
      ASSERT_TRUE(report) << report.error().what;
      EXPECT_EQ(report->found_at_baud, there);
      EXPECT_EQ(report->baud, wished);
      EXPECT_EQ(rig.emulator.baud(), wished);
      EXPECT_EQ(report->type.model, "LMS291");
      EXPECT_EQ(report->type.variant, "S05");
      EXPECT_EQ(report->status.version, "V02.30");
      EXPECT_EQ(report->configuration, Configuration::factory());
      EXPECT_TRUE(report->warnings.empty());
      const auto line = rig.scanner.scan();
      ASSERT_TRUE(line) << line.error().what;
      expectSame(*line, rig.sent.back());
    }
}

TEST(LmsScanner, AddressAndStreamOfAnEarlierProgramDoNotDisturb) {
  LmsEmulatorSettings emulator;
  emulator.address = 1;
  emulator.baud = 38400;
  LmsRig rig(emulator);
  // Somebody left it streaming.
  {
    LmsScanner earlier([&rig] { return rig.open(); }, rig.clock);
    ASSERT_TRUE(earlier.connect());
    ASSERT_TRUE(earlier.startStream());
    rig.unplug();
  }
  EXPECT_EQ(rig.emulator.mode(), mode::kStream);
  ASSERT_TRUE(rig.scanner.connect());
  EXPECT_EQ(rig.emulator.mode(), mode::kOnRequest);
  EXPECT_TRUE(rig.scanner.scan());
}

TEST(LmsScanner, WaitsForOneThatIsStillBooting) {
  LmsEmulatorSettings emulator;
  emulator.booted = false;
  emulator.boot_s = 40.0;
  LmsRig rig(emulator);
  const auto report = rig.scanner.recover(90.0);
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_GT(rig.seconds(), 40.0);
  EXPECT_LT(rig.seconds(), 70.0);
}

TEST(LmsScanner, EveryVariant) {
  for (const Variant& variant :
       {Variant{180, 100}, Variant{180, 50}, Variant{100, 100}, Variant{100, 50}, Variant{100, 25}}) {
    LmsSettings settings;
    settings.variant = variant;
    LmsRig rig({}, settings);
    ASSERT_TRUE(rig.scanner.connect());
    EXPECT_EQ(rig.scanner.variant(), variant);
    const auto line = rig.scanner.scan();
    ASSERT_TRUE(line) << line.error().what;
    EXPECT_EQ(line->range_m.size(), static_cast<std::size_t>(variant.values()));
    expectSame(*line, rig.sent.back());
    const ScannerGeometry geometry = rig.scanner.geometry();
    EXPECT_EQ(geometry.columns, variant.values());
    EXPECT_NEAR(geometry.azimuthOfColumn(geometry.columns - 1) / kDegree, 90.0 + variant.angle_deg / 2.0,
                1e-9);
  }
}

TEST(LmsScanner, MillimetresIndicesAndMeasuringModeAreWrittenOnce) {
  LmsSettings settings;
  settings.unit = Unit::Millimetre;
  settings.indices = true;
  settings.measuring_mode = MeasuringMode::FieldsAb;
  LmsRig rig({}, settings);
  auto report = rig.scanner.connect();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(rig.emulator.configurationWrites(), 1);
  EXPECT_EQ(report->configuration.unit(), Unit::Millimetre);
  EXPECT_EQ(report->warnings.size(), 1U) << "an operator is told of what stays in the scanner";
  const auto line = rig.scanner.scan();
  ASSERT_TRUE(line) << line.error().what;
  EXPECT_EQ(line->raw.unit, Unit::Millimetre);
  ASSERT_TRUE(line->raw.indices);
  EXPECT_EQ(line->measuring_mode, MeasuringMode::FieldsAb);
  for (const float range : line->range_m) EXPECT_LE(range, 16.383F);
  report = rig.scanner.connect();
  ASSERT_TRUE(report);
  EXPECT_EQ(rig.emulator.configurationWrites(), 1) << "nothing differs, nothing is written";
  EXPECT_TRUE(report->warnings.empty());
}

TEST(LmsScanner, TheMeasurementIsOverWhenItSaysSo) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  for (int i = 0; i < 50; ++i) {
    rig.clock.sleepFor(Duration(1'234'567) * (i + 1));
    std::vector<Instant> told;
    const Instant before = rig.clock.now();
    const auto line = rig.scanner.scan({}, [&](Instant at) { told.push_back(at); });
    ASSERT_TRUE(line);
    const auto& sent = rig.sent.back();
    ASSERT_EQ(told.size(), 1U);
    EXPECT_GE(told[0], sent.measured_to);
    EXPECT_LT(secondsOf(told[0] - sent.measured_to), 0.005)
        << "at once: the rest of the wire's time is the tilt's";
    EXPECT_GT(secondsOf(line->last_byte - told[0]), 0.18);
    EXPECT_LT(secondsOf(told[0] - before), 0.060);
    expectSame(*line, sent);
  }
}

TEST(LmsScanner, AFreshOrAnOlderScanIsToldApart) {
  LmsEmulatorSettings emulator;
  emulator.fresh_on_request = true;
  LmsRig rig(emulator);
  ASSERT_TRUE(rig.scanner.connect());
  const Instant before = rig.clock.now();
  const auto line = rig.scanner.scan();
  ASSERT_TRUE(line);
  EXPECT_GE(rig.sent.back().measured_from, before);
  expectSame(*line, rig.sent.back());
}

TEST(LmsScanner, StreamsAtTheVendorsPeriods) {
  struct Row {
    int baud;
    Variant variant;
    LmsStream kind;
    double period;
  };
  for (const Row& row : std::vector<Row>{{9600, {180, 100}, LmsStream::Scans, 0.3996},
                                         {9600, {180, 50}, LmsStream::Scans, 0.77256},
                                         {19200, {180, 100}, LmsStream::Scans, 0.1998},
                                         {19200, {100, 25}, LmsStream::Scans, 0.42624},
                                         {38400, {180, 50}, LmsStream::Scans, 0.21312},
                                         {38400, {180, 100}, LmsStream::Partials, 0.10656},
                                         {500000, {180, 100}, LmsStream::Scans, 0.01332},
                                         {500000, {180, 50}, LmsStream::Scans, 0.02664},
                                         {500000, {100, 25}, LmsStream::Scans, 0.05328},
                                         {500000, {180, 50}, LmsStream::Partials, 0.01332}}) {
    LmsSettings settings;
    settings.baud = row.baud;
    settings.variant = row.variant;
    LmsRig rig({}, settings);
    ASSERT_TRUE(rig.scanner.connect());
    ASSERT_TRUE(rig.scanner.startStream(row.kind));
    EXPECT_NEAR(rig.scanner.streamPeriod(row.kind), row.period, 1e-9);
    const auto first = rig.scanner.next();
    ASSERT_TRUE(first) << first.error().what;
    const std::size_t count = rig.sent.size();
    Instant last = first->last_byte;
    for (int i = 0; i < 40; ++i) {
      const auto line = rig.scanner.next();
      ASSERT_TRUE(line) << line.error().what;
      // Partial scans are of two lengths.
      EXPECT_NEAR(secondsOf(line->last_byte - last), row.period,
                  row.kind == LmsStream::Partials ? 30.0 / row.baud : 1e-6);
      last = line->last_byte;
      EXPECT_EQ(line->lost_before, 0);
      EXPECT_EQ(line->raw, rig.sent[count + static_cast<std::size_t>(i)].measurement);
      EXPECT_LE(line->earliest_start, rig.sent[count + static_cast<std::size_t>(i)].measured_from);
    }
    ASSERT_TRUE(rig.scanner.stopStream());
    EXPECT_EQ(rig.scanner.state(), LmsState::Ready);
    EXPECT_EQ(rig.scanner.statistics().lost_lines, 0U);
    EXPECT_TRUE(rig.scanner.scan()) << "polled again";
  }
}

TEST(LmsScanner, AskingSomethingEndsAStreamFirst) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream());
  ASSERT_TRUE(rig.scanner.next());
  EXPECT_TRUE(rig.scanner.status());
  EXPECT_EQ(rig.scanner.state(), LmsState::Ready);
  EXPECT_EQ(rig.emulator.mode(), mode::kOnRequest);
  EXPECT_FALSE(rig.scanner.next()) << "no stream";
}

TEST(LmsScanner, PartialScansMakeAFinerLine) {
  LmsSettings settings;
  settings.baud = 500000;
  LmsRig rig({}, settings);
  ASSERT_TRUE(rig.scanner.connect());
  ASSERT_TRUE(rig.scanner.startStream(LmsStream::Partials));
  std::vector<LmsLine> four;
  while (four.size() < 4) {
    auto line = rig.scanner.next();
    ASSERT_TRUE(line) << line.error().what;
    four.push_back(std::move(*line));
  }
  const auto fine = interleaved(four);
  ASSERT_TRUE(fine) << fine.error().what;
  ASSERT_EQ(fine->range_m.size(), 721U);
  EXPECT_EQ(fine->variant.resolution_cdeg, 25);
  for (const LmsLine& partial : four)
    for (std::size_t i = 0; i < partial.range_m.size(); ++i)
      ASSERT_EQ(fine->range_m[4 * i + static_cast<std::size_t>(*partial.raw.partial)], partial.range_m[i]);
  EXPECT_EQ(fine->last_byte, four.back().last_byte);
  EXPECT_FALSE(interleaved(std::span(four).first(3)));
  EXPECT_FALSE(interleaved({}));
  four[1] = four[0];
  EXPECT_FALSE(interleaved(four)) << "one twice";
  ASSERT_TRUE(rig.scanner.stopStream());
  const auto single = rig.scanner.partialScan();
  ASSERT_TRUE(single) << single.error().what;
  EXPECT_TRUE(single->raw.partial);
}

TEST(LmsScanner, TypesThatSendReflectivityGiveIt) {
  LmsEmulatorSettings emulator;
  emulator.type = "LMS291;S14;V03.10 ";
  LmsRig rig(emulator);
  const auto report = rig.scanner.connect();
  ASSERT_TRUE(report) << report.error().what;
  EXPECT_EQ(rig.scanner.variant(), (Variant{90, 50}));
  const auto line = rig.scanner.scan();
  ASSERT_TRUE(line) << line.error().what;
  EXPECT_EQ(line->range_m.size(), 181U);
  ASSERT_EQ(line->intensity.size(), 181U);
  for (std::size_t i = 0; i < 181; ++i) EXPECT_EQ(line->intensity[i], rig.sent.back().echoes[i].intensity);
  ASSERT_TRUE(rig.scanner.startStream(LmsStream::Reflectivity));
  const auto streamed = rig.scanner.next();
  ASSERT_TRUE(streamed) << streamed.error().what;
  EXPECT_EQ(streamed->intensity.size(), 181U);
  // The ordinary type has none.
  LmsRig plain;
  ASSERT_TRUE(plain.scanner.connect());
  EXPECT_TRUE(plain.scanner.scan()->intensity.empty());
  EXPECT_FALSE(plain.scanner.startStream(LmsStream::Reflectivity));
}

TEST(LmsScanner, PermanentRateOnlyOnRequest) {
  LmsRig rig;
  ASSERT_TRUE(rig.scanner.connect());
  rig.emulator.cutPower(1s);
  rig.clock.sleepFor(10s);
  EXPECT_EQ(rig.emulator.baud(), 9600);
  ASSERT_TRUE(rig.scanner.recover(60.0));
  ASSERT_TRUE(rig.scanner.setPermanentRate(true));
  rig.emulator.cutPower(1s);
  rig.clock.sleepFor(10s);
  EXPECT_EQ(rig.emulator.baud(), 38400);
  ASSERT_TRUE(rig.scanner.recover(60.0));
  ASSERT_TRUE(rig.scanner.setPermanentRate(false));
}

TEST(LmsScanner, NothingBeforeConnecting) {
  LmsRig rig;
  EXPECT_FALSE(rig.scanner.scan());
  EXPECT_FALSE(rig.scanner.next());
  EXPECT_FALSE(rig.scanner.status());
  EXPECT_FALSE(rig.scanner.startStream());
  EXPECT_TRUE(rig.scanner.stopStream());
  EXPECT_EQ(rig.scanner.state(), LmsState::Disconnected);
}

TEST(LmsScanner, AStopEndsAnyWait) {
  LmsRig rig;
  rig.emulator.faults().silent = true;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(rig.scanner.recover(1000.0, stop.get_token()));
  EXPECT_LT(rig.seconds(), 5.0);
}

}  // namespace
}  // namespace tiltmap
