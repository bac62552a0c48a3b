#include "core/project/operations/relax_operation.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/base/parallel.h"
#include "core/multiview/relaxation.h"
#include "core/project/link_judgement.h"
#include "core/project/link_what_if.h"
#include "core/project/operations/index_list.h"
#include "core/project/operations/link_consistency.h"
#include "core/project/operations/register_operation.h"

namespace tiltmap {

namespace {

struct RelaxSettings {
  RelaxationSettings relaxation;
  std::string pin;
  int threads = 0;
};

// Registering the pairs first, where nobody has, preparing the scans, and judging what was found, as shares of
// the progress that is left then.
constexpr double kRegistering = 0.4;
constexpr double kPreparing = 0.3;
constexpr double kJudging = 0.1;

const ParameterTable<RelaxSettings>& relaxTable() {
  static const ParameterTable<RelaxSettings> table = [] {
    ParameterTable<RelaxSettings> t("relax");
    t.text(
        "pin", &RelaxSettings::pin,
        "Scans that never move, such as 0,5 or 0-3, beside those pinned in the project; scan 0 never does, "
        "named or not",
        "ours; thesis 6.2");
    t.integer("threads", &RelaxSettings::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    t.include(relaxationParameters(), &RelaxSettings::relaxation);
    return t;
  }();
  return table;
}

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

Result<std::vector<PreparedScanPtr>> prepareScans(const ProjectSnapshot& snapshot,
                                                  const RelaxSettings& settings, const JobControl& control,
                                                  RelaxationFeed* feed) {
  const std::size_t count = snapshot.scans().size();
  std::vector<Result<PreparedScanPtr>> slots(count, PreparedScanPtr());
  std::atomic<std::size_t> done = 0;
  parallelFor(count, settings.threads, [&](std::size_t i) {
    if (feed) feed->waitWhilePaused(control.stop);
    if (control.stopRequested()) return;
    slots[i] = snapshot.scans()[i].scan().map(
        [&](const Scan& scan) { return prepare(scan, settings.relaxation.registration); });
    control.tell(static_cast<double>(++done) / static_cast<double>(count),
                 "preparing scan " + std::to_string(i));
  });
  if (control.stopRequested())
    return fail(kCancelled, "relax", "nothing was changed; start it again when you like");
  std::vector<PreparedScanPtr> prepared;
  for (auto& slot : slots) {
    if (!slot) return fail(slot.error());
    prepared.push_back(*slot);
  }
  return prepared;
}

// Where the relaxation starts from, and what links there are.
struct RelaxStart {
  std::vector<Pose> world_from_scan;
  std::vector<Link> links;
  std::vector<EditStep> steps;  // of the registration that came first; empty where there was none
  std::vector<std::string> warnings;
  bool registered_first = false;
};

bool joins(const Link& link, ScanId a, ScanId b) {
  return (link.fixed == a && link.moving == b) || (link.fixed == b && link.moving == a);
}

// The pairwise poses; where there are none, the pairs are registered first, as `register` does it.
Result<RelaxStart> startOf(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                           const JobControl& control) {
  RelaxStart start;
  start.links = snapshot->links();
  if (snapshot->hasStage(Stage::Pairwise)) {
    start.world_from_scan = snapshot->filledPoses(Stage::Pairwise);
    return start;
  }
  const auto registration = makeRegisterOperation();
  const bool thesis = settings.relaxation.method == RelaxationMethod::ActiveSet;
  auto values = registration->presetValues(thesis ? "thesis" : "default");
  if (!values) return fail(values.error());
  (*values)["threads"] = static_cast<long long>(settings.threads);
  auto registered = registration->run(snapshot, *values, control);
  if (!registered) return fail(registered.error());
  start.registered_first = true;
  start.steps = std::move(registered->edit.steps);
  start.warnings.emplace_back(
      "the project had no pairwise poses, so every scan was registered to the one before it first");
  start.warnings.insert(start.warnings.end(), registered->warnings.begin(), registered->warnings.end());
  // The order of the scans, as filledPoses gives it.
  for (const EditStep& step : start.steps) {
    if (const auto* added = std::get_if<AddLinks>(&step))
      for (const Link& link : added->links) {
        std::erase_if(start.links, [&](const Link& old) {
          return old.origin == link.origin && joins(old, link.fixed, link.moving);
        });
        start.links.push_back(link);
      }
    if (const auto* poses = std::get_if<SetPoses>(&step))
      for (const auto& [id, pose] : poses->poses) start.world_from_scan.push_back(pose);
  }
  if (start.world_from_scan.size() != snapshot->scans().size())
    throw std::logic_error("relax: the registration did not place every scan");
  return start;
}

void addLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links, RelaxationInput& input) {
  for (const Link& link : links) {
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving) continue;
    const int a = static_cast<int>(*fixed), b = static_cast<int>(*moving);
    if (link.state == LinkState::Disabled) {
      input.excluded.emplace_back(a, b);
      continue;
    }
    // What an earlier relaxation found is found again, or it does not hold any more.
    if (!link.usable() || link.origin == LinkOrigin::Odometry || link.stop_reason == kFoundByRelaxation)
      continue;
    const bool by_hand = link.origin == LinkOrigin::ByHand;
    if (!by_hand && !link.information) continue;
    input.constraints.push_back(
        {a, b, link.fixed_from_moving, link.information.value_or(informationByHand()), !by_hand});
  }
}

// A link that says more than one found here would: set by hand, disabled, or registered with success.
bool haveLink(const std::vector<Link>& links, ScanId a, ScanId b) {
  for (const Link& link : links) {
    const bool ours = link.origin == LinkOrigin::Automatic && link.state == LinkState::Active &&
                      (!link.succeeded || link.stop_reason == kFoundByRelaxation);
    if (joins(link, a, b) && !ours) return true;
  }
  return false;
}

std::vector<Link> newLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                           const RelaxationResult& result) {
  std::vector<Link> found_links;
  for (const RelaxationLink& found : result.links) {
    const ScanId fixed = snapshot.scans()[static_cast<std::size_t>(found.fixed)].id;
    const ScanId moving = snapshot.scans()[static_cast<std::size_t>(found.moving)].id;
    // The other methods keep no figures a pair; without an information there is nothing to compute from.
    if (!found.used || found.information.isZero() || haveLink(links, fixed, moving)) continue;
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

// Links of an earlier relaxation that this one did not find again.
std::vector<LinkId> staleLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& found) {
  std::vector<LinkId> stale;
  for (const Link& link : snapshot.links()) {
    if (link.stop_reason != kFoundByRelaxation || link.origin != LinkOrigin::Automatic ||
        link.state != LinkState::Active)
      continue;
    const bool again =
        std::ranges::any_of(found, [&](const Link& other) { return joins(other, link.fixed, link.moving); });
    if (!again) stale.push_back(link.id);
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
ProjectEdit editOf(const SnapshotPtr& snapshot, RelaxStart start, std::vector<Link> found,
                   const RelaxationResult& result) {
  std::vector<std::pair<ScanId, Pose>> poses;
  for (std::size_t i = 0; i < result.poses.size(); ++i)
    poses.emplace_back(snapshot->scans()[i].id, result.poses[i]);
  ProjectEdit edit = relaxEdit(snapshot, std::move(poses));
  if (start.registered_first) edit.title = "register and " + edit.title;
  edit.steps.insert(edit.steps.begin(), std::make_move_iterator(start.steps.begin()),
                    std::make_move_iterator(start.steps.end()));
  // First, while they are surely there.
  if (auto stale = staleLinks(*snapshot, found); !stale.empty())
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

RelaxationBeginning beginningOf(const ProjectSnapshot& snapshot, const RelaxationInput& input,
                                const RelaxSettings& settings) {
  RelaxationBeginning beginning;
  beginning.method = methodName(settings);
  for (const ScanEntry& scan : snapshot.scans()) beginning.scans.push_back(scan.id);
  beginning.world_from_scan = input.world_from_scan;
  beginning.pins = input.pins;
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

class RelaxOperation : public SettingsOperation<RelaxSettings> {
 public:
  explicit RelaxOperation(std::shared_ptr<RelaxationFeed> feed)
      : SettingsOperation(relaxTable()), feed_(std::move(feed)) {}
  std::string title() const override { return "Relax all scans"; }
  std::string help() const override {
    return "Takes all overlapping pairs of scans together, not only neighbours in time, and spreads what the "
           "pairs' errors have added up to. Starts from the stage `pairwise` (registers every scan to the "
           "one "
           "before it first where there is none) and makes the stage `relaxed`; scan 0 never moves.";
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
    const bool registers = !snapshot->hasStage(Stage::Pairwise);
    const double from = registers ? kRegistering : 0.0;
    const JobControl registering = part(control, 0.0, from);
    auto start = startOf(snapshot, settings, held(registering, feed_.get()));
    if (!start) return fail(start.error());
    const double prepared_at = from + kPreparing * (1.0 - from);
    auto prepared = prepareScans(*snapshot, settings, part(control, from, prepared_at), feed_.get());
    if (!prepared) return fail(prepared.error());

    OperationResult outcome;
    outcome.warnings = start->warnings;
    RelaxationInput input;
    input.scans = std::move(*prepared);
    auto consistent = consistentLinks(*snapshot, start->links, start->world_from_scan, *pins);
    if (!consistent) return fail(consistent.error());
    outcome.warnings.insert(outcome.warnings.end(), consistent->warnings.begin(), consistent->warnings.end());
    input.world_from_scan = std::move(consistent->world_from_scan);
    input.pins = *pins;
    addLinks(*snapshot, consistent->links, input);
    if (feed_) feed_->began(beginningOf(*snapshot, input, settings));

    const std::vector<PreparedScanPtr> scans = input.scans;
    const std::vector<Pose> started_at = input.world_from_scan;
    const double relaxed_at = 1.0 - kJudging * (1.0 - prepared_at);
    auto result = relax(std::move(input), settings.relaxation, settings.threads,
                        part(control, prepared_at, relaxed_at), watchFor(feed_.get(), control.stop));
    if (!result) return fail(result.error());
    std::vector<Link> found = newLinks(*snapshot, start->links, *result);
    if (Status status = judgeFound(*snapshot, scans, started_at, settings.threads,
                                   part(control, relaxed_at, 1.0), found);
        !status)
      return fail(status.error());
    outcome.warnings.insert(outcome.warnings.end(), result->warnings.begin(), result->warnings.end());

    nlohmann::json report = reportOf(*result);
    report["milliseconds"] =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
    report["registered_first"] = start->registered_first;
    report["method"] = methodName(settings);
    report["pins"] = *pins;
    report["warnings"] = outcome.warnings;
    outcome.report_json = report.dump();

    outcome.edit = editOf(snapshot, std::move(*start), std::move(found), *result);
    return outcome;
  }

 private:
  std::shared_ptr<RelaxationFeed> feed_;  // null: nobody watches
};

}  // namespace

std::unique_ptr<Operation> makeRelaxOperation(std::shared_ptr<RelaxationFeed> feed) {
  return std::make_unique<RelaxOperation>(std::move(feed));
}

}  // namespace tiltmap
