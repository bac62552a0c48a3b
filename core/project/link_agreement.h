// Links against each other: loops that do not close, and links that contradict the rest.
#pragma once

#include <vector>

#include "core/project/project_snapshot.h"
#include "core/registration/judgement_settings.h"

namespace tiltmap {

// What the others say about one link.
struct LinkAgreement {
  LinkId link = 0;
  // Other links tie its two scans too; where not, nothing speaks for or against it and the figures are zero.
  bool supported = false;
  // Leave-one-out: the link's pose against where the others put its scans, and that over what both are
  // uncertain by (root of the normalised square over its 6 degrees of freedom: about 1 where all is well).
  PoseDifference off;
  double deviations = 0.0;
  // The contradiction is the link's own. Where not, others in its loop contradict as much: one of them is
  // wrong.
  bool own = true;
  // How far the shortest loop through it is from closing, and of how many links that is with itself; 0: none.
  PoseDifference misclosure;
  int loop = 0;
};

// By id: links that are found, disabled ones too (asked about, but not asked). A link without a judgement is
// as certain as its registration said, one set by hand without either as informationByHand() says. Links
// judged bad are asked about only, and those that a relaxation found: they stand where it put the scans and
// measure nothing. One after the other the link that contradicts most is set aside, until none does (data
// snooping, after Baarda 1968), so that it does not speak against the good ones; what it is off is then told
// from those. All leave-one-out figures of one round come from one solution. Some ms for 100 links. Empty
// where the links cannot be solved together.
std::vector<LinkAgreement> linkAgreements(const ProjectSnapshot& snapshot,
                                          const JudgementSettings& settings = {});
// The same of links that are not in the snapshot as they are here (ascending ids, scans of the snapshot).
std::vector<LinkAgreement> linkAgreements(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                                          const JudgementSettings& settings);

}  // namespace tiltmap
