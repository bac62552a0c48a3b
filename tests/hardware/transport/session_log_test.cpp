#include "hardware/transport/session_log.h"

#include <array>

#include <gtest/gtest.h>

#include "hardware/transport/memory_channel.h"
#include "hardware/transport/replay_channel.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace std::chrono_literals;

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A question and its answer, and one that stays without.
struct Talk {
  ByteVector first, second;
  Duration first_took{}, second_took{};
  bool operator==(const Talk&) const = default;
};

Result<ByteVector> ask(ByteChannel& channel, Clock& clock, const ByteVector& question, std::size_t length) {
  if (const auto written = channel.write(question); !written) return fail(written.error());
  ByteVector answer;
  std::array<Byte, 64> buffer;
  const Instant deadline = clock.now() + 100ms;
  while (answer.size() < length) {
    const auto count = channel.read(buffer, deadline);
    if (!count) return fail(count.error());
    if (*count == 0) break;
    answer.insert(answer.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*count));
  }
  return answer;
}

Result<Talk> talk(ByteChannel& channel, Clock& clock) {
  Talk heard;
  const Instant begin = clock.now();
  auto first = ask(channel, clock, {1, 2, 3}, 4);
  if (!first) return fail(first.error());
  heard.first = *first;
  heard.first_took = clock.now() - begin;
  auto second = ask(channel, clock, {4}, 4);
  if (!second) return fail(second.error());
  heard.second = *second;
  heard.second_took = clock.now() - begin;
  return heard;
}

// Answers three bytes with four, ten milliseconds later, one by one; anything else with silence.
class Answerer : public Actor {
 public:
  Answerer(VirtualClock& clock, DeviceWire& wire) : clock_(clock), wire_(wire) { clock_.attach(*this); }
  ~Answerer() override { clock_.detach(*this); }
  Instant nextEvent() const override { return left_ > 0 ? due_ : wire_.nextArrival(); }
  void act(Instant now) override {
    std::array<Byte, 64> buffer;
    if (left_ > 0) {
      ASSERT_TRUE(wire_.write(std::array<Byte, 1>{static_cast<Byte>(left_--)}));
      due_ = now + 1ms;
      return;
    }
    heard_ += wire_.read(buffer, Instant::min()).value();
    if (heard_ == 3) {
      left_ = 4;
      due_ = now + 10ms;
    }
  }

 private:
  VirtualClock& clock_;
  DeviceWire& wire_;
  std::size_t heard_ = 0;
  int left_ = 0;
  Instant due_{};
};

Talk recordTalk(const std::filesystem::path& file) {
  VirtualClock clock;
  clock.sleepFor(5s);
  MemoryPair pair = MemoryPair::make(clock);
  Answerer answerer(clock, *pair.device);
  LoggedChannel channel(std::move(pair.host), SessionLog::create(file, "lms2xx:somewhere").value(), clock);
  const auto heard = talk(channel, clock);
  EXPECT_TRUE(heard);
  EXPECT_EQ(heard->first, (ByteVector{4, 3, 2, 1}));
  EXPECT_TRUE(heard->second.empty());
  pair.unplug();
  std::array<Byte, 4> buffer;
  EXPECT_FALSE(channel.read(buffer, clock.now()));
  EXPECT_FALSE(channel.read(buffer, clock.now()));
  return *heard;
}

TEST(SessionLog, HoldsBothDirectionsInOrderAndReadsBack) {
  const test::TemporaryFolder folder;
  recordTalk(folder / "a.wire");
  const auto session = readSession(folder / "a.wire");
  ASSERT_TRUE(session) << session.error().what;
  EXPECT_EQ(session->about, "lms2xx:somewhere");
  EXPECT_GT(session->begun_unix_s, 1.6e9);
  ASSERT_EQ(session->records.size(), 9U);
  EXPECT_EQ(session->records[0].kind, WireRecord::Kind::Opened);
  EXPECT_EQ(session->records[0].text, "in memory");
  EXPECT_EQ(session->records[1].kind, WireRecord::Kind::Line);
  EXPECT_EQ(session->records[1].line, LineSettings{9600});
  EXPECT_EQ(session->records[2].kind, WireRecord::Kind::Sent);
  EXPECT_EQ(session->records[2].bytes, (ByteVector{1, 2, 3}));
  EXPECT_EQ(session->records[3].kind, WireRecord::Kind::Received);
  EXPECT_EQ(session->records[7].bytes, (ByteVector{4}));
  EXPECT_EQ(session->records[8].kind, WireRecord::Kind::Lost) << "told once";
  // Written and read, the text is the same.
  std::string again;
  for (const WireRecord& record : session->records) again += recordText(record);
  EXPECT_TRUE(contentOf(folder / "a.wire").ends_with(again));
}

TEST(SessionLog, NeitherWritesOverAFileNorTakesAnythingForASession) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("there", "mine\n");
  EXPECT_FALSE(SessionLog::create(file, "x"));
  EXPECT_EQ(contentOf(file), "mine\n");
  EXPECT_NE(readSession(file).error().where.find("line 1"), std::string::npos);
  EXPECT_FALSE(readSession(folder / "absent"));
  const std::string head = "# tiltmap wire session 1\n# x\n# begun 1.0\n";
  for (const char* bad : {"0.5 ? 02\n", "0.5 > \n", "0.5 > 0\n", "x > 02\n", "-1 > 02\n", "0.5 = fast 8N1\n",
                          "0.5 = 9600 7N1\n", "2.0 > 02\n1.0 > 02\n", "nan > 02\n"})
    EXPECT_FALSE(parseSession(head + bad, "f")) << bad;
}

TEST(SessionLog, ACutOffLastLineIsLeftOut) {
  const std::string head = "# tiltmap wire session 1\n# x\n# begun 1.0\n0.5 > 02 03\n";
  const auto session = parseSession(head + "0.6 < 06 0", "f");
  ASSERT_TRUE(session);
  EXPECT_EQ(session->records.size(), 1U);
}

TEST(Replay, TheSameDriverHearsTheSame) {
  const test::TemporaryFolder folder;
  const Talk then = recordTalk(folder / "a.wire");
  VirtualClock clock;
  clock.sleepFor(77s);
  ReplayChannel channel(readSession(folder / "a.wire").value(), clock);
  const auto now = talk(channel, clock);
  ASSERT_TRUE(now) << now.error().what;
  EXPECT_EQ(*now, then) << "bytes and times";
  EXPECT_EQ(channel.line().baud, 9600);
  std::array<Byte, 4> buffer;
  EXPECT_FALSE(channel.read(buffer, clock.now() + 1s)) << "the plug was pulled then";
  EXPECT_EQ(channel.state(), ChannelState::Lost);
  EXPECT_TRUE(channel.finished());
}

TEST(Replay, FasterAndStepwise) {
  const test::TemporaryFolder folder;
  const Talk then = recordTalk(folder / "a.wire");
  VirtualClock clock;
  std::vector<ByteVector> stepped;
  ReplayChannel channel(readSession(folder / "a.wire").value(), clock, 2.0,
                        [&](const WireRecord& record) { stepped.push_back(record.bytes); });
  EXPECT_EQ(ask(channel, clock, {1, 2, 3}, 4).value(), (ByteVector{4, 3, 2, 1}));
  EXPECT_NEAR(secondsOf(clock.now() - Instant{}), secondsOf(then.first_took) / 2, 1e-6);
  EXPECT_EQ(stepped, (std::vector<ByteVector>{{4}, {3}, {2}, {1}}));
}

TEST(Replay, AnotherQuestionIsRefusedWithBoth) {
  const test::TemporaryFolder folder;
  recordTalk(folder / "a.wire");
  VirtualClock clock;
  ReplayChannel channel(readSession(folder / "a.wire").value(), clock);
  std::array<Byte, 4> buffer;
  EXPECT_EQ(channel.read(buffer, clock.now() + 1s).value(), 0U) << "no answer before the question";
  const auto refused = channel.write(ByteVector{1, 2, 9});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("01 02 09"), std::string::npos);
  EXPECT_NE(refused.error().what.find("01 02 03"), std::string::npos);
  // In pieces is the same bytes.
  EXPECT_TRUE(channel.write(ByteVector{1, 2}));
  EXPECT_TRUE(channel.write(ByteVector{3, 4}));
  EXPECT_FALSE(channel.write(ByteVector{5})) << "the recording has nothing more";
}

}  // namespace
}  // namespace tiltmap
