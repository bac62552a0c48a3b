#include "core/multiview/stop_verdict.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include "core/base/text.h"
#include "core/registration/manual_start.h"

namespace tiltmap {

namespace {

using Clock = std::chrono::steady_clock;

std::string percent(double share) {
  return fixedReal(100.0 * share, 0) + " %";
}

// Tries starts and stops of the map one after the other until one link is good or the time is over.
class Search {
 public:
  Search(const StopMap& map, const Scan& scan, const StopVerdictSettings& settings, const JobControl& control)
      : map_(map), settings_(settings), control_(control) {
    prepared_ = prepare(scan, map.settings());
    judged_ = judgedScan(prepared_);
  }

  // Keeps the better one of what is known of the stop. True once it is good.
  bool tryFrom(std::size_t stop, const Pose& world_from_scan, const Pose& odometry) {
    if (timeIsOver()) return false;
    const MapStop& fixed = map_[stop];
    const Pose start = fixed.world_from_scan.inverse() * world_from_scan;
    const auto result = registerPair(fixed.prepared, prepared_, start, map_.settings(), control_);
    if (!result) return false;
    StopLink link;
    link.stop = stop;
    link.stop_from_scan = result->fixed_from_moving;
    // Told from the odometry, wherever the registration began.
    link.judgement =
        judgePair(*fixed.judged, *judged_, claimOf(*result, fixed.world_from_scan.inverse() * odometry),
                  settings_.judgement);
    const bool good = link.judgement.verdict == Verdict::Good;
    const auto known = std::ranges::find(links_, stop, &StopLink::stop);
    if (known == links_.end())
      links_.push_back(std::move(link));
    else if (link.judgement.badness < known->judgement.badness)
      *known = std::move(link);
    return good;
  }

  // The previous stop once more, from the heading that fits best all round.
  bool tryHeadings(std::size_t stop, const Pose& odometry) {
    if (timeIsOver() || prepared_->elements.empty()) return false;
    const MapStop& fixed = map_[stop];
    const Pose start = fixed.world_from_scan.inverse() * odometry;
    const auto sweep =
        sweepHeadings(*fixed.prepared, *prepared_, start, map_.settings(), {6.0 * kDegree, 0.5}, control_);
    if (!sweep) return false;
    return tryFrom(stop, fixed.world_from_scan * turnedStart(start, sweep->bestScore().turned_rad), odometry);
  }

  bool timeIsOver() const { return control_.stopRequested() || milliseconds() > settings_.most_ms; }
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin_).count();
  }
  std::vector<StopLink> take() { return std::move(links_); }

 private:
  const StopMap& map_;
  const StopVerdictSettings& settings_;
  const JobControl& control_;
  Clock::time_point begin_ = Clock::now();
  PreparedScanPtr prepared_;
  JudgedScanPtr judged_;
  std::vector<StopLink> links_;
};

std::vector<StopLink> linksOf(const StopMap& map, const Scan& scan, const Pose& odometry,
                              const SweepEstimate* estimate, const StopVerdictSettings& settings,
                              const JobControl& control) {
  Search search(map, scan, settings, control);
  const std::size_t previous = map.size() - 1;
  const bool held = estimate && !estimate->from_odometry;
  bool good = held && search.tryFrom(previous, estimate->world_from_scan, odometry);
  if (!good) good = search.tryFrom(previous, odometry, odometry);
  const Eigen::Vector3d place = (held ? estimate->world_from_scan : odometry).translation();
  for (const std::size_t stop :
       map.neighbours(place, static_cast<std::size_t>(std::max(1, settings.neighbours)), settings.within_m)) {
    if (stop == previous || good) continue;
    good = (held && search.tryFrom(stop, estimate->world_from_scan, odometry)) ||
           search.tryFrom(stop, odometry, odometry);
  }
  if (!good) search.tryHeadings(previous, odometry);
  return search.take();
}

void tell(StopVerdict& verdict, const StopMap& map, const StopVerdictSettings& settings) {
  const StopLink& link = verdict.links[*verdict.best];
  const PairJudgement& judged = link.judgement;
  const std::string stop =
      map[link.stop].name.empty() ? "stop " + std::to_string(link.stop) : map[link.stop].name;
  if (judged.verdict == Verdict::Good) {
    verdict.light = StopLight::MoveOn;
    verdict.reason = "Fits " + stop + ": " + percent(judged.overlap()) + " in common, in place within " +
                     lengthWords(2.0 * judged.strength.weakest_m) + ".";
    if (verdict.moved.translation_m > settings.surprise_m ||
        verdict.moved.rotation_rad > settings.surprise_rad)
      verdict.reason += " The odometry was " + lengthWords(verdict.moved.translation_m) + " and " +
                        fixedReal(verdict.moved.rotation_rad / kDegree, 0) + "° off.";
    return;
  }
  verdict.light = StopLight::Closer;
  if (judged.verdict == Verdict::Doubtful)
    verdict.reason = "Held too weakly by " + stop + ": " + judged.reason + ". Add a stop in between.";
  else
    verdict.reason =
        "Does not fit " + stop + ": " + judged.reason + ". Come closer to it, or check the odometry.";
}

}  // namespace

const std::string& stopLightName(StopLight light) {
  static const std::array<std::string, 3> names = {"move on", "rescan", "closer"};
  return names.at(static_cast<std::size_t>(light));
}

StopVerdict stopVerdict(const StopMap& map, const Scan& scan, const Pose& odometry,
                        const SweepEstimate* estimate, const StopVerdictSettings& settings,
                        const JobControl& control) {
  const Clock::time_point begin = Clock::now();
  if (!scan.image) throw std::invalid_argument("stopVerdict: the scan has no range image");
  if (!odometry.isFinite()) throw std::invalid_argument("stopVerdict: the odometry is not finite");
  StopVerdict verdict;
  verdict.world_from_scan = odometry;
  verdict.health = scanHealth(*scan.image, scan.geometry, true, settings.health);
  if (!map.empty()) {
    verdict.links = linksOf(map, scan, odometry, estimate, settings, control);
    for (std::size_t i = 0; i < verdict.links.size(); ++i)
      if (!verdict.best ||
          verdict.links[i].judgement.badness < verdict.links[*verdict.best].judgement.badness)
        verdict.best = i;
  }
  if (verdict.best) {
    const StopLink& link = verdict.links[*verdict.best];
    verdict.placed = link.judgement.verdict == Verdict::Good;
    if (verdict.placed) verdict.world_from_scan = map[link.stop].world_from_scan * link.stop_from_scan;
    verdict.overlap = link.judgement.overlap();
    verdict.weak_directions = link.judgement.strength_sentence;
    verdict.moved = difference(odometry, verdict.world_from_scan);
    tell(verdict, map, settings);
  } else if (map.empty()) {
    verdict.light = StopLight::MoveOn;
    verdict.reason = "The first stop is whole: " + std::to_string(verdict.health.lines) + " lines.";
  } else {
    verdict.light = StopLight::Rescan;
    verdict.reason = "There was no time to register the scan. Scan again.";
  }
  if (!verdict.health.good) {
    verdict.light = StopLight::Rescan;
    verdict.reason = verdict.health.reason;
  }
  verdict.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
  return verdict;
}

}  // namespace tiltmap
