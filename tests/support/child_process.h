// Running a piece of a test in a process of its own, to be killed or to have fewer rights.
#pragma once

#include <csignal>
#include <exception>
#include <filesystem>
#include <functional>
#include <linux/capability.h>
#include <stdexcept>
#include <string>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tiltmap::test {

// The body may say() lines, which the parent reads; it ends with the process.
class ChildProcess {
 public:
  using Say = std::function<void(const std::string&)>;

  explicit ChildProcess(const std::function<void(const Say&)>& body) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    id_ = ::fork();
    if (id_ < 0) throw std::runtime_error("no process");
    if (id_ == 0) {
      ::close(ends[0]);
      const auto say = [&](const std::string& line) {
        const std::string whole = line + "\n";
        [[maybe_unused]] const ssize_t written = ::write(ends[1], whole.data(), whole.size());
      };
      try {
        body(say);
      } catch (const std::exception& exception) {
        say(std::string("EXCEPTION: ") + exception.what());
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    read_end_ = ends[0];
  }
  ~ChildProcess() {
    kill();
    wait();
    ::close(read_end_);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void kill() {
    if (id_ > 0) ::kill(id_, SIGKILL);
  }
  // The next line, or "" when the child has ended.
  std::string line() {
    std::string text;
    char c = 0;
    while (::read(read_end_, &c, 1) == 1 && c != '\n') text += c;
    return text;
  }
  // Everything still to come, until it ends.
  std::string rest() {
    std::string text;
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(read_end_, buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<std::size_t>(n));
    return text;
  }
  // True when it ended by itself.
  bool wait() {
    int status = 0;
    if (id_ <= 0) return false;
    ::waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status);
  }

 private:
  pid_t id_ = -1;
  int read_end_ = -1;
};

// Root's capabilities given up, but not the user: no folder is read-only before them. The owner's permissions
// then count, also where the way to the folder is root's alone.
inline void giveUpRootsRights() {
  if (::geteuid() != 0) return;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3]{};
  if (::syscall(SYS_capset, &header, none) != 0) throw std::runtime_error("cannot give up root's rights");
}

inline void becomeNobody() {
  if (::setgid(65534) != 0 || ::setuid(65534) != 0) throw std::runtime_error("cannot become another user");
}

// Whether there is another user to become, and the way to the folder is open to that one.
inline bool nobodyReaches(const std::filesystem::path& folder) {
  if (::geteuid() != 0) return false;
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(1);
    ::_exit(::access(folder.c_str(), X_OK) == 0 ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace tiltmap::test
