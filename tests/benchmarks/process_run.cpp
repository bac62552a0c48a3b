#include "tests/benchmarks/process_run.h"

#include <chrono>
#include <fcntl.h>
#include <fstream>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

double milliseconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

}  // namespace

Ended run(const fs::path& program, const Arguments& arguments, const fs::path& scratch) {
  const std::string output = (scratch / "stdout").string();
  const std::string errors = (scratch / "stderr").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  std::string name = program.string();
  Arguments copy = arguments;
  std::vector<char*> argv{name.data()};
  for (std::string& argument : copy) argv.push_back(argument.data());
  argv.push_back(nullptr);

  Ended ended;
  const auto begin = std::chrono::steady_clock::now();
  pid_t child = 0;
  if (posix_spawn(&child, name.c_str(), &actions, nullptr, argv.data(), environ) == 0) {
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) == child && WIFEXITED(status)) ended.exit_code = WEXITSTATUS(status);
    ended.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
    ended.timing.cpu_ms = milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
  }
  ended.timing.wall_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  posix_spawn_file_actions_destroy(&actions);
  std::ifstream file(output);
  ended.output.assign(std::istreambuf_iterator<char>(file), {});
  return ended;
}

}  // namespace tiltmap::benchmarks
