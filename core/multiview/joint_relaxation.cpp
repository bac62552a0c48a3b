// All overlapping pairs of scans in one least-squares problem, in three stages.
//
// Closing: pairs whose surfaces do not fit yet at the present poses (the two ends of a loop, whose errors
// have added up) are registered by themselves, verified, and pull as measured poses (misfit_pairs.h); the
// others pull by their surfaces. Starting the joint problem at a loss scale wide enough for such errors
// instead lets wrong pairs of surfaces bend what fitted before.
//
// Settling: Gauss-Newton over the patch pairs of every link, associations renewed each step, the loss scale
// narrowed to the data's own.
//
// Refining, where scans are blocks with cells: the cells of each scan against the patches of the others. Of
// two scans that share little, a good part of the patch pairs is wrong, and what they tell misses the truth
// by many of its deviations; what the cells tell does not. So this begins as soon as every pair is near its
// place, however far the drive as a whole still has to sway, there is no way back to the patches, and in the
// end the pairs that too few patches agreed on for a link take part as well.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <Eigen/Cholesky>

#include "core/base/parallel.h"
#include "core/multiview/joint_links.h"
#include "core/multiview/joint_report.h"
#include "core/multiview/misfit_pairs.h"
#include "core/multiview/overlap_candidates.h"
#include "core/multiview/pose_system.h"
#include "core/multiview/relaxation_engine.h"
#include "core/multiview/step_lengthening.h"
#include "core/registration/sampling.h"

namespace tiltmap {

namespace {

// One metre and one radian: nothing beside what surfaces tell, but a direction that nothing determines stays.
constexpr double kDamping = 1.0;
// As a single registration: the data's own scale is taken this often after the annealing, then kept; once is
// enough where cells have the last word.
constexpr int kOwnScaleSteps = 3;
constexpr int kOwnScaleStepsToRefine = 1;
// Where cells have the last word, poses need no more than some millimetres before, for which one patch in so
// many does.
constexpr std::size_t kCoarseStep = 3;
constexpr double kFinalScale = 0.7;  // of the better links' median residual; ours, on simulated drives
constexpr double kNarrowBelow_m = 0.005;
constexpr int kWaitAtMost = 25;
constexpr int kClosingRounds = 8;
constexpr int kInnerSteps = 20;
constexpr double kTurnArm_m = 10.0;  // a turn counts as the shift it makes at this distance
// Of the poses of two scans against each other.
constexpr double kRefineBelow_m = 0.005;
constexpr double kNearlyAll = 0.99;  // of the ties: one of some thousands may sway without end
// A pair that its patches made no link joins in where its cells ask for no more than this.
constexpr double kJoinsBelow_m = 0.03;
constexpr double kJoinsBelow_rad = 0.2 * kDegree;

class JointRelaxation : public RelaxationEngine {
 public:
  JointRelaxation(RelaxationInput input, const RelaxationSettings& settings, int threads)
      : RelaxationEngine(std::move(input), settings, threads) {
    const RegistrationSettings& r = settings_.registration;
    const bool refines = refinesCells();
    for (const PreparedScanPtr& scan : input_.scans) {
      samples_.push_back(sampledElements(scan->elements, r));
      if (refines) samples_.back() = everyNth(samples_.back(), kCoarseStep);
    }
    loss_ = r.loss == Loss::Annealed ? r.loss_end_m : r.loss == Loss::GemanMcClure ? r.loss_scale_m : 0.0;
    own_scale_steps_left_ =
        r.loss != Loss::Annealed ? 0 : (refines ? kOwnScaleStepsToRefine : kOwnScaleSteps);
    widest_m_ = loss_.scale_m;
    tied_.assign(poses_.size(), 0);
    for (const PoseConstraint& c : input_.constraints)
      if (isSettled(c.fixed) && isSettled(c.moving)) misfits_.joined(c.fixed, c.moving);
  }

  std::unique_ptr<RelaxationEngine> clone() const override {
    return std::unique_ptr<RelaxationEngine>(new JointRelaxation(*this));
  }

  void step(RelaxationStep& report, const std::stop_token& stop) override {
    if (stop.stop_requested()) return cancel(report);
    if (closing_) return close(report, stop);
    const bool settling = own_scale_steps_left_ == 0;
    if (settling && canRefine()) return refine(report, stop);
    if (!settling || candidates_.empty()) findCandidates(report);
    tellDoing("measuring " + std::to_string(candidates_.size()) + " pairs of scans");
    std::vector<JointLink> links = measureLinks(candidates_, input_.scans, samples_, poses_,
                                                settings_.registration, loss_, threads_, stop);
    if (stop.stop_requested()) return cancel(report);
    if (settling) keepChoice(links);
    links_ = std::move(links);
    settle(report, settling);
  }

  std::vector<int> unlinked() const override {
    std::vector<int> list;
    for (int i = 0; i < count(); ++i)
      if (!tied_[static_cast<std::size_t>(i)] && count() > 1) list.push_back(i);
    return list;
  }

  RelaxationState state() const override {
    RelaxationState now;
    for (int i = 0; i < count(); ++i)
      (tied_[static_cast<std::size_t>(i)] ? now.active : now.waiting).push_back(i);
    return now;
  }

  std::vector<RelaxationLink> links() const override {
    std::vector<RelaxationLink> list;
    for (const JointLink& from : links_) {
      RelaxationLink link;
      link.fixed = from.fixed;
      link.moving = from.moving;
      link.fixed_from_moving = pose(from.fixed).inverse() * pose(from.moving);
      link.pairs = from.pairs;
      link.overlap = from.overlap;
      link.agreement = from.agreement;
      link.rms_m = from.rms_m;
      link.information = from.h;
      link.used = from.used;
      list.push_back(link);
    }
    return list;
  }

 private:
  // Whether all scans are blocks with cells, which then settle the poses.
  bool refinesCells() const {
    const RegistrationSettings& r = settings_.registration;
    return r.refine && r.loss == Loss::Annealed && std::ranges::all_of(input_.scans, [](const auto& scan) {
             return scan->elements.empty() || (scan->raster.has_value() && !scan->cells.empty());
           });
  }
  static std::vector<std::uint32_t> everyNth(const std::vector<std::uint32_t>& all, std::size_t n) {
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < all.size(); i += n) some.push_back(all[i]);
    return some;
  }

  void close(RelaxationStep& report, const std::stop_token& stop) {
    findCandidates(report);
    tellDoing("measuring " + std::to_string(candidates_.size()) + " pairs of scans");
    if (rounds_ == 0) takeOwnScale(stop);
    std::vector<JointLink> links = measureLinks(candidates_, input_.scans, samples_, poses_,
                                                settings_.registration, loss_, threads_, stop);
    const std::vector<const JointLink*> due = misfits_.due(links);
    if (!due.empty()) tellDoing("registering " + std::to_string(due.size()) + " pairs that do not fit yet");
    std::vector<MisfitAttempt> attempts = misfits_.registered(
        due, links, {input_.scans, samples_, settings_.registration, loss_, threads_}, stop);
    if (stop.stop_requested()) {
      report.events.clear();
      return cancel(report);
    }
    reportAttempts(due, attempts, report);
    misfits_.keep(due, std::move(attempts));
    links_ = std::move(links);
    // Large motions are not linear: the same quadratic forms are carried along to where the poses go.
    RelaxationEvent solved;
    std::size_t misfits = 0;
    const std::vector<Pose> at_first = poses_;
    std::vector<PairTerm> ties;
    for (int i = 0; i < kInnerSteps; ++i) {
      ties = terms();
      const std::size_t by_surface = ties.size();
      misfits_.addTerms(links_, poses_, settings_.registration.loss_start_m, ties);
      misfits = ties.size() - by_surface;
      RelaxationEvent inner;
      if (!solve(ties, inner)) return end(report);
      inner.translation_m = std::max(inner.translation_m, solved.translation_m);
      inner.rotation_rad = std::max(inner.rotation_rad, solved.rotation_rad);
      solved = inner;
      if (last_bent_m_ < 0.1 * settings_.registration.loss_minimum_m) break;
    }
    report.events.push_back(solved);
    ++rounds_;
    report.fraction = 0.5 * rounds_ / (rounds_ + 2.0);
    const bool at_rest = bentSince(at_first, ties) < kRefineBelow_m;
    closing_ = misfits > 0 && !at_rest && rounds_ < kClosingRounds;
  }

  bool canRefine() const {
    return refinesCells() && loss_.isOwn() && !links_.empty() && (refining_ || last_bent_m_ < kRefineBelow_m);
  }

  void refine(RelaxationStep& report, const std::stop_token& stop) {
    refining_ = true;
    tellDoing("holding the cells of " + std::to_string(links_.size()) + " pairs of scans against patches");
    link_cells_.resize(links_.size());
    // A link that was not reached when asked to stop is as it was; the step is not taken then.
    std::vector<JointLink> links = links_;
    parallelFor(links.size(), threads_, [&](std::size_t k) {
      const bool joins = all_join_ && !links[k].used && !joined_;
      if ((!links[k].used && !joins) || stop.stop_requested()) return;
      refineLink(links[k], link_cells_[k], pose(links[k].fixed).inverse() * pose(links[k].moving),
                 input_.scans, settings_.registration, loss_);
      if (joins) links[k].used = holdsByCells(links[k], link_cells_[k]);
    });
    if (stop.stop_requested()) return cancel(report);
    joined_ = all_join_;
    links_ = std::move(links);
    settle(report, true);
  }

  bool holdsByCells(const JointLink& link, const LinkCells& cells) const {
    if (cells.cells.size() < static_cast<std::size_t>(settings_.registration.min_pairs) || link.weak == 6)
      return false;
    const Vector6d step = -(link.h + kDamping * Matrix6d::Identity()).ldlt().solve(link.b);
    const PoseDifference by = difference(link.fixed_from_moving, link.fixed_from_moving.moved(step));
    return by.translation_m < kJoinsBelow_m && by.rotation_rad < kJoinsBelow_rad;
  }

  // How well surfaces fit is a matter of the site and the scanner. Neighbours in time have been registered,
  // so their residuals tell; at twice their median a pair that does not fit yet stands out.
  void takeOwnScale(const std::stop_token& stop) {
    const RegistrationSettings& r = settings_.registration;
    if (r.loss != Loss::Annealed) return;
    std::vector<std::pair<int, int>> in_time;
    for (const auto& pair : candidates_)
      if (pair.second == pair.first + 1) in_time.push_back(pair);
    const std::vector<JointLink> links =
        measureLinks(in_time, input_.scans, samples_, poses_, r, loss_, threads_, stop);
    const double median = ownResidual(links);
    if (median > 0.0) loss_ = std::clamp(2.0 * median, r.loss_minimum_m, r.loss_end_m);
    widest_m_ = loss_.scale_m;
  }

  void findCandidates(RelaxationStep& report) {
    candidates_ = overlapCandidates(input_.scans, poses_, settings_, threads_);
    std::erase_if(candidates_, [this](const auto& pair) { return isExcluded(pair.first, pair.second); });
    report.events.emplace_back();
    report.events.back().kind = RelaxationEventKind::LinksFound;
    report.events.back().pairs = candidates_.size();
  }

  // Once the loss scale is settled, so is which links are used: coming and going at the bound would never
  // end.
  void keepChoice(std::vector<JointLink>& links) const {
    for (std::size_t k = 0; k < links.size() && k < links_.size(); ++k)
      links[k].used = links_[k].used && links[k].weak < 6;
  }

  std::vector<PairTerm> terms() const {
    std::vector<PairTerm> list;
    std::set<std::pair<int, int>> linked;
    for (const JointLink& link : links_) {
      if (!link.used) continue;
      list.push_back(carriedTerm({link.fixed, link.moving, link.fixed_from_moving, link.h, link.b},
                                 pose(link.fixed).inverse() * pose(link.moving)));
      linked.emplace(link.fixed, link.moving);
    }
    for (const PoseConstraint& c : input_.constraints) {
      if (c.only_without_link && linked.contains(std::minmax(c.fixed, c.moving))) continue;
      list.push_back(measuredPoseTerm(c.fixed, c.moving, pose(c.fixed).inverse() * pose(c.moving),
                                      c.fixed_from_moving, c.information));
    }
    return list;
  }

  // One Gauss-Newton step, `lengthened` or not; false, with a warning, where the equations cannot be solved.
  bool solve(const std::vector<PairTerm>& ties, RelaxationEvent& solved, bool lengthened = false) {
    tied_ = tiedToHeld(poses_.size(), pinned_, ties);
    std::vector<char> held = pinned_;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!tied_[i]) held[i] = 1;
    Result<std::vector<Vector6d>> motions = solvePoses(poses_.size(), held, ties, kDamping);
    if (!motions) {
      warnings_.push_back(motions.error().what + "; the poses are those of the step before");
      return false;
    }
    solved.kind = RelaxationEventKind::Solved;
    if (lengthened) lengthening_.lengthen(*motions, kTurnArm_m);
    const std::vector<Pose> before = poses_;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (held[i]) continue;
      const Pose moved = poses_[i] * Pose().moved((*motions)[i]);
      const PoseDifference by = difference(poses_[i], moved);
      poses_[i] = moved;
      solved.translation_m = std::max(solved.translation_m, by.translation_m);
      solved.rotation_rad = std::max(solved.rotation_rad, by.rotation_rad);
    }
    last_bent_m_ = bentSince(before, ties);
    describe(solved);
    return true;
  }

  // How far the two scans of nearly every tie have moved against each other at most, in m. What scans do in
  // the world says little: the far end of a long drive sways by centimetres where no pair of scans moves by a
  // tenth of a millimetre.
  double bentSince(const std::vector<Pose>& before, const std::vector<PairTerm>& ties) const {
    if (ties.empty()) return 0.0;
    std::vector<double> bent;
    for (const PairTerm& tie : ties) {
      const auto a = static_cast<std::size_t>(tie.fixed), b = static_cast<std::size_t>(tie.moving);
      const PoseDifference by = difference(before[a].inverse() * before[b], poses_[a].inverse() * poses_[b]);
      bent.push_back(std::max(by.translation_m, by.rotation_rad * kTurnArm_m));
    }
    const auto nearly_all = static_cast<std::size_t>(kNearlyAll * static_cast<double>(bent.size() - 1) + 0.5);
    const auto at = bent.begin() + static_cast<std::ptrdiff_t>(nearly_all);
    std::nth_element(bent.begin(), at, bent.end());
    return *at;
  }

  void settle(RelaxationStep& report, bool settling) {
    RelaxationEvent solved;
    if (!solve(terms(), solved, true)) return end(report);
    report.events.push_back(solved);
    ++iterations_;
    updateScale();
    const RegistrationSettings& r = settings_.registration;
    const bool tiny = solved.translation_m < r.min_translation_m && solved.rotation_rad < r.min_rotation_rad;
    const bool same = std::abs(solved.rms_m - last_rms_m_) < 0.5 * r.min_change * last_rms_m_ &&
                      solved.translation_m < 10.0 * r.min_translation_m &&
                      solved.rotation_rad < 10.0 * r.min_rotation_rad;
    last_rms_m_ = solved.rms_m;
    report.fraction = 0.5 + 0.5 * std::min(0.95, iterations_ / (iterations_ + 4.0));
    if (settling && (tiny || same)) {
      if (!refining_ || all_join_) return end(report);
      all_join_ = true;
      lengthening_.restart();
    }
    if (iterations_ >= r.max_iterations) {
      warnings_.push_back("the relaxation was still moving after " + std::to_string(iterations_) +
                          " steps; raise max-iterations, or look at the result");
      end(report);
    }
  }

  void describe(RelaxationEvent& solved) const {
    double weight = 0.0, square = 0.0;
    for (const JointLink& link : links_) {
      if (!link.used) continue;
      solved.pairs += link.pairs;
      weight += link.loss_weight;
      square += link.loss_weight * link.rms_m * link.rms_m;
    }
    solved.rms_m = weight > 0.0 ? std::sqrt(square / weight) : 0.0;
    solved.loss_scale_m = loss_.scale_m;
  }

  // Not while links are still on the move: narrowing then drops those that would come to fit.
  void updateScale() {
    const RegistrationSettings& r = settings_.registration;
    if (last_bent_m_ > kNarrowBelow_m && ++waited_ <= kWaitAtMost) return;
    if (r.loss != Loss::Annealed || own_scale_steps_left_ == 0) return;
    --own_scale_steps_left_;
    lengthening_.restart();
    if (metricOf(r.motion, r.reduction == Reduction::Patches) == Metric::PatchToPatch) {
      loss_ = LossScale::ofOwnDeviation(r.loss_deviations, std::min(ownExcess(links_), widest_m_));
      return;
    }
    loss_ = std::clamp(kFinalScale * ownResidual(links_), r.loss_minimum_m,
                       std::max(widest_m_, r.loss_minimum_m));
  }

  void end(RelaxationStep& report) {
    // What lost its last tie on the way goes back to where it came from.
    for (const int scan : unlinked()) {
      poses_[static_cast<std::size_t>(scan)] = startPoses()[static_cast<std::size_t>(scan)];
      report.events.emplace_back();
      report.events.back().kind = RelaxationEventKind::Unlinked;
      report.events.back().scan = scan;
    }
    if (!unlinked().empty())
      warnings_.push_back("no link ties these scans to scan 0 or a pinned one, so they keep their poses: " +
                          namesOf(unlinked()));
    reportMovement(startPoses(), poses_, pinned_, settings_.registration, report, warnings_);
    const auto excluded = [this](int fixed, int moving) { return isExcluded(fixed, moving); };
    reportDropped(count(), links_, excluded, report, warnings_);
    finish(report);
  }

  bool closing_ = true;
  int rounds_ = 0;
  int waited_ = 0;
  MisfitPairs misfits_;
  Samples samples_;
  std::vector<std::pair<int, int>> candidates_;
  std::vector<JointLink> links_;
  std::vector<char> tied_;  // to scan 0 or a pin, at the last step
  LossScale loss_;
  double widest_m_ = 0.0;  // of the loss scales of this data
  double last_rms_m_ = 0.0;
  double last_bent_m_ = std::numeric_limits<double>::infinity();  // by the last step, see bentSince
  bool refining_ = false;
  bool all_join_ = false, joined_ = false;  // pairs without a link are to take part, and were looked at
  std::vector<LinkCells> link_cells_;       // of links_, once they are refined
  StepLengthening lengthening_;
  int own_scale_steps_left_ = 0;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<RelaxationEngine> makeJointRelaxation(RelaxationInput input,
                                                      const RelaxationSettings& settings, int threads) {
  return std::make_unique<JointRelaxation>(std::move(input), settings, threads);
}

}  // namespace tiltmap
