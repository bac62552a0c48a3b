#include "tests/benchmarks/machine.h"

#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <omp.h>
#include <thread>

#include <Eigen/Core>
#include <tbb/global_control.h>

namespace tiltmap::benchmarks {

namespace {

// The rest of the first line of `path` that begins with `key`, without blanks and the colon.
std::string valueOf(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t begin = line.find_first_not_of(" \t:=\"", key.size());
    if (begin == std::string::npos) return "";
    return line.substr(begin, line.find_last_not_of(" \"") - begin + 1);
  }
  return "unknown";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  return text.data();
}

}  // namespace

std::string loadAverage() {
  std::ifstream file("/proc/loadavg");
  std::string one, five, fifteen;
  file >> one >> five >> fifteen;
  return one + " " + five + " " + fifteen;
}

std::vector<std::string> machineLines(const std::string& commit) {
  return {
      "date      " + today() + (commit.empty() ? "" : ", commit " + commit),
      "machine   " + valueOf("/proc/cpuinfo", "model name") + ", " +
          std::to_string(std::thread::hardware_concurrency()) + " cores, memory " +
          valueOf("/proc/meminfo", "MemTotal"),
      "system    " + valueOf("/etc/os-release", "PRETTY_NAME="),
      "compiler  g++ " __VERSION__ ", " TILTMAP_BUILD_FLAGS,
      "load      " + loadAverage() + " at the start",
  };
}

struct OneThread::Limit {
  int openmp = omp_get_max_threads();
  int eigen = Eigen::nbThreads();
  tbb::global_control tbb{tbb::global_control::max_allowed_parallelism, 1};
};

OneThread::OneThread() : limit_(std::make_unique<Limit>()) {
  omp_set_num_threads(1);
  Eigen::setNbThreads(1);
}

OneThread::~OneThread() {
  omp_set_num_threads(limit_->openmp);
  Eigen::setNbThreads(limit_->eigen);
}

}  // namespace tiltmap::benchmarks
