// Running the program as a user would: words in, exit code and both outputs back.
#pragma once

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace tiltmap::test {

struct ProgramRun {
  int exit_code = -1;  // 128 + signal where one ended the program
  std::string out;
  std::string err;
};

inline std::string fileText(const std::filesystem::path& path) {
  return bytesOf(path);
}

inline void writeFile(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// The program under test: the environment variable TILTMAP_PROGRAM, set by CTest.
inline std::string programPath() {
  const char* path = std::getenv("TILTMAP_PROGRAM");
  if (path == nullptr)
    throw std::runtime_error("TILTMAP_PROGRAM is not set; run the tests through ctest or tests/run");
  return path;
}

// Starts the program in `folder` without waiting; its outputs go to out.txt and err.txt there.
inline pid_t startTiltmap(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  const std::string program = programPath();
  const std::string out = folder / "out.txt", err = folder / "err.txt";
  const pid_t child = fork();
  if (child != 0) return child;
  if (chdir(folder.c_str()) != 0) _exit(126);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDERR_FILENO);
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  _exit(127);
}

inline ProgramRun waitForTiltmap(pid_t child, const std::filesystem::path& folder) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), fileText(folder / "out.txt"),
          fileText(folder / "err.txt")};
}

inline ProgramRun tiltmap(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  return waitForTiltmap(startTiltmap(words, folder), folder);
}

}  // namespace tiltmap::test
