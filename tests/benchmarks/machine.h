// What the figures were taken on.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace tiltmap::benchmarks {

// Date, machine, compiler and build, a line each. `commit` as the run script tells it; empty: not told.
std::vector<std::string> machineLines(const std::string& commit);
// "0.31 0.55 0.60": how busy the machine is; figures taken on a busy one say little.
std::string loadAverage();
// While it lives, the libraries of this process keep to one thread (OpenMP, oneTBB, Eigen), ours and the
// peers'.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

}  // namespace tiltmap::benchmarks
