#include "core/project/operations/relax_operation.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "core/base/parallel.h"
#include "core/multiview/relaxation.h"
#include "core/project/link_judgement.h"
#include "core/project/operations/index_list.h"
#include "core/project/operations/link_consistency.h"
#include "core/project/operations/relax_increment.h"
#include "core/project/operations/relax_start.h"

namespace tiltmap {

namespace {

// Registering the pairs first, where nobody has, preparing the scans, and judging what was found, as shares
// of the progress that is left then.
constexpr double kRegistering = 0.4;
constexpr double kPreparing = 0.3;
constexpr double kJudging = 0.1;

// Those of the project and those of the parameter, ascending.
Result<std::vector<int>> pinsOf(const ProjectSnapshot& snapshot, const RelaxSettings& settings) {
  std::vector<int> pins;
  if (!settings.pin.empty()) {
    auto named = parseIndexList(settings.pin, static_cast<int>(snapshot.scans().size()), "--pin");
    if (!named) return named;
    pins = std::move(*named);
  }
  for (const ScanId scan : snapshot.pins())
    if (const auto index = snapshot.indexOf(scan)) pins.push_back(static_cast<int>(*index));
  std::ranges::sort(pins);
  const auto repeats = std::ranges::unique(pins);
  pins.erase(repeats.begin(), repeats.end());
  return pins;
}

std::string methodName(const RelaxSettings& settings) {
  return std::get<std::string>(relaxationParameters().values(settings.relaxation).at("method"));
}

// Scans with a link that says more than one found here would: set by hand, disabled, or registered with
// success.
JoinedPairs linked(const std::vector<Link>& links) {
  JoinedPairs pairs;
  for (const Link& link : links) {
    const bool ours = link.origin == LinkOrigin::Automatic && link.state == LinkState::Active &&
                      (!link.succeeded || link.stop_reason == kFoundByRelaxation);
    if (!ours) pairs.add(link.fixed, link.moving);
  }
  pairs.sort();
  return pairs;
}

std::vector<Link> newLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                           const RelaxationResult& result) {
  std::vector<Link> found_links;
  const JoinedPairs have = linked(links);
  for (const RelaxationLink& found : result.links) {
    const ScanId fixed = snapshot.scans()[static_cast<std::size_t>(found.fixed)].id;
    const ScanId moving = snapshot.scans()[static_cast<std::size_t>(found.moving)].id;
    // The other methods keep no figures a pair; without an information there is nothing to compute from.
    if (!found.used || found.information.isZero() || have.contains(fixed, moving)) continue;
    Link link;
    link.fixed = fixed;
    link.moving = moving;
    link.fixed_from_moving = found.fixed_from_moving;
    link.iterations = static_cast<int>(result.steps.size());
    link.correspondences = static_cast<int>(found.pairs);
    link.rms_m = found.rms_m;
    link.overlap = found.overlap;
    link.stop_reason = kFoundByRelaxation;
    link.succeeded = true;
    link.information = found.information;
    found_links.push_back(link);
  }
  return found_links;
}

// Links of an earlier relaxation that this one looked for and did not find again. `added`: it looked only for
// links of these; empty: for all.
std::vector<LinkId> staleLinks(const ProjectSnapshot& snapshot, const std::vector<int>& added,
                               const std::vector<Link>& found) {
  JoinedPairs again;
  for (const Link& link : found) again.add(link.fixed, link.moving);
  again.sort();
  std::set<ScanId> new_ones;
  for (const int i : added) new_ones.insert(snapshot.scans()[static_cast<std::size_t>(i)].id);
  std::vector<LinkId> stale;
  for (const Link& link : snapshot.links()) {
    if (link.stop_reason != kFoundByRelaxation || link.origin != LinkOrigin::Automatic ||
        link.state != LinkState::Active)
      continue;
    const bool looked_for = added.empty() || new_ones.contains(link.fixed) || new_ones.contains(link.moving);
    if (looked_for && !again.contains(link.fixed, link.moving)) stale.push_back(link.id);
  }
  return stale;
}

nlohmann::json eventJson(const RelaxationStep& step, const RelaxationEvent& event) {
  nlohmann::json json = {{"step", step.number}, {"event", relaxationEventName(event.kind)}};
  if (event.scan >= 0) json["scan"] = event.scan;
  if (event.other >= 0) json["other"] = event.other;
  if (event.kind == RelaxationEventKind::MovedBy || event.kind == RelaxationEventKind::Solved) {
    json["translation_m"] = event.translation_m;
    json["rotation_deg"] = event.rotation_rad / kDegree;
  }
  if (event.pairs > 0) json["pairs"] = event.pairs;
  if (event.rms_m > 0.0) json["rms_m"] = event.rms_m;
  if (event.loss_scale_m > 0.0) json["loss_scale_m"] = event.loss_scale_m;
  if (!event.text.empty()) json["text"] = event.text;
  return json;
}

nlohmann::json reportOf(const RelaxationResult& result) {
  nlohmann::json report = {{"moved", nlohmann::json::array()},
                           {"unlinked", result.unlinked},
                           {"links", nlohmann::json::array()},
                           {"steps", result.steps.size()},
                           {"rms_m", result.rms_m},
                           {"relaxing_milliseconds", result.milliseconds},
                           {"events", nlohmann::json::array()}};
  for (std::size_t i = 0; i < result.moved.size(); ++i)
    report["moved"].push_back({{"scan", i},
                               {"translation_m", result.moved[i].translation_m},
                               {"rotation_deg", result.moved[i].rotation_rad / kDegree}});
  for (const RelaxationLink& link : result.links)
    report["links"].push_back({{"fixed", link.fixed},
                               {"moving", link.moving},
                               {"pairs", link.pairs},
                               {"overlap", link.overlap},
                               {"agreement", link.agreement},
                               {"rms_m", link.rms_m},
                               {"used", link.used}});
  for (const RelaxationStep& step : result.steps)
    for (const RelaxationEvent& event : step.events) report["events"].push_back(eventJson(step, event));
  return report;
}

// Holds the scans of each link that was found against each other: it stands in the table beside registered
// ones, and can be trusted or not as they can.
Status judgeFound(const ProjectSnapshot& snapshot, const std::vector<PreparedScanPtr>& scans,
                  const std::vector<Pose>& world_from_scan, int threads, const JobControl& control,
                  std::vector<Link>& found) {
  std::vector<PairToJudge> pairs;
  for (const Link& link : found) {
    PairToJudge pair{snapshot.indexOf(link.fixed).value(), snapshot.indexOf(link.moving).value(), {}};
    pair.claim.fixed_from_moving = link.fixed_from_moving;
    pair.claim.start = world_from_scan[pair.fixed].inverse() * world_from_scan[pair.moving];
    pairs.push_back(std::move(pair));
  }
  auto judged = judgePairs(
      pairs, [&](std::size_t i) { return Result<JudgedScanPtr>(judgedScan(scans[i])); }, threads, {},
      control);
  if (!judged) return fail(judged.error());
  for (std::size_t k = 0; k < found.size(); ++k)
    found[k].judgement = std::make_shared<const PairJudgement>(std::move((*judged)[k]));
  return {};
}

// Poses and links as one edit, with those of the registration that came first.
ProjectEdit editOf(const SnapshotPtr& snapshot, RelaxStart start, const std::vector<int>& added,
                   std::vector<Link> found, const RelaxationResult& result) {
  std::vector<std::pair<ScanId, Pose>> poses;
  for (std::size_t i = 0; i < result.poses.size(); ++i)
    poses.emplace_back(snapshot->scans()[i].id, result.poses[i]);
  ProjectEdit edit = relaxEdit(snapshot, std::move(poses));
  if (!added.empty())
    edit.title = "relax " + std::to_string(added.size()) + (added.size() == 1 ? " new scan" : " new scans");
  if (start.registered_first) edit.title = "register and " + edit.title;
  edit.steps.insert(edit.steps.begin(), std::make_move_iterator(start.steps.begin()),
                    std::make_move_iterator(start.steps.end()));
  // First, while they are surely there.
  if (auto stale = staleLinks(*snapshot, added, found); !stale.empty())
    edit.steps.insert(edit.steps.begin(), DeleteLinks{std::move(stale)});
  if (!found.empty()) edit.steps.push_back(AddLinks{std::move(found), true});
  return edit;
}

// The control of a part of the work: its progress counts from one share to the other.
JobControl part(const JobControl& control, double from, double to) {
  JobControl inner = control;
  inner.report = [&control, from, to](const Progress& progress) {
    control.tell(from + (to - from) * progress.fraction, progress.message);
  };
  return inner;
}

RelaxationBeginning beginningOf(const ProjectSnapshot& snapshot, const std::vector<Pose>& world_from_scan,
                                const std::vector<int>& pins, const RelaxSettings& settings) {
  RelaxationBeginning beginning;
  beginning.method = methodName(settings);
  for (const ScanEntry& scan : snapshot.scans()) beginning.scans.push_back(scan.id);
  beginning.world_from_scan = world_from_scan;
  beginning.pins = pins;
  if (beginning.pins.empty() || beginning.pins.front() != 0) beginning.pins.insert(beginning.pins.begin(), 0);
  return beginning;
}

RelaxationWatch watchFor(RelaxationFeed* feed, const std::stop_token& stop) {
  if (!feed) return {};
  return {[feed, stop](const RelaxationState& state) { feed->at(state, stop); },
          [feed, stop](const Relaxation& relaxation, const RelaxationStep& step) {
            feed->stepped({step, relaxation.state(), relaxation.poses(), relaxation.links()}, stop);
          }};
}

// The same control, whose progress waits while the feed is paused: for parts that know nothing of feeds.
JobControl held(const JobControl& control, RelaxationFeed* feed) {
  if (!feed) return control;
  JobControl inner = control;
  inner.report = [&control, feed](const Progress& progress) {
    control.tell(progress.fraction, progress.message);
    feed->waitWhilePaused(control.stop);
  };
  return inner;
}

// Whether an added scan has a link of its own to one that is not its neighbour: it may be false.
bool closesLoop(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                const std::vector<int>& added) {
  return std::ranges::any_of(links, [&](const Link& link) {
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving || !link.usable() || link.origin != LinkOrigin::Automatic ||
        link.stop_reason == kFoundByRelaxation)
      return false;
    const int a = static_cast<int>(*fixed), b = static_cast<int>(*moving);
    return std::abs(a - b) > 1 &&
           (std::ranges::binary_search(added, a) || std::ranges::binary_search(added, b));
  });
}

class RelaxOperation : public SettingsOperation<RelaxSettings> {
 public:
  explicit RelaxOperation(std::shared_ptr<RelaxationFeed> feed)
      : SettingsOperation(relaxParameters()), feed_(std::move(feed)) {}
  std::string title() const override { return "Relax all scans"; }
  std::string help() const override {
    return "Takes all overlapping pairs of scans together, not only neighbours in time, and spreads what the "
           "pairs' errors have added up to. Starts from the stage `pairwise` (registers every scan to the "
           "one "
           "before it first where there is none) and makes the stage `relaxed`; scan 0 never moves. Where "
           "only "
           "scans have come since the last relaxation, they are put onto the others (`extent`).";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const RelaxSettings& settings) const override {
    if (snapshot.scans().size() < 2)
      return fail("relaxation needs two scans; the project has " + std::to_string(snapshot.scans().size()),
                  snapshot.path().string(), "import, simulate or capture more scans first");
    if (auto pins = pinsOf(snapshot, settings); !pins) return fail(pins.error());
    return tiltmap::checkSettings(settings.relaxation);
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                                      const JobControl& control) const override {
    const auto started = std::chrono::steady_clock::now();
    auto pins = pinsOf(*snapshot, settings);
    if (!pins) return fail(pins.error());
    OperationResult outcome;
    std::vector<int> added = addedSinceRelaxation(*snapshot, settings, *pins);
    std::optional<Computed> computed;
    if (!added.empty()) {
      auto put_on = relaxNew(snapshot, settings, *pins, added, control);
      if (!put_on) return fail(put_on.error());
      computed = std::move(*put_on);
      if (!computed) {
        outcome.warnings.emplace_back(
            "the new scans move the ones before them too far to be put onto these: everything was relaxed");
        added.clear();
      }
    }
    if (!computed) {
      auto all = relaxEverything(snapshot, settings, *pins, control);
      if (!all) return fail(all.error());
      computed = std::move(*all);
    }
    const RelaxationResult* result = &computed->result;
    outcome.warnings.insert(outcome.warnings.end(), computed->warnings.begin(), computed->warnings.end());

    nlohmann::json report = reportOf(*result);
    report["milliseconds"] =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
    report["registered_first"] = computed->start.registered_first;
    report["added"] = added;
    report["prepared"] = computed->prepared;
    report["method"] = methodName(settings);
    report["pins"] = *pins;
    report["warnings"] = outcome.warnings;
    outcome.report_json = report.dump();

    outcome.edit = editOf(snapshot, std::move(computed->start), added, std::move(computed->found), *result);
    return outcome;
  }

 private:
  struct Computed {
    RelaxStart start;
    RelaxationResult result;
    std::vector<std::string> warnings;
    std::size_t prepared = 0;  // scans
    std::vector<Link> found = {};
  };

  Result<Computed> relaxEverything(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                                   const std::vector<int>& pins, const JobControl& control) const {
    const double from = snapshot->hasStage(Stage::Pairwise) ? 0.0 : kRegistering;
    const JobControl registering = part(control, 0.0, from);
    auto start = startOf(snapshot, settings, held(registering, feed_.get()));
    if (!start) return fail(start.error());
    std::vector<int> every(snapshot->scans().size());
    std::iota(every.begin(), every.end(), 0);
    const double prepared_at = from + kPreparing * (1.0 - from);
    auto prepared = preparedScans(*snapshot, every, settings, part(control, from, prepared_at), feed_.get());
    if (!prepared) return fail(prepared.error());

    Computed computed{.start = std::move(*start), .result = {}, .warnings = {}, .prepared = every.size()};
    computed.warnings = computed.start.warnings;
    RelaxationInput input;
    input.scans = std::move(*prepared);
    auto consistent = consistentLinks(*snapshot, computed.start.links, computed.start.world_from_scan, pins);
    if (!consistent) return fail(consistent.error());
    computed.warnings.insert(computed.warnings.end(), consistent->warnings.begin(),
                             consistent->warnings.end());
    input.world_from_scan = std::move(consistent->world_from_scan);
    input.pins = pins;
    addLinks(*snapshot, consistent->links, input);
    const std::vector<PreparedScanPtr> scans = input.scans;
    const std::vector<Pose> started_at = input.world_from_scan;
    const double relaxed_at = 1.0 - kJudging * (1.0 - prepared_at);
    auto result = runOne(*snapshot, std::move(input), settings, pins, part(control, prepared_at, relaxed_at));
    return finished(*snapshot, std::move(computed), std::move(result), scans, started_at, settings,
                    part(control, relaxed_at, 1.0));
  }

  // Nothing where the added scans move the others too far.
  Result<std::optional<Computed>> relaxNew(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                                           const std::vector<int>& pins, const std::vector<int>& added,
                                           const JobControl& control) const {
    const JobControl registering = part(control, 0.0, kRegistering);
    auto start = startOfAdded(snapshot, added, settings, held(registering, feed_.get()));
    if (!start) return fail(start.error());
    const std::vector<int> around =
        scansAround(*snapshot, start->world_from_scan, added, settings.relaxation);
    const double prepared_at = kRegistering + kPreparing * (1.0 - kRegistering);
    auto prepared =
        preparedScans(*snapshot, around, settings, part(control, kRegistering, prepared_at), feed_.get());
    if (!prepared) return fail(prepared.error());

    Computed computed{.start = std::move(*start), .result = {}, .warnings = {}, .prepared = around.size()};
    computed.warnings = computed.start.warnings;
    RelaxationInput input;
    input.scans = std::move(*prepared);
    input.world_from_scan = computed.start.world_from_scan;
    input.pins = pins;
    std::vector<Link> links = computed.start.links;
    if (closesLoop(*snapshot, links, added)) {
      auto consistent = consistentLinks(*snapshot, std::move(links), input.world_from_scan, pins);
      if (!consistent) return fail(consistent.error());
      links = std::move(consistent->links);
      computed.warnings.insert(computed.warnings.end(), consistent->warnings.begin(),
                               consistent->warnings.end());
    }
    addLinks(*snapshot, links, input);
    const double relaxed_at = 1.0 - kJudging * (1.0 - prepared_at);
    const JobControl relaxing = part(control, prepared_at, relaxed_at);
    auto result = relaxAdded(*snapshot, input, links, added, around, [&](RelaxationInput of_rings) {
      return runOne(*snapshot, std::move(of_rings), settings, pins, relaxing);
    });
    if (!result) return fail(result.error());
    if (!*result) return std::optional<Computed>();
    return finished(*snapshot, std::move(computed), std::move(**result), input.scans, input.world_from_scan,
                    settings, part(control, relaxed_at, 1.0))
        .map([](Computed whole) { return std::optional(std::move(whole)); });
  }

  Result<RelaxationResult> runOne(const ProjectSnapshot& snapshot, RelaxationInput input,
                                  const RelaxSettings& settings, const std::vector<int>& pins,
                                  const JobControl& control) const {
    if (feed_) feed_->began(beginningOf(snapshot, input.world_from_scan, pins, settings));
    return relax(std::move(input), settings.relaxation, settings.threads, control,
                 watchFor(feed_.get(), control.stop));
  }

  static Result<Computed> finished(const ProjectSnapshot& snapshot, Computed computed,
                                   Result<RelaxationResult> result, const std::vector<PreparedScanPtr>& scans,
                                   const std::vector<Pose>& started_at, const RelaxSettings& settings,
                                   const JobControl& judging) {
    if (!result) return fail(result.error());
    computed.found = newLinks(snapshot, computed.start.links, *result);
    if (settings.judge)
      if (Status status = judgeFound(snapshot, scans, started_at, settings.threads, judging, computed.found);
          !status)
        return fail(status.error());
    computed.warnings.insert(computed.warnings.end(), result->warnings.begin(), result->warnings.end());
    computed.result = std::move(*result);
    return computed;
  }

  std::shared_ptr<RelaxationFeed> feed_;  // null: nobody watches
};

}  // namespace

std::unique_ptr<Operation> makeRelaxOperation(std::shared_ptr<RelaxationFeed> feed) {
  return std::make_unique<RelaxOperation>(std::move(feed));
}

}  // namespace tiltmap
