#include "core/calibration/calibrate.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/base/ranks.h"
#include "core/base/text.h"
#include "core/calibration/calibration_file.h"
#include "core/calibration/calibration_system.h"
#include "core/calibration/ground_tilt.h"
#include "core/multiview/relaxation.h"

namespace tiltmap {

namespace {

constexpr double kWidest_m = 0.2;  // of the loss, at first
constexpr double kNarrowest_m = 0.001;
constexpr double kNarrowing = 0.6;
constexpr int kMostSteps = 30;
constexpr double kFirstNarrowest_m = 0.005;             // before pairs are looked for anew
constexpr double kAtRest = 0.05;                        // of the errors' deviations
constexpr double kAtRest_rad = 5e-5, kAtRest_m = 5e-4;  // of the poses
constexpr double kGate_m = 0.05;                        // residuals before and after are compared within this
// What the light's spot and the steps of the ranges do alike in every pair, which no comparison of pairs
// shows; from simulated drives.
constexpr double kSameAngle_rad = 0.005 * kDegree, kSameLength_m = 0.001;
constexpr double kLargestAngle_rad = 3.0 * kDegree;  // what an error may be, one sigma
constexpr double kLargestLength_m = 0.2;
constexpr double kAlike = 0.8;           // correlation from which an error is named as the reason for another
constexpr std::size_t kMostScans = 150;  // the equations are solved whole
constexpr std::size_t kFewestPatches = 200;

RelaxationSettings relaxationFor() {
  RelaxationSettings settings;
  settings.registration.patch_grouping = PatchGrouping::Blocks;
  return settings;
}

double limitOf(ScannerError error, const CalibrationSettings& settings) {
  return isAngle(error) ? settings.angle_limit_rad : settings.length_limit_m;
}

bool asked(ScannerError error, const CalibrationSettings& settings) {
  switch (error) {
    case ScannerError::TiltZero:
      return settings.tilt_zero;
    case ScannerError::LeverX:
    case ScannerError::LeverY:
    case ScannerError::LeverZ:
      return settings.lever_arm;
    case ScannerError::MountingX:
    case ScannerError::MountingY:
    case ScannerError::MountingZ:
      return settings.mounting;
    case ScannerError::RangeOffset:
      return settings.range_offset;
  }
  return false;
}

bool toldByOverlap(ScannerError error) {
  return error != ScannerError::TiltZero && error != ScannerError::LeverX && error != ScannerError::MountingX;
}

Status checkScans(const std::vector<Scan>& scans, const std::vector<Pose>& poses) {
  if (scans.size() != poses.size())
    throw std::invalid_argument("calibrate: as many poses as scans are needed");
  if (scans.size() < 3)
    return fail(
        "a calibration needs three overlapping scans or more, and there are " + std::to_string(scans.size()),
        "calibrate", "take scans from more places, with different headings");
  if (scans.size() > kMostScans)
    return fail(std::to_string(scans.size()) + " scans are more than a calibration works on at once (" +
                    std::to_string(kMostScans) + ")",
                "calibrate", "name some that overlap well, such as --scans 0-39");
  for (const Scan& scan : scans) {
    if (!scan.image || !scan.image->isRegular())
      return fail("scan " + scan.name + " is no regular range matrix, so its beams cannot be aimed anew",
                  "calibrate", "leave it out (--scans)");
    if (!sameCalibration(scan.geometry, scans.front().geometry))
      return fail("scan " + scan.name + " has another calibration than " + scans.front().name, "calibrate",
                  "calibrate the scans of each on their own (--scans)");
  }
  return {};
}

class Calibrator {
 public:
  Calibrator(const std::vector<Scan>& scans, const std::vector<Pose>& poses,
             const CalibrationSettings& settings, int threads, const JobControl& control)
      : scans_(scans), poses_(poses), settings_(settings), threads_(threads), control_(control) {
    stored_ = scans.front().geometry;
    for (const ScannerError error : kAllScannerErrors) {
      const double largest = isAngle(error) ? kLargestAngle_rad : kLargestLength_m;
      prior_.deviation[static_cast<int>(error)] = largest;
      if (toldByOverlap(error) && asked(error, settings)) free_.push_back(error);
    }
  }

  Result<Calibration> run() {
    if (Status status = relaxed(0.0); !status) return fail(status.error());
    if (Status status = enough(); !status) return fail(status.error());
    auto before = fitted({}, kGate_m, 0.1);
    if (!before) return fail(before.error());
    result_.residual_before_m = medianResidual(*before);
    if (!free_.empty()) {
      if (auto first = fitted(free_, kFirstNarrowest_m, 0.2); !first) return fail(first.error());
      if (Status status = relaxed(0.45); !status) return fail(status.error());
      if (auto second = fitted(free_, kNarrowest_m, 0.6); !second) return fail(second.error());
      judge();
      if (std::erase_if(free_, [this](ScannerError e) { return estimate(e).state == EstimateState::Weak; }) >
          0) {
        // What is not told stays as it was, and the rest adapts; its deviation is that with the weak ones
        // free.
        hold();
        if (auto third = fitted(free_, kNarrowest_m, 0.75); !third) return fail(third.error());
      }
    }
    if (auto after = fitted({}, kGate_m, 0.85); !after)
      return fail(after.error());
    else
      result_.residual_after_m = medianResidual(*after);
    tiltZero();
    finish();
    return std::move(result_);
  }

 private:
  Status cancelled() const {
    return fail(kCancelled, "calibrate", "nothing was changed; start it again when you like");
  }

  ErrorEstimate& estimate(ScannerError error) { return estimates_[static_cast<std::size_t>(error)]; }
  ScannerGeometry geometry() const { return corrected(stored_, change_); }

  Status prepareScans() {
    const RelaxationSettings settings = relaxationFor();
    const ScannerGeometry now = geometry();
    prepared_.assign(scans_.size(), nullptr);
    parallelFor(scans_.size(), threads_, [&](std::size_t i) {
      if (control_.stopRequested()) return;
      Scan scan = scans_[i];
      takeCalibration(now, scan.geometry);
      prepared_[i] = prepare(scan, settings.registration);
    });
    if (control_.stopRequested()) return cancelled();
    return {};
  }

  // Poses, and which pairs of scans fit, under the present geometry.
  Status relaxed(double fraction) {
    control_.tell(fraction, "relaxing " + std::to_string(scans_.size()) + " scans");
    if (Status status = prepareScans(); !status) return status;
    RelaxationInput input;
    input.scans = prepared_;
    input.world_from_scan = poses_;
    JobControl quiet;
    quiet.stop = control_.stop;
    auto found = relax(std::move(input), relaxationFor(), threads_, quiet);
    if (!found) return fail(found.error());
    poses_ = found->poses;
    pairs_.clear();
    for (const RelaxationLink& link : found->links)
      if (link.used) pairs_.emplace_back(link.fixed, link.moving);
    unlinked_ = found->unlinked;
    return {};
  }

  Status enough() {
    std::size_t planes = 0;
    for (const PreparedScanPtr& scan : prepared_) planes += scan->discs.size();
    if (planes < kFewestPatches)
      return fail("there are hardly any planes in these scans (" + std::to_string(planes) + " patches)",
                  "calibrate", "take scans where there are walls, kerbs and open ground");
    if (pairs_.size() < 3 || unlinked_.size() + 3 > scans_.size())
      return fail("too few of these scans overlap: " + std::to_string(pairs_.size()) + " pairs do",
                  "calibrate", "register and relax the survey first, and name scans near each other");
    double furthest = 0.0, turned = 0.0;
    for (const Pose& pose : poses_) {
      const PoseDifference from_first = difference(poses_.front(), pose);
      furthest = std::max(furthest, from_first.translation_m);
      turned = std::max(turned, from_first.rotation_rad);
    }
    if (furthest < 0.3 && turned < 5.0 * kDegree)
      return fail("all scans were taken from one place, so each has the same errors as the others",
                  "calibrate", "take scans some metres apart, and with different headings");
    return {};
  }

  // Poses, and the errors named free, until at rest. `narrowest_m`: where the loss's narrowing ends, unless
  // the data's own excess is wider.
  Result<std::vector<CalibrationTerm>> fitted(const std::vector<ScannerError>& free, double narrowest_m,
                                              double fraction) {
    const double deviations = relaxationFor().registration.refine_deviations;
    double excess = kWidest_m;
    std::vector<CalibrationTerm> terms;
    for (int step = 0; step < kMostSteps; ++step) {
      control_.tell(fraction + 0.1 * step / kMostSteps, "fitting, step " + std::to_string(step + 1));
      if (!free.empty() || step == 0)
        if (Status status = prepareScans(); !status) return fail(status.error());
      terms.assign(pairs_.size(), {});
      const ScannerGeometry now = geometry();
      parallelFor(pairs_.size(), threads_, [&](std::size_t k) {
        if (control_.stopRequested()) return;
        const auto [fixed, moving] = pairs_[k];
        const PreparedScan& a = *prepared_[static_cast<std::size_t>(fixed)];
        const PreparedScan& b = *prepared_[static_cast<std::size_t>(moving)];
        const Pose relative =
            poses_[static_cast<std::size_t>(fixed)].inverse() * poses_[static_cast<std::size_t>(moving)];
        const auto cells = cellsOnPatches(a, b, relative, excess, relaxationFor().registration);
        terms[k] = calibrationTerm(fixed, moving, a, b, now, relative, cells, excess, deviations);
      });
      if (control_.stopRequested()) return fail(cancelled().error());
      prior_.departure = change_;
      auto solution = solveCalibration(scans_.size(), terms, free, prior_);
      if (!solution) return fail(solution.error());
      ++result_.iterations;
      for (std::size_t i = 1; i < poses_.size(); ++i)
        poses_[i] = poses_[i] * Pose().moved(solution->motions[i]);
      change_ += solution->change;
      solution_ = std::move(*solution);
      const double own = ownExcess(terms);
      const double next = std::max({narrowest_m, own, kNarrowing * excess});
      const bool settled = next > 0.9 * excess && atRest(free);
      excess = std::min(excess, next);
      if (settled) break;
    }
    return terms;
  }

  static double ownExcess(const std::vector<CalibrationTerm>& terms) {
    std::vector<double> residuals, variances;
    for (const CalibrationTerm& term : terms) {
      residuals.insert(residuals.end(), term.residual_m.begin(), term.residual_m.end());
      variances.insert(variances.end(), term.variance_m2.begin(), term.variance_m2.end());
    }
    return excessDeviation(residuals, variances);
  }

  bool atRest(const std::vector<ScannerError>& free) const {
    for (const ScannerError error : free)
      if (std::abs(solution_.change[static_cast<int>(error)]) > kAtRest * deviationOf(error)) return false;
    for (const Vector6d& motion : solution_.motions)
      if (motion.head<3>().norm() > kAtRest_rad || motion.tail<3>().norm() > kAtRest_m) return false;
    return true;
  }

  double deviationOf(ScannerError error) const {
    const int k = static_cast<int>(error);
    const double same = isAngle(error) ? kSameAngle_rad : kSameLength_m;
    return std::sqrt(std::max(solution_.covariance(k, k), solution_.robust(k, k)) + same * same);
  }

  double medianResidual(const std::vector<CalibrationTerm>& terms) {
    std::vector<double> residuals;
    for (const CalibrationTerm& term : terms)
      residuals.insert(residuals.end(), term.residual_m.begin(), term.residual_m.end());
    result_.patches = residuals.size();
    return residuals.empty() ? 0.0 : medianOf(std::move(residuals));
  }

  // What the scans told of the free ones.
  void judge() {
    for (const ScannerError error : free_) {
      ErrorEstimate& e = estimate(error);
      e.deviation = deviationOf(error);
      e.state = e.deviation <= limitOf(error, settings_) ? EstimateState::Estimated : EstimateState::Weak;
      if (e.state == EstimateState::Weak) e.reason = whyWeak(error);
    }
  }

  std::string whyWeak(ScannerError error) const {
    const int k = static_cast<int>(error);
    std::string others;
    for (const ScannerError other : free_) {
      const int l = static_cast<int>(other);
      const double alike =
          solution_.covariance(k, l) / std::sqrt(solution_.covariance(k, k) * solution_.covariance(l, l));
      if (other != error && std::abs(alike) > kAlike)
        others += (others.empty() ? "" : " and the ") + scannerErrorName(other);
    }
    if (!others.empty())
      return "these scans cannot tell it from the " + others +
             ": take some with other headings, nearer to walls";
    if (solution_.alone[k] < limitOf(error, settings_))
      return "these scans cannot tell it from their own poses: take some with other headings and distances";
    return "too little in these scans depends on it: take more that overlap";
  }

  void hold() {
    for (const ErrorEstimate& e : estimates_)
      if (e.state == EstimateState::Weak) change_[static_cast<int>(e.error)] = 0.0;
  }

  void tiltZero() {
    ErrorEstimate& e = estimate(ScannerError::TiltZero);
    if (!settings_.tilt_zero) return;
    control_.tell(0.95, "looking at the ground under the stops");
    const GroundTilt ground = groundTilt(prepared_, poses_, settings_.ground_radius_m, threads_);
    result_.ground_stops = static_cast<int>(ground.stops.size());
    e.deviation = ground.deviation_rad;
    e.state = EstimateState::Weak;
    if (ground.stops.size() < 4) {
      e.deviation = 0.0;
      e.reason = "no overlap tells it, and the ground that the machine stood on is seen at " +
                 std::to_string(ground.stops.size()) +
                 " stops only: drive towards where it will stand next, and take scans every few metres";
    } else if (ground.deviation_rad > settings_.angle_limit_rad) {
      e.reason = "no overlap tells it, and the ground at the " + std::to_string(ground.stops.size()) +
                 " stops differs too much from how the machine stood there: take more scans, on even ground";
    } else {
      e.state = EstimateState::Estimated;
      change_[0] += ground.change_rad;
      // The points turn about the tilt axis; the poses turn back, so that the map stays but for scan 0's
      // frame.
      const Pose turn(Eigen::Quaterniond(Eigen::AngleAxisd(ground.change_rad, Eigen::Vector3d::UnitX())),
                      Eigen::Vector3d::Zero());
      const Pose first = poses_.front();
      for (Pose& pose : poses_) pose = first * turn * (first.inverse() * pose) * turn.inverse();
      if (std::abs(ground.roll_rad) > 0.5 * kDegree)
        result_.warnings.push_back("the ground at the stops leans by " +
                                   fixedReal(ground.roll_rad / kDegree, 2) +
                                   " deg about the heading on average: the tilt axis does not lie level in "
                                   "the machine, which no parameter of the scanner describes");
    }
  }

  void finish() {
    result_.geometry = geometry();
    result_.poses = poses_;
    result_.scans = static_cast<int>(scans_.size() - unlinked_.size());
    result_.links = pairs_.size();
    const ErrorVector before = errorsOf(stored_), after = errorsOf(result_.geometry);
    for (const ScannerError error : kAllScannerErrors) {
      ErrorEstimate& e = estimate(error);
      e.error = error;
      e.before = before[static_cast<int>(error)];
      e.value = e.state == EstimateState::Estimated ? after[static_cast<int>(error)] : e.before;
      if (error == ScannerError::LeverX || error == ScannerError::MountingX) {
        e.state = EstimateState::Undefined;
        e.reason = error == ScannerError::LeverX
                       ? "no scans tell it: it shifts every scan along the tilt axis, as its pose does"
                       : "no scans tell it: it is the tilt zero with another lever arm";
      } else if (e.state == EstimateState::Held) {
        e.reason = "held as asked";
      }
    }
    result_.estimates = estimates_;
    for (const int scan : unlinked_)
      result_.warnings.push_back("scan " + scans_[static_cast<std::size_t>(scan)].name +
                                 " overlaps with no other and took no part");
  }

  const std::vector<Scan>& scans_;
  std::vector<Pose> poses_;
  CalibrationSettings settings_;
  int threads_;
  const JobControl& control_;
  ScannerGeometry stored_;
  ErrorVector change_ = ErrorVector::Zero();  // from what was stored
  ErrorPrior prior_;
  std::vector<ScannerError> free_;
  std::vector<PreparedScanPtr> prepared_;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<int> unlinked_;
  CalibrationSolution solution_;
  std::vector<ErrorEstimate> estimates_ = std::vector<ErrorEstimate>(kScannerErrors);
  Calibration result_;
};

}  // namespace

Result<Calibration> calibrate(const std::vector<Scan>& scans, const std::vector<Pose>& world_from_scan,
                              const CalibrationSettings& settings, int threads, const JobControl& control) {
  if (Status status = checkScans(scans, world_from_scan); !status) return fail(status.error());
  return Calibrator(scans, world_from_scan, settings, threads, control).run();
}

}  // namespace tiltmap
