// All overlapping pairs of scans in one least-squares problem: Gauss-Newton over the patch pairs of every
// link, associations renewed each step, the loss annealed as in a single registration.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/multiview/joint_links.h"
#include "core/multiview/overlap_candidates.h"
#include "core/multiview/pose_system.h"
#include "core/multiview/relaxation_engine.h"
#include "core/registration/sampling.h"

namespace tiltmap {

namespace {

// One metre and one radian: nothing beside what surfaces tell, but a direction that nothing determines stays.
constexpr double kDamping = 1.0;
// As a single registration: the data's own scale is taken this often after the annealing, then kept.
constexpr int kOwnScaleSteps = 3;

std::string namesOf(const std::vector<int>& scans) {
  std::string text;
  for (const int scan : scans) text += (text.empty() ? "" : ", ") + std::to_string(scan);
  return text;
}

class JointRelaxation : public RelaxationEngine {
 public:
  JointRelaxation(RelaxationInput input, const RelaxationSettings& settings, int threads)
      : RelaxationEngine(std::move(input), settings, threads) {
    const RegistrationSettings& r = settings_.registration;
    for (const PreparedScanPtr& scan : input_.scans) samples_.push_back(sampledElements(scan->elements, r));
    scale_m_ = r.loss == Loss::Annealed       ? r.loss_start_m
               : r.loss == Loss::GemanMcClure ? r.loss_scale_m
                                              : 0.0;
    own_scale_steps_left_ = r.loss == Loss::Annealed ? kOwnScaleSteps : 0;
    tied_.assign(poses_.size(), 0);
  }

  std::unique_ptr<RelaxationEngine> clone() const override {
    return std::unique_ptr<RelaxationEngine>(new JointRelaxation(*this));
  }

  void step(RelaxationStep& report, const std::stop_token& stop) override {
    if (stop.stop_requested()) return cancel(report);
    const bool settling = own_scale_steps_left_ == 0;
    if (!settling || candidates_.empty()) findCandidates(report);
    std::vector<JointLink> links = measureLinks(candidates_, input_.scans, samples_, poses_,
                                                settings_.registration, scale_m_, threads_, stop);
    if (stop.stop_requested()) return cancel(report);
    if (settling) keepChoice(links);
    links_ = std::move(links);
    solve(report, settling);
  }

  std::vector<int> unlinked() const override {
    std::vector<int> list;
    for (int i = 0; i < count(); ++i)
      if (!tied_[static_cast<std::size_t>(i)] && count() > 1) list.push_back(i);
    return list;
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
  void findCandidates(RelaxationStep& report) {
    candidates_ = overlapCandidates(input_.scans, poses_, settings_, threads_);
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
      list.push_back({link.fixed, link.moving, link.fixed_from_moving, link.h, link.b});
      linked.emplace(link.fixed, link.moving);
    }
    for (const PoseConstraint& c : input_.constraints) {
      if (c.only_without_link && linked.contains(std::minmax(c.fixed, c.moving))) continue;
      list.push_back(measuredPoseTerm(c.fixed, c.moving, pose(c.fixed).inverse() * pose(c.moving),
                                      c.fixed_from_moving, c.information));
    }
    return list;
  }

  void solve(RelaxationStep& report, bool settling) {
    const std::vector<PairTerm> ties = terms();
    tied_ = tiedToHeld(poses_.size(), pinned_, ties);
    std::vector<char> held = pinned_;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (!tied_[i]) held[i] = 1;
    const Result<std::vector<Vector6d>> motions = solvePoses(poses_.size(), held, ties, kDamping);
    if (!motions) {
      warnings_.push_back(motions.error().what + "; the poses are those of the step before");
      return end(report);
    }
    RelaxationEvent solved;
    solved.kind = RelaxationEventKind::Solved;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (held[i]) continue;
      const Pose moved = poses_[i] * Pose().moved((*motions)[i]);
      const PoseDifference by = difference(poses_[i], moved);
      poses_[i] = moved;
      solved.translation_m = std::max(solved.translation_m, by.translation_m);
      solved.rotation_rad = std::max(solved.rotation_rad, by.rotation_rad);
    }
    describe(solved);
    report.events.push_back(solved);
    ++iterations_;
    updateScale();
    const RegistrationSettings& r = settings_.registration;
    const bool tiny = solved.translation_m < r.min_translation_m && solved.rotation_rad < r.min_rotation_rad;
    const bool same =
        settling &&
        std::abs(solved.rms_m - last_rms_m_) < 0.5 * r.min_change * std::max(last_rms_m_, 1e-12) &&
        solved.translation_m < 10.0 * r.min_translation_m && solved.rotation_rad < 10.0 * r.min_rotation_rad;
    last_rms_m_ = solved.rms_m;
    report.fraction = std::min(0.95, iterations_ / (iterations_ + 4.0));
    const bool nothing_to_do = ties.empty() || std::ranges::all_of(held, [](char h) { return h != 0; });
    if (settling && (tiny || same)) return end(report);
    if (iterations_ >= r.max_iterations) {
      if (!nothing_to_do)
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
    solved.loss_scale_m = scale_m_;
  }

  void updateScale() {
    const RegistrationSettings& r = settings_.registration;
    if (r.loss != Loss::Annealed || own_scale_steps_left_ == 0) return;
    if (scale_m_ > r.loss_end_m) {
      scale_m_ = std::max(r.loss_end_m, scale_m_ * r.loss_factor);
      return;
    }
    --own_scale_steps_left_;
    scale_m_ = std::clamp(medianResidual(links_), r.loss_minimum_m, r.loss_end_m);
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
    reportMovement(report);
    reportDropped(report);
    finish(report);
  }

  void reportMovement(RelaxationStep& report) {
    const RegistrationSettings& r = settings_.registration;
    std::vector<int> far;
    for (int i = 0; i < count(); ++i) {
      if (isPinned(i)) continue;
      const auto index = static_cast<std::size_t>(i);
      const PoseDifference by = difference(startPoses()[index], poses_[index]);
      RelaxationEvent moved;
      moved.kind = RelaxationEventKind::MovedBy;
      moved.scan = i;
      moved.translation_m = by.translation_m;
      moved.rotation_rad = by.rotation_rad;
      report.events.push_back(moved);
      if (by.translation_m > r.max_correction_m || by.rotation_rad > r.max_correction_rad) far.push_back(i);
    }
    if (!far.empty())
      warnings_.push_back(
          "these scans moved further than max-correction allows for a good start; look at them: " +
          namesOf(far));
  }

  // Neighbours in time should fit: where they do not, a start is wrong or they saw too little in common.
  void reportDropped(RelaxationStep& report) {
    for (int i = 1; i < count(); ++i) {
      const auto found = std::ranges::find_if(
          links_, [i](const JointLink& link) { return link.fixed == i - 1 && link.moving == i; });
      if (found != links_.end() && found->used) continue;
      RelaxationEvent dropped;
      dropped.kind = RelaxationEventKind::LinkDropped;
      dropped.scan = i - 1;
      dropped.other = i;
      if (found == links_.end()) {
        dropped.text = "they share too little space";
      } else {
        dropped.pairs = found->pairs;
        dropped.rms_m = found->rms_m;
        dropped.text = "overlap " + percent(found->overlap) + ", agreement " + percent(found->agreement);
      }
      report.events.push_back(dropped);
      warnings_.push_back("scans " + std::to_string(i - 1) + " and " + std::to_string(i) + " do not fit (" +
                          dropped.text + "): nothing was computed from this pair; check its start");
    }
  }
  static std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

  Samples samples_;
  std::vector<std::pair<int, int>> candidates_;
  std::vector<JointLink> links_;
  std::vector<char> tied_;  // to scan 0 or a pin, at the last step
  double scale_m_ = 0.0;
  double last_rms_m_ = 0.0;
  int own_scale_steps_left_ = 0;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<RelaxationEngine> makeJointRelaxation(RelaxationInput input,
                                                      const RelaxationSettings& settings, int threads) {
  return std::make_unique<JointRelaxation>(std::move(input), settings, threads);
}

}  // namespace tiltmap
