#include "hardware/transport/pseudo_terminal.h"

// termios2 tells any rate as a number; its header must not meet <termios.h>.
#include <algorithm>
#include <array>
#include <asm/termbits.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tiltmap {

namespace {

constexpr std::size_t kMostPending = 65536;
constexpr auto kLongestPending = std::chrono::milliseconds(500);

Error systemError(const std::string& what, const std::string& where) {
  return {what + ": " + std::strerror(errno), where,
          "look at /dev/pts; without pseudo terminals run emulator and driver in memory"};
}

// ByteVector as they are, no echo, no signals, 9600.
bool makeRaw(int descriptor) {
  termios2 settings{};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return false;
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = B9600 | CS8 | CREAD | CLOCAL;
  settings.c_ispeed = settings.c_ospeed = 9600;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return ioctl(descriptor, TCSETS2, &settings) == 0;
}

Status makeLink(const std::string& target, const std::string& link) {
  struct stat found {};
  if (lstat(link.c_str(), &found) == 0) {
    if (!S_ISLNK(found.st_mode))
      return fail("there is something that is not a link", link, "name another path for the link");
    unlink(link.c_str());
  }
  if (symlink(target.c_str(), link.c_str()) != 0)
    return fail(std::string("cannot make the link: ") + std::strerror(errno), link,
                "name a path in a folder that you may write");
  return {};
}

}  // namespace

Result<std::unique_ptr<PseudoTerminal>> PseudoTerminal::open(RealClock& clock, const std::string& link) {
  std::unique_ptr<PseudoTerminal> terminal(new PseudoTerminal(clock));
  terminal->master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 128> name{};
  if (terminal->master_ < 0 || grantpt(terminal->master_) != 0 || unlockpt(terminal->master_) != 0 ||
      ptsname_r(terminal->master_, name.data(), name.size()) != 0)
    return fail(systemError("cannot make a pseudo terminal", "/dev/ptmx"));
  terminal->name_ = name.data();
  terminal->slave_ = ::open(name.data(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (terminal->slave_ < 0 || !makeRaw(terminal->slave_))
    return fail(systemError("cannot set up the pseudo terminal", terminal->name_));
  if (!link.empty()) {
    if (const auto made = makeLink(terminal->name_, link); !made) return fail(made.error());
    terminal->link_ = link;
  }
  return terminal;
}

PseudoTerminal::~PseudoTerminal() {
  close();
}

void PseudoTerminal::close() {
  if (!link_.empty()) unlink(link_.c_str());
  link_.clear();
  if (slave_ >= 0) ::close(slave_);
  if (master_ >= 0) ::close(master_);
  master_ = slave_ = -1;
}

Result<std::size_t> PseudoTerminal::read(std::span<Byte> buffer, Instant deadline) {
  for (;;) {
    if (master_ < 0) return fail("the pseudo terminal is closed", name_, "open another one");
    if (!pending_.empty())
      if (const auto flushed = flush(); !flushed) return fail(flushed.error());
    const ssize_t count = ::read(master_, buffer.data(), buffer.size());
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && errno != EAGAIN && errno != EINTR && errno != EIO)
      return fail(systemError("cannot read", name_));
    const auto left = deadline == kNever ? std::chrono::steady_clock::duration::max()
                      : deadline == Instant::min()
                          ? std::chrono::steady_clock::duration::zero()
                          : clock_.systemTime(deadline) - std::chrono::steady_clock::now();
    if (left <= std::chrono::steady_clock::duration::zero()) return 0;
    // Rounded up, so that the last fraction of a millisecond is not spent turning round and round.
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(
        std::min<std::chrono::steady_clock::duration>(left, std::chrono::seconds(1)));
    pollfd watched{master_, POLLIN, 0};
    poll(&watched, 1, static_cast<int>(wait.count()));
  }
}

Status PseudoTerminal::write(std::span<const Byte> bytes) {
  if (pending_.empty()) moved_ = std::chrono::steady_clock::now();
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  return flush();
}

Status PseudoTerminal::flush() {
  if (master_ < 0) return fail("the pseudo terminal is closed", name_, "open another one");
  const auto now = std::chrono::steady_clock::now();
  std::size_t written = 0;
  while (written < pending_.size()) {
    const ssize_t count = ::write(master_, pending_.data() + written, pending_.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EIO)) break;
    if (count < 0) return fail(systemError("cannot write", name_));
    written += static_cast<std::size_t>(count);
    moved_ = now;
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(written));
  if (pending_.size() > kMostPending || now - moved_ > kLongestPending) pending_.clear();
  return {};
}

Status PseudoTerminal::setLine(const LineSettings& line) {
  line_ = line;
  return {};
}

LineSettings PseudoTerminal::peerLine() const {
  termios2 settings{};
  LineSettings line;
  if (slave_ < 0 || ioctl(slave_, TCGETS2, &settings) != 0) return line;
  line.baud = static_cast<int>(settings.c_ospeed);
  // Linux clears the parity bits of pseudo terminals, so None is all that can be seen.
  if (settings.c_cflag & PARENB) line.parity = settings.c_cflag & PARODD ? Parity::Odd : Parity::Even;
  return line;
}

}  // namespace tiltmap
