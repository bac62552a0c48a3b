// The two wires between a running computation and whoever started it: progress out, stop in.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

namespace tiltmap {

struct Progress {
  double fraction = 0.0;  // 0 to 1; negative where the length of the work is not known
  std::string message;    // "registering 4 to 3"
};

// Passed down by value. `report` may be called from any thread and must return quickly; it may be empty.
// A computation looks at `stop` at least every 50 ms and then ends with an Error whose what is kCancelled.
struct JobControl {
  std::function<void(const Progress&)> report;
  std::stop_token stop;

  void tell(double fraction, std::string message) const {
    if (report) report({fraction, std::move(message)});
  }
  bool stopRequested() const { return stop.stop_requested(); }
};

inline constexpr const char* kCancelled = "cancelled";

}  // namespace tiltmap
