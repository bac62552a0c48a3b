// Sequential registration: each scan onto the metascan of those before it (Chen and Medioni 1992; thesis
// 6.1's example of what accumulates error). The baseline.
#include "core/multiview/metascan.h"
#include "core/multiview/relaxation_engine.h"

namespace tiltmap {

namespace {

class SequentialRelaxation : public RelaxationEngine {
 public:
  using RelaxationEngine::RelaxationEngine;

  std::unique_ptr<RelaxationEngine> clone() const override {
    return std::unique_ptr<RelaxationEngine>(new SequentialRelaxation(*this));
  }

  void step(RelaxationStep& report, const std::stop_token& stop) override {
    if (next_ < count() && !place(report, stop)) return cancel(report);
    report.fraction = static_cast<double>(next_) / static_cast<double>(count());
    if (next_ >= count()) finish(report);
  }

  std::vector<int> unlinked() const override { return unlinked_; }

  std::vector<RelaxationLink> links() const override { return {}; }

  RelaxationState state() const override {
    RelaxationState now;
    now.active = members_;
    for (int i = next_; i < count(); ++i) {
      now.waiting.push_back(i);
      now.queue.push_back(i);
    }
    return now;
  }

 private:
  // False where a stop came between; nothing has changed then.
  bool place(RelaxationStep& report, const std::stop_token& stop) {
    const int i = next_;
    const auto index = static_cast<std::size_t>(i);
    const auto note = [&](RelaxationEventKind kind) -> RelaxationEvent& {
      report.events.emplace_back();
      report.events.back().kind = kind;
      report.events.back().scan = i;
      return report.events.back();
    };
    if (isPinned(i)) {
      if (stop.stop_requested()) return false;
      note(RelaxationEventKind::Kept).text = "it never moves";
    } else {
      // The scan before may have moved: it takes this one along.
      const Pose carried = pose(i - 1) * (startPoses()[index - 1].inverse() * startPoses()[index]);
      RelaxationState now;
      if (isWatched()) now = state();
      const MetascanAlignment found =
          alignToMetascan(input_.scans, poses_, members_, i, carried, settings_.registration, stop,
                          tellIterations(std::move(now), i, members_));
      if (found.reason == StopReason::Cancelled) return false;
      poses_[index] = found.world_from_scan;
      RelaxationEvent& aligned = note(RelaxationEventKind::Aligned);
      aligned.pairs = found.pairs;
      aligned.rms_m = found.rms_m;
      aligned.text = stopReasonName(found.reason);
      RelaxationEvent& moved = note(RelaxationEventKind::MovedBy);
      const PoseDifference by = difference(startPoses()[index], poses_[index]);
      moved.translation_m = by.translation_m;
      moved.rotation_rad = by.rotation_rad;
      if (!isSuccess(found.reason)) {
        unlinked_.push_back(i);
        note(RelaxationEventKind::Unlinked);
        warnings_.push_back("scan " + std::to_string(i) + " could not be registered onto those before it (" +
                            stopReasonName(found.reason) + "); it keeps its place beside scan " +
                            std::to_string(i - 1));
      }
    }
    members_.push_back(i);
    ++next_;
    return true;
  }

  int next_ = 0;
  std::vector<int> members_;
  std::vector<int> unlinked_;
};

}  // namespace

std::unique_ptr<RelaxationEngine> makeSequentialRelaxation(RelaxationInput input,
                                                           const RelaxationSettings& settings, int threads) {
  return std::make_unique<SequentialRelaxation>(std::move(input), settings, threads);
}

}  // namespace tiltmap
