#include "core/project/operations/link_operation.h"

#include <nlohmann/json.hpp>

#include "core/project/operations/pair_links.h"
#include "core/registration/pair_judgement.h"
#include "core/registration/register_pair.h"

namespace tiltmap {

namespace {

enum class LinkMethod { Register, AsPlaced };
enum class LinkStart { Latest, Odometry, Pairwise, Relaxed };

struct LinkSettings {
  int fixed = 0;
  int moving = 1;
  LinkMethod method = LinkMethod::Register;
  LinkStart start = LinkStart::Latest;
  RegistrationSettings registration;
};

const ParameterTable<LinkSettings>& linkTable() {
  static const ParameterTable<LinkSettings> table = [] {
    ParameterTable<LinkSettings> t("link");
    t.integer("fixed", &LinkSettings::fixed, "", 0, 1e6, "Index of the scan that stays", "ours");
    t.integer("moving", &LinkSettings::moving, "", 0, 1e6, "Index of the scan that is fitted to it", "ours");
    t.choice<LinkMethod>(
        "method", &LinkSettings::method,
        {{"register", LinkMethod::Register}, {"as-placed", LinkMethod::AsPlaced}},
        "register: fit the surfaces; as-placed: take the poses as they are, as a link set by "
        "hand",
        "ours");
    t.choice<LinkStart>("start", &LinkSettings::start,
                        {{"latest", LinkStart::Latest},
                         {"odometry", LinkStart::Odometry},
                         {"pairwise", LinkStart::Pairwise},
                         {"relaxed", LinkStart::Relaxed}},
                        "Stage whose poses are the start; latest: the last one there is", "ours");
    t.include(registrationParameters(), &LinkSettings::registration);
    return t;
  }();
  return table;
}

Result<Stage> stageOf(const ProjectSnapshot& snapshot, LinkStart start) {
  const Stage stage = start == LinkStart::Odometry   ? Stage::Odometry
                      : start == LinkStart::Pairwise ? Stage::Pairwise
                      : start == LinkStart::Relaxed  ? Stage::Relaxed
                                                     : snapshot.latestStage();
  if (!snapshot.hasStage(stage))
    return fail("the project has no " + stageName(stage) + " poses", snapshot.path().string(),
                "start from another stage");
  return stage;
}

Result<Link> registered(const Scan& fixed, const Scan& moving, const Pose& start,
                        const LinkSettings& settings, const JobControl& control) {
  const auto found = registerPair(fixed, moving, start, settings.registration, control);
  if (!found) return fail(found.error());
  if (!found->succeeded())
    return fail("the two scans could not be registered: " + stopReasonName(found->stop_reason),
                fixed.name + " and " + moving.name, stopReasonSentence(found->stop_reason));
  Link link;
  link.fixed_from_moving = found->fixed_from_moving;
  link.iterations = found->iterations;
  link.correspondences = static_cast<int>(found->correspondences);
  link.rms_m = found->rms_m;
  link.overlap = found->overlap;
  link.milliseconds = found->milliseconds;
  link.stop_reason = stopReasonName(found->stop_reason);
  link.succeeded = true;
  link.information = found->information;
  return link;
}

// The figures that a registration would begin with: its pairs are found before it moves anything.
Result<Link> asPlaced(const Scan& fixed, const Scan& moving, const Pose& start, const LinkSettings& settings,
                      const JobControl& control) {
  Registration registration(fixed, moving, start, settings.registration);
  const StepReport step = registration.step(control.stop);
  if (control.stopRequested())
    return fail(kCancelled, "link", "nothing was changed; start again when you like");
  Link link;
  link.fixed_from_moving = start;
  link.correspondences = static_cast<int>(step.pairs);
  link.rms_m = step.rms_m;
  link.overlap = step.overlap;
  link.stop_reason = "set by hand";
  link.succeeded = true;
  link.origin = LinkOrigin::ByHand;
  return link;
}

class LinkOperation : public SettingsOperation<LinkSettings> {
 public:
  LinkOperation() : SettingsOperation(linkTable()) {}
  std::string title() const override { return "Link two scans"; }
  std::string help() const override {
    return "Adds a link between two scans, starting from where they stand now: registered, or as they are "
           "placed. No pose moves until the survey is relaxed.";
  }

 protected:
  Status checkSettings(const ProjectSnapshot& snapshot, const LinkSettings& settings) const override {
    if (auto fixed = snapshot.scanAt(settings.fixed); !fixed) return fail(fixed.error());
    if (auto moving = snapshot.scanAt(settings.moving); !moving) return fail(moving.error());
    if (settings.fixed == settings.moving)
      return fail("a scan cannot be linked to itself", "scan " + std::to_string(settings.fixed),
                  "choose two different scans");
    if (auto stage = stageOf(snapshot, settings.start); !stage) return fail(stage.error());
    return tiltmap::checkSettings(settings.registration);
  }

  Result<OperationResult> runSettings(const SnapshotPtr& snapshot, const LinkSettings& settings,
                                      const JobControl& control) const override {
    if (Status status = checkSettings(*snapshot, settings); !status) return fail(status.error());
    const auto index = [](int i) { return static_cast<std::size_t>(i); };
    const ScanEntry& fixed = snapshot->scans()[index(settings.fixed)];
    const ScanEntry& moving = snapshot->scans()[index(settings.moving)];
    const std::vector<Pose> poses = snapshot->filledPoses(*stageOf(*snapshot, settings.start));
    const Pose start = poses[index(settings.fixed)].inverse() * poses[index(settings.moving)];
    control.tell(0.1, "reading the scans");
    const auto fixed_scan = fixed.scan(), moving_scan = moving.scan();
    if (!fixed_scan) return fail(fixed_scan.error());
    if (!moving_scan) return fail(moving_scan.error());
    control.tell(0.2, "linking " + std::to_string(settings.moving) + " to " + std::to_string(settings.fixed));
    auto found = settings.method == LinkMethod::Register
                     ? registered(*fixed_scan, *moving_scan, start, settings, control)
                     : asPlaced(*fixed_scan, *moving_scan, start, settings, control);
    if (!found) return fail(found.error());
    PairClaim claim;
    claim.fixed_from_moving = found->fixed_from_moving;
    claim.start = start;
    claim.succeeded = true;
    const RegistrationSettings preparing;
    Link link =
        judgedLink(std::move(*found), judgePair(*judgedScan(prepare(*fixed_scan, preparing)),
                                                *judgedScan(prepare(*moving_scan, preparing)), claim));
    link.fixed = fixed.id;
    link.moving = moving.id;
    const PoseDifference moved = difference(start, link.fixed_from_moving);
    OperationResult outcome;
    outcome.report_json = nlohmann::json({{"fixed", settings.fixed},
                                          {"moving", settings.moving},
                                          {"overlap", link.overlap},
                                          {"rms_m", link.rms_m},
                                          {"correspondences", link.correspondences},
                                          {"verdict", verdictName(link.judgement->verdict)},
                                          {"verdict_reason", link.judgement->reason},
                                          {"moved_m", moved.translation_m},
                                          {"moved_deg", moved.rotation_rad / kDegree},
                                          {"stop_reason", link.stop_reason},
                                          {"milliseconds", link.milliseconds}})
                              .dump();
    outcome.edit.title = "link " + std::to_string(settings.moving) + " to " + std::to_string(settings.fixed);
    outcome.edit.base = snapshot;
    outcome.edit.concerned = {fixed.id, moving.id};
    outcome.edit.steps.emplace_back(AddLinks{{std::move(link)}, true});
    return outcome;
  }
};

}  // namespace

std::unique_ptr<Operation> makeLinkOperation() {
  return std::make_unique<LinkOperation>();
}

}  // namespace tiltmap
