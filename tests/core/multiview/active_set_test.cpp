#include "core/multiview/active_set.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using Kind = RelaxationEventKind;

// A world of hand: who is whose neighbour, and how far each alignment of a scan
// moves it.
struct HandWorld {
  std::set<std::pair<int, int>> neighbours;            // lower first
  std::map<int, std::vector<PoseDifference>> motions;  // used up in turn, then nothing moves
  std::vector<std::pair<int, std::vector<int>>> aligned;
  std::map<int, std::size_t> used;

  void link(int a, int b) { neighbours.emplace(std::min(a, b), std::max(a, b)); }

  ActiveSetActions actions() {
    return {[this](int a, int b) {
              return neighbours.contains({std::min(a, b), std::max(a, b)});
            },
            [this](int scan, const std::vector<int>& members, RelaxationStep&) {
              aligned.emplace_back(scan, members);
              const std::vector<PoseDifference>& list = motions[scan];
              const std::size_t turn = used[scan]++;
              return turn < list.size() ? list[turn] : PoseDifference();
            }};
  }
};

std::vector<char> onlyFirstFixed(int scans) {
  std::vector<char> fixed(static_cast<std::size_t>(scans), 0);
  fixed[0] = 1;
  return fixed;
}

// Steps to the end; the bound catches a queue that never empties.
std::vector<RelaxationEvent> runToEnd(ActiveSet& set, HandWorld& world, int most_steps = 1000) {
  std::vector<RelaxationEvent> events;
  while (!set.done()) {
    RelaxationStep step;
    set.step(world.actions(), step);
    events.insert(events.end(), step.events.begin(), step.events.end());
    if (--most_steps == 0) {
      ADD_FAILURE() << "the queue does not empty";
      break;
    }
  }
  return events;
}

std::vector<int> scansOf(const std::vector<RelaxationEvent>& events, Kind kind) {
  std::vector<int> list;
  for (const RelaxationEvent& event : events)
    if (event.kind == kind) list.push_back(event.scan);
  return list;
}

TEST(ActiveSet, StartsAtTheBestLinkedScanAndAddsTheBestLinkedToTheActiveOnes) {
  HandWorld world;  // 2 has three neighbours; then 3 and 4 lean on the active
                    // set more and more
  world.link(0, 1);
  world.link(2, 1);
  world.link(2, 3);
  world.link(2, 4);
  world.link(3, 4);
  ActiveSet set(onlyFirstFixed(5), {});
  const auto events = runToEnd(set, world);
  // After 2: 1, 3 and 4 have one link each, so 1; then 0, 3 and 4 one each, so
  // 0; then 3, then 4.
  EXPECT_EQ(set.active(), (std::vector<int>{2, 1, 0, 3, 4}));
  EXPECT_EQ(scansOf(events, Kind::Activated), set.active());
  EXPECT_TRUE(set.unlinked().empty());
}

TEST(ActiveSet, MoreLinksIntoTheActiveSetComeFirstWhateverTheIndex) {
  HandWorld world;
  world.link(0, 1);
  world.link(0, 2);
  world.link(0, 3);
  world.link(0, 4);
  world.link(4, 1);
  ActiveSet set(onlyFirstFixed(5), {});
  runToEnd(set, world);
  // 0 first; all others have one link: 1; then 4 has two, 2 and 3 one.
  EXPECT_EQ(set.active(), (std::vector<int>{0, 1, 4, 2, 3}));
}

TEST(ActiveSet, TiesGoToTheLowestIndex) {
  HandWorld world;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) world.link(a, b);
  ActiveSet set(onlyFirstFixed(4), {});
  runToEnd(set, world);
  EXPECT_EQ(set.active(), (std::vector<int>{0, 1, 2, 3}));
}

TEST(ActiveSet, AlignsEachScanWithItsActiveNeighboursOnly) {
  HandWorld world;
  world.link(0, 1);
  world.link(1, 2);
  world.link(2, 3);
  world.link(0, 2);
  ActiveSet set(onlyFirstFixed(4), {});
  runToEnd(set, world);
  // 2 starts (three neighbours), 0 comes in and passes the queue on to 2, and
  // so on.
  ASSERT_EQ(set.active(), (std::vector<int>{2, 0, 1, 3}));
  const std::vector<std::pair<int, std::vector<int>>> expected = {{2, {0}}, {1, {0, 2}}, {3, {2}}};
  EXPECT_EQ(world.aligned, expected);
}

TEST(ActiveSet, ScanZeroIsNeverAlignedButItsNeighboursAreQueued) {
  HandWorld world;
  world.link(1, 2);
  world.link(1, 3);
  world.link(0, 1);
  world.link(0, 2);
  world.motions[1] = {{1.0, 0.0}};
  ActiveSet set(onlyFirstFixed(4), {});
  const auto events = runToEnd(set, world);
  for (const auto& [scan, members] : world.aligned) EXPECT_NE(scan, 0);
  // The best-linked scan 1 came in before 0 and unaligned: only scan 0 can get
  // it aligned.
  ASSERT_EQ(set.active().front(), 1);
  EXPECT_NE(std::ranges::find(world.aligned, std::pair<int, std::vector<int>>{1, {0}}), world.aligned.end());
  bool queued_by_zero = false;
  for (const RelaxationEvent& event : events)
    if (event.kind == Kind::Queued && event.scan == 1 && event.other == 0) queued_by_zero = true;
  EXPECT_TRUE(queued_by_zero);
}

TEST(ActiveSet, PinsAreNeverAlignedEither) {
  HandWorld world;
  world.link(0, 1);
  world.link(1, 2);
  world.link(0, 2);
  ActiveSet set({1, 0, 1}, {});
  runToEnd(set, world);
  for (const auto& [scan, members] : world.aligned) EXPECT_EQ(scan, 1);
  EXPECT_FALSE(world.aligned.empty());
}

TEST(ActiveSet, EitherThresholdAloneQueuesTheNeighboursAgain) {
  const RelaxationSettings settings;
  const struct {
    PoseDifference motion;
    bool passes_on;
  } cases[] = {{{0.49, 0.49 * kDegree}, false},
               {{0.51, 0.0}, true},
               {{0.0, 0.51 * kDegree}, true},
               {{0.5, 0.5 * kDegree}, false}};
  for (const auto& c : cases) {
    HandWorld world;
    world.link(0, 1);
    world.link(0, 2);
    world.link(1, 2);
    world.motions[2] = {c.motion};
    ActiveSet set(onlyFirstFixed(3), settings);
    const auto events = runToEnd(set, world);
    bool queued_by_two = false;
    for (const RelaxationEvent& event : events)
      if (event.kind == Kind::Queued && event.other == 2) queued_by_two = true;
    EXPECT_EQ(queued_by_two, c.passes_on) << c.motion.translation_m << " m " << c.motion.rotation_rad;
  }
}

TEST(ActiveSet, AScanAlreadyInTheQueueIsNotQueuedTwice) {
  HandWorld world;
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) world.link(a, b);
  world.motions[3] = {{1.0, 0.0}};  // queues 0, 1, 2; 0 then finds 1 and 2 there already
  ActiveSet set(onlyFirstFixed(4), {});
  const auto events = runToEnd(set, world);
  std::vector<int> tail;  // queued after 3 had moved
  bool after = false;
  for (const RelaxationEvent& event : events) {
    if (event.kind == Kind::MovedBy && event.scan == 3 && event.translation_m == 1.0) after = true;
    if (after && event.kind == Kind::Queued) tail.push_back(event.scan);
  }
  EXPECT_EQ(tail, (std::vector<int>{0, 1, 2, 3}));
}

TEST(ActiveSet, VisitsAreBoundedAndTheBoundIsReported) {
  HandWorld world;
  world.link(0, 1);
  world.link(1, 2);
  world.motions[1] = world.motions[2] = std::vector<PoseDifference>(100000, {1.0, 0.0});  // for ever
  RelaxationSettings settings;
  settings.max_visits = 7;
  ActiveSet set(onlyFirstFixed(3), settings);
  const auto events = runToEnd(set, world);
  EXPECT_TRUE(set.done());
  EXPECT_EQ(set.visits(1), 7);
  EXPECT_LE(set.visits(2), 7);
  EXPECT_FALSE(set.bounded().empty());
  EXPECT_EQ(scansOf(events, Kind::VisitBound), set.bounded());
}

TEST(ActiveSet, AScanWithoutNeighboursIsReportedAndNotAligned) {
  HandWorld world;
  world.link(0, 1);
  world.link(1, 3);
  ActiveSet set(onlyFirstFixed(4), {});
  const auto events = runToEnd(set, world);
  EXPECT_EQ(set.unlinked(), (std::vector<int>{2}));
  EXPECT_EQ(scansOf(events, Kind::Unlinked), (std::vector<int>{2}));
  for (const auto& [scan, members] : world.aligned) EXPECT_NE(scan, 2);
  EXPECT_EQ(set.active().size(), 4U);
}

TEST(ActiveSet, NoScanAndOneScanEnd) {
  EXPECT_TRUE(ActiveSet({}, {}).done());
  HandWorld world;
  ActiveSet one({1}, {});
  runToEnd(one, world);
  EXPECT_TRUE(world.aligned.empty());
  RelaxationStep step;
  EXPECT_THROW(one.step(world.actions(), step), std::logic_error);
}

TEST(ActiveSet, ACopyContinuesAlike) {
  HandWorld world;
  for (int a = 0; a < 5; ++a)
    for (int b = a + 1; b < 5; ++b) world.link(a, b);
  world.motions[2] = {{1.0, 0.0}, {1.0, 0.0}};
  ActiveSet set(onlyFirstFixed(5), {});
  RelaxationStep step;
  for (int i = 0; i < 3; ++i) set.step(world.actions(), step);
  ActiveSet copy = set;
  HandWorld other = world;
  EXPECT_EQ(scansOf(runToEnd(set, world), Kind::Queued), scansOf(runToEnd(copy, other), Kind::Queued));
  EXPECT_EQ(world.aligned, other.aligned);
}

}  // namespace
}  // namespace tiltmap
