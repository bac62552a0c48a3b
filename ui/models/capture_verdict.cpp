#include "ui/models/capture_verdict.h"

#include <algorithm>

#include "core/multiview/stop_verdict.h"
#include "core/registration/judgement_words.h"
#include "ui/models/project_session.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr int kEveryLines = 4;
constexpr int kFewestLines = 12;  // of a stop of the map

CaptureLight lightOf(StopLight light) {
  switch (light) {
    case StopLight::MoveOn:
      return CaptureLight::MoveOn;
    case StopLight::Closer:
      return CaptureLight::Closer;
    case StopLight::Rescan:
      break;
  }
  return CaptureLight::Rescan;
}

QString figuresOf(const StopVerdict& verdict) {
  if (!verdict.best) return {};
  const PairJudgement& judged = verdict.links[*verdict.best].judgement;
  QString text = qt(verdictName(judged.verdict) + ": " + judged.reason);
  for (const JudgementLine& line : judgementLines(judged)) text += "\n" + qt(line.name + ": " + line.value);
  return text;
}

// A stop of the map, as it was when it was prepared.
struct Known {
  ScanId id = 0;
  std::int64_t matrix = 0, geometry = 0;
  int lines = 0;
  bool operator==(const Known&) const = default;
};

}  // namespace

QString captureLightName(CaptureLight light) {
  switch (light) {
    case CaptureLight::MoveOn:
      return "Move on";
    case CaptureLight::Rescan:
      return "Rescan";
    case CaptureLight::Closer:
      return "Closer";
  }
  return {};
}

// Of the worker's thread; kept from stop to stop, since preparing a stop takes some 10 ms.
struct CaptureVerdict::Work {
  std::shared_ptr<const StopMap> map;
  std::vector<Known> known;
  ScanId scan = 0;
  std::unique_ptr<SweepRegistration> registration;

  void begin(const ProjectSnapshot& snapshot, ScanId captured) {
    if (registration && scan == captured) return;
    registration.reset();
    scan = captured;
    const std::vector<Pose> poses = snapshot.filledPoses(snapshot.latestStage());
    std::vector<Known> wanted;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < snapshot.scans().size(); ++i) {
      const ScanEntry& entry = snapshot.scans()[i];
      if (entry.id == captured || entry.lines < kFewestLines) continue;
      wanted.push_back({entry.id, entry.matrix, entry.geometry_id, entry.lines});
      places.push_back(i);
    }
    const bool grows =
        known.size() <= wanted.size() && std::equal(known.begin(), known.end(), wanted.begin());
    auto next = std::make_shared<StopMap>(grows && map ? *map : StopMap());
    if (!grows || !map) known.clear();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Pose& pose = poses[places[i]];
      if (i < known.size()) {
        next->setPose(i, pose);
        continue;
      }
      const auto scan_here = snapshot.scans()[places[i]].scan();
      if (!scan_here) break;  // what can still be read is the map
      next->add(*scan_here, pose);
      known.push_back(wanted[i]);
    }
    map = std::move(next);
    const auto place = snapshot.indexOf(captured);
    registration = std::make_unique<SweepRegistration>(map, place ? poses[*place] : Pose());
  }
};

CaptureVerdict::CaptureVerdict(const ProjectSession& session, QObject* parent)
    : QObject(parent), session_(session), work_(std::make_shared<Work>()), worker_(this) {}

void CaptureVerdict::begin(ScanId scan) {
  forget();
  scan_ = scan;
  Q_EMIT changed();
}

void CaptureVerdict::forget() {
  worker_.cancel();
  judging_ = completed_ = false;
  lines_ = tried_ = 0;
  scan_.reset();
  estimate_.reset();
  judgement_.reset();
  Q_EMIT changed();
}

void CaptureVerdict::linesCame(int so_far) {
  lines_ = so_far;
  since_last_line_.start();
  startNext();
}

void CaptureVerdict::complete() {
  if (!scan_ || completed_) return;
  completed_ = true;
  startNext();
  Q_EMIT changed();
}

void CaptureVerdict::startNext() {
  const SnapshotPtr snapshot = session_.snapshot();
  if (!scan_ || !snapshot || !snapshot->find(*scan_)) return;
  if (completed_ && !judging_ && !judgement_) {
    // The last estimate is not waited for: it was asked to stop, and only the verdict counts from now on.
    judging_ = true;
    worker_.start(
        [this, snapshot, scan = *scan_, work = work_](const std::stop_token& stop) -> BackgroundWorker::Done {
          const auto captured = snapshot->find(scan)->scan();
          if (!captured) return [] {};
          work->begin(*snapshot, scan);
          JobControl control;
          control.stop = stop;
          const SweepEstimate& estimate = work->registration->estimate();
          const StopVerdict verdict = stopVerdict(*work->map, *captured, work->registration->odometry(),
                                                  estimate.from_odometry ? nullptr : &estimate, {}, control);
          Judgement told{
              lightOf(verdict.light), qt(verdict.reason), qt(verdict.weak_directions), figuresOf(verdict),
              verdict.overlap,        verdict.placed,     verdict.world_from_scan,     0.0};
          // Stops before it that hold too little are no map: to be the first one would be another thing.
          if (work->map->size() == 0 && snapshot->scans().size() > 1 && told.light == CaptureLight::MoveOn) {
            told.light = CaptureLight::Rescan;
            told.reason =
                "The stops before it have too few lines to register to: scan the last of them again first.";
          }
          return [this, scan, told]() mutable {
            if (scan_ != scan) return;
            told.after_last_line_s = 0.001 * static_cast<double>(since_last_line_.elapsed());
            judgement_ = told;
            Q_EMIT changed();
          };
        });
    return;
  }
  if (completed_ || worker_.busy() || lines_ < tried_ + kEveryLines) return;
  tried_ = lines_;
  worker_.start(
      [this, snapshot, scan = *scan_, work = work_](const std::stop_token&) -> BackgroundWorker::Done {
        const auto so_far = snapshot->find(scan)->scan();
        if (!so_far) return [] {};
        work->begin(*snapshot, scan);
        const SweepEstimate found = work->registration->update(*so_far);
        const Estimate told{found.sure,  !found.from_odometry, found.world_from_scan, found.overlap,
                            found.lines, qt(found.sentence),   found.milliseconds};
        return [this, scan, told] {
          if (scan_ != scan) return;
          estimate_ = told;
          Q_EMIT changed();
          startNext();
        };
      });
}

}  // namespace tiltmap::ui
