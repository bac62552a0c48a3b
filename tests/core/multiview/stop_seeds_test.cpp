// Stops over several seeds and sites, good ones and all kinds of bad ones: no bad stop is called good.
#include <array>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/multiview/stop_verdict.h"
#include "tests/support/stop_scenes.h"

namespace tiltmap {
namespace {

using namespace test_support;

constexpr int kStops = 12;
constexpr int kFarther = 9;  // stops left out: some 40 m of street
// A pose that is off by more is wrong: to be told to move on with it would be a bad stop called good.
constexpr double kWrongM = 0.05, kWrongRad = 0.3 * kDegree;

struct Tally {
  int stops = 0, moved_on = 0, wrongly = 0;
};

class StopSeeds : public testing::TestWithParam<std::uint64_t> {
 protected:
  void judge(const char* kind, const StopMap& map, const Scan& scan, const Pose& odometry,
             const Pose* truth) {
    const StopVerdict verdict = stopVerdict(map, scan, odometry);
    Tally& tally = tallies_[kind];
    ++tally.stops;
    if (verdict.light != StopLight::MoveOn) return;
    ++tally.moved_on;
    if (!truth) {
      ++tally.wrongly;
      return;
    }
    const PoseDifference off = difference(*truth, verdict.world_from_scan);
    tally.wrongly += off.translation_m > kWrongM || off.rotation_rad > kWrongRad ? 1 : 0;
  }
  std::map<std::string, Tally> tallies_;
};

TEST_P(StopSeeds, NoBadStopIsCalledGood) {
  const std::uint64_t seed = GetParam();
  const Experiment experiment = Experiment::make(ExperimentId::Loop, seed, kStops).value();
  const auto stops = experiment.simulateAll(0).value();
  const Scan elsewhere = Experiment::make(ExperimentId::Survey, seed + 5000, 1)->simulate(0, 0).value().scan;
  StopMap map;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    RandomStream random = RandomStream::keyed({seed, i, 0x570bULL});
    const Scan& scan = stops[i].scan;
    const Pose odometry =
        i == 0 ? stops[0].truth : stops[i - 1].truth * stops[i - 1].scan.odometry.inverse() * scan.odometry;
    // Every third stop stands for the others: each kind takes a registration or two.
    if (i % 3 == 2) {
      judge("good", map, scan, odometry, &stops[i].truth);
      const int first = static_cast<int>(random.below(300));
      judge("dirty window", map, dirtyWindow(scan, first, first + 61, i), odometry, nullptr);
      judge("covered window", map, coveredWindow(scan, first, first + 61, cell_code::kLmsDazzled), odometry,
            nullptr);
      judge("blocked view", map, blockedStop(experiment, static_cast<int>(i), seed), odometry, nullptr);
      judge("another place", map, elsewhere, odometry, nullptr);
      const double way = random.uniform(0.0, 2.0 * std::numbers::pi), size = random.uniform(2.0, 8.0);
      const Pose lie = Pose::planar(size * std::cos(way), size * std::sin(way),
                                    random.uniform(30.0, 180.0) * kDegree * (i % 2 == 0 ? 1.0 : -1.0));
      judge("odometry that lies", map, scan, odometry * lie, &stops[i].truth);
      if (const std::size_t far = i + kFarther; far < stops.size())
        judge("too far", map, stops[far].scan,
              stops[i - 1].truth * stops[i - 1].scan.odometry.inverse() * stops[far].scan.odometry,
              &stops[far].truth);
    }
    map.add(scan, stops[i].truth);
  }
  for (const char* kind : {"good", "dirty window", "covered window", "blocked view", "another place",
                           "odometry that lies", "too far"}) {
    const Tally& tally = tallies_[kind];
    EXPECT_GT(tally.stops, 0) << kind;
    EXPECT_EQ(tally.wrongly, 0) << kind << ": " << tally.moved_on << " of " << tally.stops << " moved on";
  }
  EXPECT_GE(tallies_["good"].moved_on, tallies_["good"].stops - 1) << "and good ones are no bad ones";
}

INSTANTIATE_TEST_SUITE_P(Seeds, StopSeeds, testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace tiltmap
