#include "core/project/operations/register_pairs.h"

#include <algorithm>
#include <atomic>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/parallel.h"
#include "core/project/odometry_check.h"
#include "core/project/operations/pair_links.h"
#include "core/registration/heading_search.h"

namespace tiltmap {

namespace {

// Pairs that are worked on together: enough to keep all threads busy, few enough to hold their scans.
constexpr std::size_t kBlock = 64;

// Counts finished pieces over all threads, for progress.
class Counter {
 public:
  Counter(const JobControl& control, std::size_t total) : control_(control), total_(total) {}
  void finished(const std::string& what) {
    const std::size_t done = ++done_;
    control_.tell(static_cast<double>(done) / static_cast<double>(total_), what);
  }

 private:
  const JobControl& control_;
  std::size_t total_;
  std::atomic<std::size_t> done_ = 0;
};

// A scan as the pairs need it, from its first pair to its last.
struct HeldScan {
  PreparedScanPtr prepared;
  JudgedScanPtr judged;
  std::size_t last = 0;  // pair that needs it
};

class PairRun {
 public:
  PairRun(const ProjectSnapshot& snapshot, const std::vector<IndexPair>& pairs,
          const RegisterSettings& settings, const JobControl& control)
      : snapshot_(snapshot), pairs_(pairs), settings_(settings), control_(control) {
    for (std::size_t k = 0; k < pairs.size(); ++k)
      for (const int scan : {pairs[k].first, pairs[k].second}) scans_[scan].last = k;
  }

  Result<std::vector<RegisteredPair>> run() {
    Counter counter(control_, scans_.size() + pairs_.size());
    std::vector<RegisteredPair> found(pairs_.size());
    for (std::size_t begin = 0; begin < pairs_.size(); begin += kBlock) {
      const std::size_t end = std::min(begin + kBlock, pairs_.size());
      if (Status status = hold(begin, end, counter); !status) return fail(status.error());
      std::vector<Status> ended(end - begin);
      parallelFor(end - begin, settings_.threads, [&](std::size_t i) {
        ended[i] = one(pairs_[begin + i], found[begin + i]);
        counter.finished("registered " + std::to_string(pairs_[begin + i].second) + " to " +
                         std::to_string(pairs_[begin + i].first));
      });
      for (const Status& status : ended)
        if (!status) return fail(status.error());
      std::erase_if(scans_, [end](const auto& scan) { return scan.second.last < end; });
    }
    return found;
  }

 private:
  // The scans that these pairs need and that are not there yet.
  Status hold(std::size_t begin, std::size_t end, Counter& counter) {
    std::vector<std::pair<int, HeldScan*>> missing;
    for (std::size_t k = begin; k < end; ++k)
      for (const int scan : {pairs_[k].first, pairs_[k].second}) {
        HeldScan& held = scans_.at(scan);
        const auto named = [scan](const auto& other) { return other.first == scan; };
        if (!held.prepared && std::ranges::none_of(missing, named)) missing.emplace_back(scan, &held);
      }
    std::vector<Status> ended(missing.size());
    parallelFor(missing.size(), settings_.threads, [&](std::size_t i) {
      if (control_.stopRequested()) return;
      auto& [index, held] = missing[i];
      ended[i] = snapshot_.scans()[static_cast<std::size_t>(index)].scan().map([&](const Scan& scan) {
        held->prepared = prepare(scan, settings_.registration);
        held->judged = judgedScan(held->prepared);
      });
      counter.finished("preparing scan " + std::to_string(index));
    });
    if (control_.stopRequested())
      return fail(kCancelled, "register", "nothing was changed; start again when you like");
    for (const Status& status : ended)
      if (!status) return status;
    return {};
  }

  Status one(const IndexPair& pair, RegisteredPair& found) const {
    const auto [fixed, moving] = pair;
    const Pose start = odometryStart(snapshot_.scans()[static_cast<std::size_t>(fixed)],
                                     snapshot_.scans()[static_cast<std::size_t>(moving)]);
    const HeldScan &at_fixed = scans_.at(fixed), &at_moving = scans_.at(moving);
    return registerAndSearch(at_fixed.prepared, at_moving.prepared, *at_fixed.judged, *at_moving.judged,
                             start, settings_.registration, control_)
        .map([&](SearchedPair searched) {
          searched.result.steps.clear();
          found.fixed = fixed;
          found.moving = moving;
          found.judgement = std::move(searched.judgement);
          // Preparation is shared between pairs, but a pair's time counts from its two raw matrices.
          found.milliseconds = at_fixed.prepared->milliseconds + at_moving.prepared->milliseconds +
                               searched.result.milliseconds;
          found.result = std::move(searched.result);
        });
  }

  const ProjectSnapshot& snapshot_;
  const std::vector<IndexPair>& pairs_;
  const RegisterSettings& settings_;
  const JobControl& control_;
  std::map<int, HeldScan> scans_;
};

nlohmann::json pairJson(const RegisteredPair& pair) {
  const PairResult& result = pair.result;
  const Eigen::Vector3d& t = result.fixed_from_moving.translation();
  const Eigen::Quaterniond& q = result.fixed_from_moving.quaternion();
  return {{"fixed", pair.fixed},
          {"moving", pair.moving},
          {"milliseconds", pair.milliseconds},
          {"iterations", result.iterations},
          {"correspondences", result.correspondences},
          {"rms_m", result.rms_m},
          {"overlap", result.overlap},
          {"agreement", result.agreement},
          {"stop_reason", stopReasonName(result.stop_reason)},
          {"succeeded", result.succeeded()},
          {"verdict", verdictName(pair.judgement.verdict)},
          {"verdict_reason", pair.judgement.reason},
          {"fixed_from_moving",
           {{"translation_m", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}}}};
}

nlohmann::json pairsJson(const std::vector<RegisteredPair>& pairs) {
  nlohmann::json array = nlohmann::json::array();
  for (const RegisteredPair& pair : pairs) array.push_back(pairJson(pair));
  return array;
}

}  // namespace

const ParameterTable<RegisterSettings>& registerParameters() {
  static const ParameterTable<RegisterSettings> table = [] {
    ParameterTable<RegisterSettings> t("register");
    t.text("pairs", &RegisterSettings::pairs,
           "Pairs to register, as FIXED:MOVING,...; empty: every scan with the one before it",
           "thesis 5.1: consecutive scans");
    t.integer("threads", &RegisterSettings::threads, "", 0, 256,
              "Threads to use, 0 for all cores; the result does not depend on it", "ours");
    t.include(registrationParameters(), &RegisterSettings::registration);
    return t;
  }();
  return table;
}

Status checkRegister(const ProjectSnapshot& snapshot, const RegisterSettings& settings) {
  if (snapshot.scans().size() < 2)
    return fail("registration needs two scans; the project has " + std::to_string(snapshot.scans().size()),
                snapshot.path().string(), "import, simulate or capture more scans first");
  if (auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot.scans().size())); !pairs)
    return fail(pairs.error());
  return checkSettings(settings.registration);
}

Result<std::vector<RegisteredPair>> registerPairs(const ProjectSnapshot& snapshot,
                                                  const std::vector<IndexPair>& pairs,
                                                  const RegisterSettings& settings,
                                                  const JobControl& control) {
  return PairRun(snapshot, pairs, settings, control).run();
}

OperationResult registeredOutcome(const SnapshotPtr& snapshot, const std::vector<RegisteredPair>& pairs,
                                  double milliseconds) {
  OperationResult outcome;
  std::vector<Link> links;
  for (const RegisteredPair& pair : pairs) {
    const PairResult& result = pair.result;
    const ScanId fixed_id = snapshot->scans()[static_cast<std::size_t>(pair.fixed)].id;
    const ScanId moving_id = snapshot->scans()[static_cast<std::size_t>(pair.moving)].id;
    links.push_back(judgedLink(pairLink(fixed_id, moving_id, result, pair.milliseconds), pair.judgement));
    const std::string fixed = std::to_string(pair.fixed), moving = std::to_string(pair.moving);
    if (!result.succeeded())
      outcome.warnings.push_back("scan " + moving + " was not registered to scan " + fixed + " (" +
                                 stopReasonName(result.stop_reason) + "): it keeps its odometry. " +
                                 stopReasonSentence(result.stop_reason));
    else if (pair.judgement.verdict == Verdict::Bad)
      outcome.warnings.push_back("scan " + moving + " on scan " + fixed +
                                 " is not to be trusted: " + pair.judgement.reason);
  }
  nlohmann::json report = {{"pairs", pairsJson(pairs)},
                           {"milliseconds", milliseconds},
                           {"overruled_odometry", nlohmann::json::array()}};
  outcome.edit = pairLinksEdit(snapshot, std::move(links));
  for (const OverruledRow& row : overruledRows(*snapshot, outcome.edit)) {
    report["overruled_odometry"].push_back(
        {{"scan", row.scan}, {"off_m", row.off_m}, {"off_deg", row.off_rad / kDegree}});
    outcome.warnings.push_back(row.sentence());
  }
  outcome.report_json = report.dump();
  return outcome;
}

std::string registeredPairsJson(const std::vector<RegisteredPair>& pairs) {
  return pairsJson(pairs).dump();
}

}  // namespace tiltmap
