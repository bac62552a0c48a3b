#include "core/project/operations/relax_start.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>

#include "core/base/parallel.h"
#include "core/project/link_what_if.h"
#include "core/project/operations/register_operation.h"
#include "core/project/operations/relax_operation.h"

namespace tiltmap {

namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Registers the pairs (empty: every scan to the one before it) and takes links and poses into the start.
Status registerFirst(const SnapshotPtr& snapshot, const std::string& pairs, const RelaxSettings& settings,
                     const JobControl& control, RelaxStart& start, std::vector<Pose>& pairwise) {
  const auto registration = makeRegisterOperation();
  const bool thesis = settings.relaxation.method == RelaxationMethod::ActiveSet;
  auto values = registration->presetValues(thesis ? "thesis" : "default");
  if (!values) return fail(values.error());
  (*values)["threads"] = static_cast<long long>(settings.threads);
  (*values)["pairs"] = pairs;
  auto registered = registration->run(snapshot, *values, control);
  if (!registered) return fail(registered.error());
  start.registered_first = true;
  start.steps = std::move(registered->edit.steps);
  start.warnings.insert(start.warnings.end(), registered->warnings.begin(), registered->warnings.end());
  // The order of the scans, as filledPoses gives it.
  for (const EditStep& step : start.steps) {
    if (const auto* added = std::get_if<AddLinks>(&step)) {
      JoinedPairs replaced;
      for (const Link& link : added->links) replaced.add(link.fixed, link.moving);
      replaced.sort();
      std::erase_if(start.links, [&](const Link& old) {
        return old.origin == LinkOrigin::Automatic && replaced.contains(old.fixed, old.moving);
      });
      start.links.insert(start.links.end(), added->links.begin(), added->links.end());
    }
    if (const auto* poses = std::get_if<SetPoses>(&step))
      for (const auto& [id, pose] : poses->poses) pairwise.push_back(pose);
  }
  if (pairwise.size() != snapshot->scans().size())
    throw std::logic_error("relax: the registration did not place every scan");
  return {};
}

// Everything but where it is said which scans, and how many threads.
ParameterValues computedFrom(const RelaxSettings& settings) {
  ParameterValues values = relaxParameters().values(settings);
  for (const char* name : {"pin", "threads", "extent", "judge"}) values.erase(name);
  return values;
}

// The last accepted relaxation; null where there is none or it had other parameters.
const JobRecord* lastRelaxation(const ProjectSnapshot& snapshot, const RelaxSettings& settings) {
  const ParameterTable<RelaxSettings>& table = relaxParameters();
  const JobRecord* last = nullptr;
  for (const JobRecord& job : snapshot.jobs())
    if (job.operation == table.operation() && job.state == JobState::Accepted) last = &job;
  if (!last) return nullptr;
  ParameterValues known;
  for (const ParameterInfo& info : table.infos())
    if (const auto value = last->values.find(info.name); value != last->values.end()) known.insert(*value);
  RelaxSettings used;
  if (!table.apply(known, used) || computedFrom(used) != computedFrom(settings)) return nullptr;
  return last;
}

// Edits that add scans, tell of scans or concern added ones only, by the words that their titles begin with.
// Registering two scans that were relaxed takes the stage `relaxed` away, so what is left concerns others.
// What is not known here counts as a change.
bool leavesRelaxedAlone(const std::string& title) {
  static constexpr std::array kBeginnings = {"import ",     "capture ",   "register ",   "accept scan ",
                                             "judge ",      "rename to ", "note",        "colour of ",
                                             "survey data", "photograph", "remove a pho"};
  return std::ranges::any_of(kBeginnings, [&](const char* words) { return title.starts_with(words); });
}

bool changedSince(const ProjectSnapshot& snapshot, const JobRecord& relaxation) {
  return std::ranges::any_of(snapshot.history(), [&](const HistoryEntry& edit) {
    const bool its_own = edit.title.find("relax ") != std::string::npos;
    return !edit.undone && edit.time > relaxation.finished && !its_own && !leavesRelaxedAlone(edit.title);
  });
}

}  // namespace

void JoinedPairs::add(ScanId a, ScanId b) {
  pairs_.emplace_back(std::minmax(a, b));
}
void JoinedPairs::sort() {
  std::ranges::sort(pairs_);
}
bool JoinedPairs::contains(ScanId a, ScanId b) const {
  return std::ranges::binary_search(pairs_, std::pair<ScanId, ScanId>(std::minmax(a, b)));
}

const ParameterTable<RelaxSettings>& relaxParameters() {
  static const ParameterTable<RelaxSettings> table = [] {
    ParameterTable<RelaxSettings> t("relax");
    t.text(
        "pin", &RelaxSettings::pin,
        "Scans that never move, such as 0,5 or 0-3, beside those pinned in the project; scan 0 never does, "
        "named or not",
        "ours; thesis 6.2");
    t.choice("extent", &RelaxSettings::extent, {{"new", RelaxExtent::New}, {"all", RelaxExtent::All}},
             "new: where only scans have come since the last relaxation (joint, same parameters), those are "
             "put onto the others, which costs a few stops' time; else, and with all, everything anew.",
             "ours");
    t.boolean(
        "judge", &RelaxSettings::judge,
        "Hold the scans of each link that is found against each other, so that its verdict stands beside "
        "those of registered links; 1 to 2 ms a link. Without, `tiltmap link judge` does it later",
        "ours");
    t.integer("threads", &RelaxSettings::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    t.include(relaxationParameters(), &RelaxSettings::relaxation);
    return t;
  }();
  return table;
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

Result<RelaxStart> startOf(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                           const JobControl& control) {
  RelaxStart start;
  start.links = snapshot->links();
  if (snapshot->hasStage(Stage::Pairwise)) {
    start.world_from_scan = snapshot->filledPoses(Stage::Pairwise);
    return start;
  }
  start.warnings.emplace_back(
      "the project had no pairwise poses, so every scan was registered to the one before it first");
  if (Status status = registerFirst(snapshot, "", settings, control, start, start.world_from_scan); !status)
    return fail(status.error());
  return start;
}

std::vector<int> addedSinceRelaxation(const ProjectSnapshot& snapshot, const RelaxSettings& settings,
                                      const std::vector<int>& pins) {
  if (settings.extent == RelaxExtent::All || settings.relaxation.method != RelaxationMethod::Joint) return {};
  const auto relaxed = snapshot.poses(Stage::Relaxed);
  std::vector<int> added;
  for (std::size_t i = 0; i < relaxed.size(); ++i)
    if (!relaxed[i]) added.push_back(static_cast<int>(i));
  if (added.empty() || 3 * added.size() > relaxed.size() || added.front() == 0) return {};
  if (std::ranges::any_of(pins, [&](int pin) { return !relaxed[at(pin)]; })) return {};
  const JobRecord* last = lastRelaxation(snapshot, settings);
  if (!last || changedSince(snapshot, *last)) return {};
  return added;
}

Result<RelaxStart> startOfAdded(const SnapshotPtr& snapshot, const std::vector<int>& added,
                                const RelaxSettings& settings, const JobControl& control) {
  RelaxStart start;
  start.links = snapshot->links();
  JoinedPairs joined;
  for (const Link& link : start.links) joined.add(link.fixed, link.moving);
  joined.sort();
  std::string pairs;
  for (const int i : added) {
    if (joined.contains(snapshot->scans()[at(i - 1)].id, snapshot->scans()[at(i)].id)) continue;
    pairs += (pairs.empty() ? "" : ",") + std::to_string(i - 1) + ":" + std::to_string(i);
  }
  std::vector<Pose> pairwise;
  if (pairs.empty()) {
    pairwise = snapshot->filledPoses(Stage::Pairwise);
  } else if (Status status = registerFirst(snapshot, pairs, settings, control, start, pairwise); !status) {
    return fail(status.error());
  }
  for (std::size_t i = 0; i < pairwise.size(); ++i) {
    const auto relaxed = snapshot->scans()[i].pose(Stage::Relaxed);
    start.world_from_scan.push_back(
        relaxed ? *relaxed : start.world_from_scan[i - 1] * (pairwise[i - 1].inverse() * pairwise[i]));
  }
  return start;
}

Result<std::vector<PreparedScanPtr>> preparedScans(const ProjectSnapshot& snapshot,
                                                   const std::vector<int>& which,
                                                   const RelaxSettings& settings, const JobControl& control,
                                                   RelaxationFeed* feed) {
  std::vector<Result<PreparedScanPtr>> slots(which.size(), PreparedScanPtr());
  std::atomic<std::size_t> done = 0;
  parallelFor(which.size(), settings.threads, [&](std::size_t k) {
    if (feed) feed->waitWhilePaused(control.stop);
    if (control.stopRequested()) return;
    slots[k] = snapshot.scans()[static_cast<std::size_t>(which[k])].scan().map(
        [&](const Scan& scan) { return prepare(scan, settings.relaxation.registration); });
    control.tell(static_cast<double>(++done) / static_cast<double>(which.size()),
                 "preparing scan " + std::to_string(which[k]));
  });
  if (control.stopRequested())
    return fail(kCancelled, "relax", "nothing was changed; start it again when you like");
  std::vector<PreparedScanPtr> prepared(snapshot.scans().size(), std::make_shared<const PreparedScan>());
  for (std::size_t k = 0; k < which.size(); ++k) {
    if (!slots[k]) return fail(slots[k].error());
    prepared[static_cast<std::size_t>(which[k])] = *slots[k];
  }
  return prepared;
}

}  // namespace tiltmap
