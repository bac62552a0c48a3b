#include "hardware/transport/pseudo_terminal.h"

#include <array>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <termios.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

// A client written with nothing but the system's calls.
class Client {
 public:
  explicit Client(const std::string& path, speed_t rate = B38400)
      : descriptor_(::open(path.c_str(), O_RDWR | O_NOCTTY)) {
    termios settings{};
    tcgetattr(descriptor_, &settings);
    cfmakeraw(&settings);
    cfsetspeed(&settings, rate);
    tcsetattr(descriptor_, TCSANOW, &settings);
  }
  ~Client() { ::close(descriptor_); }
  int descriptor_;
};

TEST(PseudoTerminal, CarriesEveryByteAndTellsTheClientsRate) {
  const test::TemporaryFolder folder;
  const std::string link = (folder.path() / "scanner").string();
  RealClock clock;
  auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  EXPECT_EQ((*terminal)->peerLine().baud, 9600);
  {
    Client client(link, B500000);
    ASSERT_GE(client.descriptor_, 0);
    EXPECT_EQ((*terminal)->peerLine().baud, 500000);
    ByteVector all(256);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Byte>(i);
    ASSERT_EQ(::write(client.descriptor_, all.data(), all.size()), 256);
    ByteVector got;
    std::array<Byte, 100> buffer;
    while (got.size() < 256) {
      const auto count = (*terminal)->read(buffer, clock.now() + 5s);
      ASSERT_TRUE(count && *count > 0);
      got.insert(got.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
    }
    EXPECT_EQ(got, all);
    ASSERT_TRUE((*terminal)->write(all));
    got.assign(256, 0);
    std::size_t filled = 0;
    while (filled < 256) {
      const ssize_t count = ::read(client.descriptor_, got.data() + filled, 256 - filled);
      ASSERT_GT(count, 0);
      filled += static_cast<std::size_t>(count);
    }
    EXPECT_EQ(got, all);
  }
  // The client is gone, the terminal is not: another one may come.
  std::array<Byte, 4> buffer;
  EXPECT_EQ((*terminal)->read(buffer, clock.now() + 5ms).value(), 0U);
  EXPECT_TRUE((*terminal)->write(ByteVector(10000, 1))) << "nobody listens: no failure";
  Client second(link);
  EXPECT_GE(second.descriptor_, 0);
  (*terminal)->close();
  EXPECT_FALSE(std::filesystem::is_symlink(link));
  EXPECT_FALSE((*terminal)->read(buffer, clock.now()));
}

TEST(PseudoTerminal, ReplacesALinkButNoFile) {
  const test::TemporaryFolder folder;
  RealClock clock;
  const std::string link = (folder.path() / "link").string(), file = (folder.path() / "file").string();
  std::filesystem::create_symlink("/nowhere", link);
  std::ofstream(file) << "mine";
  const auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) GTEST_SKIP() << terminal.error().what;
  EXPECT_EQ(std::filesystem::read_symlink(link).string(), (*terminal)->name());
  const auto refused = PseudoTerminal::open(clock, file);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, file);
  EXPECT_TRUE(std::filesystem::is_regular_file(file));
}

}  // namespace
}  // namespace tiltmap
