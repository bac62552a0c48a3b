// What a relaxation did, in words: for logs on a terminal and in a window.
#pragma once

#include <string>

#include "core/multiview/relaxation.h"

namespace tiltmap {

// "scan 3 moved by 12.3 mm, 0.041°"
std::string relaxationEventText(const RelaxationEvent& event);

}  // namespace tiltmap
