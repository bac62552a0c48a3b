// Capturing stops into the open project: an operation like the others, which stores while it runs.
#pragma once

#include <memory>

#include "core/project/operation.h"
#include "hardware/tilt/manual_unit.h"

namespace tiltmap {

// `ask` puts questions to the operator: angles of a tilt set by hand, and the way driven between several
// stops. Empty: there is nobody to ask, and what would need it is refused.
std::unique_ptr<Operation> makeCaptureOperation(AskOperator ask = {});

// "X,Y,HEADING": metres to the right and forward in the frame of the last stop, and the change of heading in
// degrees, left positive. last_from_next; empty text: did not move.
Result<Pose> parseStep(const std::string& text);

}  // namespace tiltmap
