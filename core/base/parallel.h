// Running independent pieces of work on several threads, with results that do not depend on how many.
#pragma once

#include <cstddef>
#include <functional>

namespace tiltmap {

// Calls body(i) once for every i in [0, count), on at most `threads` threads (0: all cores). The body writes
// only to slots of its own index; sums over indices are made by the caller afterwards, in order. An exception
// thrown by a body is thrown again here.
void parallelFor(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace tiltmap
