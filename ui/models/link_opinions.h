// What is thought of the links of the project that is shown: computed anew only when links change.
#pragma once

#include <vector>

#include "core/project/link_quality.h"

namespace tiltmap::ui {

// A capture replaces the snapshot with every line, and several views ask: the links are held against each
// other once for all of them.
class LinkOpinions {
 public:
  // As judgeLinks(snapshot, stage).
  std::vector<LinkJudgement> of(const ProjectSnapshot& snapshot, Stage stage);
  int computed() const { return computed_; }  // times that the links were held against each other

 private:
  std::vector<Link> links_;
  std::vector<ScanId> scans_;
  JudgementSettings settings_;
  std::size_t jobs_ = 0;
  std::vector<LinkAgreement> agreements_;
  int computed_ = 0;
};

}  // namespace tiltmap::ui
