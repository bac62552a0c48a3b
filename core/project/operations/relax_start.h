// Where a relaxation of a project starts from, and which of its scans it is about.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/parameter.h"
#include "core/base/progress.h"
#include "core/multiview/relaxation.h"
#include "core/project/operation.h"
#include "core/project/operations/relaxation_feed.h"

namespace tiltmap {

enum class RelaxExtent {
  New,  // scans that the stage `relaxed` does not hold yet are put onto those that it does
  All,  // everything anew
};

struct RelaxSettings {
  RelaxationSettings relaxation;
  std::string pin;
  RelaxExtent extent = RelaxExtent::New;
  bool judge = true;
  int threads = 0;
};
const ParameterTable<RelaxSettings>& relaxParameters();

// Where the relaxation starts from, and what links there are.
struct RelaxStart {
  std::vector<Pose> world_from_scan;
  std::vector<Link> links;
  std::vector<EditStep> steps;  // of the registration that came first; empty where there was none
  std::vector<std::string> warnings;
  bool registered_first = false;
};

// Pairs of scans that a link joins, for asking quickly.
class JoinedPairs {
 public:
  void add(ScanId a, ScanId b);
  bool contains(ScanId a, ScanId b) const;  // either way round
  void sort();                              // once all are added, before the first question

 private:
  std::vector<std::pair<ScanId, ScanId>> pairs_;
};

// Links of an operation that are to be computed from: `constraints` and `excluded` of the input.
void addLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links, RelaxationInput& input);

// The pairwise poses; where there are none, the pairs are registered first, as `register` does it.
Result<RelaxStart> startOf(const SnapshotPtr& snapshot, const RelaxSettings& settings,
                           const JobControl& control);

// Scans that came after the last relaxation, ascending: by these alone the project differs from what was
// relaxed. Empty where everything is to be relaxed: that is asked for, no relaxation was accepted (or with
// other parameters), all scans are in it, more than half as many came as it holds, scan 0 or a pinned one is
// new, or the project has been changed in another way since (links, pins, geometries ...).
std::vector<int> addedSinceRelaxation(const ProjectSnapshot& snapshot, const RelaxSettings& settings,
                                      const std::vector<int>& pins);

// The relaxed poses; each added scan is put to the one before it by the link of the two, which is registered
// first where nobody has tried it.
Result<RelaxStart> startOfAdded(const SnapshotPtr& snapshot, const std::vector<int>& added,
                                const RelaxSettings& settings, const JobControl& control);

// The scans that are named, prepared; scans without elements stand for the others. Waits while the feed,
// where there is one, is paused.
Result<std::vector<PreparedScanPtr>> preparedScans(const ProjectSnapshot& snapshot,
                                                   const std::vector<int>& which,
                                                   const RelaxSettings& settings, const JobControl& control,
                                                   RelaxationFeed* feed);

}  // namespace tiltmap
