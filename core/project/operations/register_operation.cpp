#include "core/project/operations/register_operation.h"

#include <atomic>
#include <chrono>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/parallel.h"
#include "core/project/operations/pair_links.h"
#include "core/project/operations/pair_list.h"
#include "core/registration/pair_judgement.h"
#include "core/registration/register_pair.h"

namespace tiltmap {

namespace {

struct RegisterSettings {
  RegistrationSettings registration;
  std::string pairs;
  int threads = 0;
};

const ParameterTable<RegisterSettings>& registerTable() {
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

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

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

// A pair as it came out, and whether it can be trusted.
struct JudgedPair {
  PairResult result;
  PairJudgement judgement;
};

using PreparedByIndex = std::map<int, Result<PreparedScanPtr>>;

// Each scan that a pair names, prepared once and shared; one matrix a thread in memory.
Result<PreparedByIndex> prepareScans(const ProjectSnapshot& snapshot, const std::vector<IndexPair>& pairs,
                                     const RegisterSettings& settings, Counter& counter,
                                     const JobControl& control) {
  PreparedByIndex prepared;
  for (const auto& [fixed, moving] : pairs) {
    prepared.emplace(fixed, PreparedScanPtr());
    prepared.emplace(moving, PreparedScanPtr());
  }
  std::vector<PreparedByIndex::value_type*> slots;
  for (auto& entry : prepared) slots.push_back(&entry);
  parallelFor(slots.size(), settings.threads, [&](std::size_t i) {
    if (control.stopRequested()) return;
    auto& [index, slot] = *slots[i];
    slot = snapshot.scans()[static_cast<std::size_t>(index)].scan().map(
        [&](const Scan& scan) { return prepare(scan, settings.registration); });
    counter.finished("preparing scan " + std::to_string(index));
  });
  if (control.stopRequested())
    return fail(kCancelled, "register", "nothing was changed; start again when you like");
  for (const auto& [index, slot] : prepared)
    if (!slot) return fail(slot.error());
  return prepared;
}

nlohmann::json pairJson(const IndexPair& pair, const JudgedPair& judged, double milliseconds) {
  const PairResult& result = judged.result;
  const Eigen::Vector3d& t = result.fixed_from_moving.translation();
  const Eigen::Quaterniond& q = result.fixed_from_moving.quaternion();
  return {{"fixed", pair.first},
          {"moving", pair.second},
          {"milliseconds", milliseconds},
          {"iterations", result.iterations},
          {"correspondences", result.correspondences},
          {"rms_m", result.rms_m},
          {"overlap", result.overlap},
          {"agreement", result.agreement},
          {"stop_reason", stopReasonName(result.stop_reason)},
          {"succeeded", result.succeeded()},
          {"verdict", verdictName(judged.judgement.verdict)},
          {"verdict_reason", judged.judgement.reason},
          {"fixed_from_moving",
           {{"translation_m", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}}}};
}

class RegisterOperation : public SettingsOperation<RegisterSettings> {
 public:
  RegisterOperation() : SettingsOperation(registerTable()) {}
  std::string title() const override { return "Register pairs"; }
  std::string help() const override {
    return "Finds the motion between pairs of scans from their range matrices, starting from the odometry, "
           "and chains "
           "the results into the stage `pairwise`.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const RegisterSettings& settings) const override {
    if (snapshot.scans().size() < 2)
      return fail("registration needs two scans; the project has " + std::to_string(snapshot.scans().size()),
                  snapshot.path().string(), "import, simulate or capture more scans first");
    if (auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot.scans().size())); !pairs)
      return fail(pairs.error());
    return tiltmap::checkSettings(settings.registration);
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const RegisterSettings& settings,
                                      const JobControl& control) const override {
    const auto started = std::chrono::steady_clock::now();
    auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot->scans().size()));
    if (!pairs) return fail(pairs.error());
    Counter counter(control, 2 * pairs->size() + 1);
    auto prepared = prepareScans(*snapshot, *pairs, settings, counter, control);
    if (!prepared) return fail(prepared.error());

    std::vector<Result<JudgedPair>> results(pairs->size(), JudgedPair());
    parallelFor(pairs->size(), settings.threads, [&](std::size_t i) {
      const auto [fixed, moving] = (*pairs)[i];
      const Pose start = odometryStart(snapshot->scans()[static_cast<std::size_t>(fixed)],
                                       snapshot->scans()[static_cast<std::size_t>(moving)]);
      const PreparedScanPtr &at_fixed = *prepared->at(fixed), &at_moving = *prepared->at(moving);
      results[i] = registerPair(at_fixed, at_moving, start, settings.registration, control)
                       .map([&](PairResult result) {
                         const PairClaim claim = claimOf(result, start);
                         return JudgedPair{std::move(result),
                                           judgePair(*judgedScan(at_fixed), *judgedScan(at_moving), claim)};
                       });
      counter.finished("registered " + std::to_string(moving) + " to " + std::to_string(fixed));
    });

    OperationResult outcome;
    std::vector<Link> links;
    nlohmann::json report = {{"pairs", nlohmann::json::array()}};
    for (std::size_t i = 0; i < pairs->size(); ++i) {
      if (!results[i]) return fail(results[i].error());
      const PairResult& result = results[i]->result;
      const auto [fixed, moving] = (*pairs)[i];
      // Preparation is shared between pairs, but a pair's time counts from its two raw matrices.
      const double milliseconds =
          (*prepared->at(fixed))->milliseconds + (*prepared->at(moving))->milliseconds + result.milliseconds;
      const ScanId fixed_id = snapshot->scans()[static_cast<std::size_t>(fixed)].id;
      const ScanId moving_id = snapshot->scans()[static_cast<std::size_t>(moving)].id;
      links.push_back(judgedLink(pairLink(fixed_id, moving_id, result, milliseconds), results[i]->judgement));
      report["pairs"].push_back(pairJson((*pairs)[i], *results[i], milliseconds));
      if (!result.succeeded())
        outcome.warnings.push_back("scan " + std::to_string(moving) + " was not registered to scan " +
                                   std::to_string(fixed) + " (" + stopReasonName(result.stop_reason) +
                                   "): it keeps its odometry. " + stopReasonSentence(result.stop_reason));
      else if (results[i]->judgement.verdict == Verdict::Bad)
        outcome.warnings.push_back("scan " + std::to_string(moving) + " on scan " + std::to_string(fixed) +
                                   " is not to be trusted: " + results[i]->judgement.reason);
    }
    report["milliseconds"] = millisecondsSince(started);
    outcome.report_json = report.dump();
    outcome.edit = pairLinksEdit(snapshot, std::move(links));
    return outcome;
  }
};

}  // namespace

std::unique_ptr<Operation> makeRegisterOperation() {
  return std::make_unique<RegisterOperation>();
}

}  // namespace tiltmap
