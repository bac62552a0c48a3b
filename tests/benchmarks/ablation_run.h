// What each ingredient of the preset `default` is worth: the same pairs with one of them switched off at a
// time.
#pragma once

#include "tests/benchmarks/pair_method.h"

namespace tiltmap::benchmarks {

// The preset first, then a method for each ingredient left out or replaced by something simpler.
std::vector<PairMethod> ablations();

}  // namespace tiltmap::benchmarks
