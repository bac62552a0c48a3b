#include "hardware/tilt/mip50_codec.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "hardware/transport/byte_channel.h"

namespace tiltmap {
namespace {

std::string bytes(std::string_view hex) {
  const auto parsed = parseHex(hex);
  if (!parsed) throw std::invalid_argument(std::string(hex));
  return {parsed->begin(), parsed->end()};
}

struct CommandVector {
  Mip50Command command;
  const char* hex;
};
// As they are known from software that runs real controllers, axis 1.
const CommandVector kCommands[] = {
    {{Mip50Verb::ClearError, 1, 0.0, 0}, "45 31 78 47"},
    {{Mip50Verb::Ramp, 1, 0.2, 0}, "43 31 78 32 72 32 74 30 2E 32 47"},
    {{Mip50Verb::Speed, 1, 100.0, 0}, "56 31 78 31 30 30 47"},
    {{Mip50Verb::RegulationOn, 1, 0.0, 0}, "6E 31 78 47"},
    {{Mip50Verb::RegulationOff, 1, 0.0, 0}, "66 31 78 47"},
    {{Mip50Verb::Home, 1, 0.0, 0}, "48 31 78 47"},
    {{Mip50Verb::MoveAbsolute, 1, 42800.0, 0}, "41 31 78 34 32 38 30 30 47"},
    {{Mip50Verb::MoveRelative, 1, 6945.0, 0}, "52 31 78 36 39 34 35 47"},
    {{Mip50Verb::ReadPosition, 1, 0.0, 0}, "50 31 78 47"},
    {{Mip50Verb::ReadParameter, 1, 0.0, 33}, "71 31 78 33 33 70 47"},
    {{Mip50Verb::WriteParameter, 1, 5700.0, 33}, "77 31 78 33 33 70 35 37 30 30 47"},
};

TEST(Mip50Codec, EveryCommandBothWays) {
  const Mip50Table table;
  for (const CommandVector& vector : kCommands) {
    EXPECT_EQ(encodeCommand(table, vector.command), bytes(vector.hex)) << vector.hex;
    const auto decoded = decodeCommand(table, bytes(vector.hex));
    ASSERT_TRUE(decoded) << vector.hex;
    EXPECT_EQ(*decoded, vector.command) << vector.hex;
  }
  EXPECT_EQ(encodeCommand(table, {Mip50Verb::MoveAbsolute, 1, -694500.0, 0}), "A1x-694500G");
  EXPECT_EQ(encodeCommand(table, {Mip50Verb::Ramp, 12, 2.0, 0}), "C12x2r2t2G");
}

TEST(Mip50Codec, WhatIsNoCommandIsNone) {
  const Mip50Table table;
  for (const char* text :
       {"", "G", "A1xG", "A1x--5G", "A1x42800", "A1x42800GG", "Z1xG", "A1x99999999999999999999G", "Ax5G",
        "A1x5 G", "q1x33G", "P-1xG", "P1.5xG", "A1xnanG"})
    EXPECT_FALSE(decodeCommand(table, text)) << text;
}

TEST(Mip50Codec, ACommandThatTheTableDoesNotHaveIsEmpty) {
  Mip50Table table;
  table.move_relative.clear();
  EXPECT_EQ(encodeCommand(table, {Mip50Verb::MoveRelative, 1, 5.0, 0}), "");
  EXPECT_FALSE(decodeCommand(table, "R1x5G"));
  EXPECT_FALSE(decodeCommand(table, ""));
}

std::vector<Mip50Answer> read(std::string_view text) {
  const Mip50Table table;
  Mip50AnswerReader reader(table);
  std::vector<Mip50Answer> answers;
  reader.take(text, answers);
  return answers;
}

TEST(Mip50Codec, EveryAnswerBothWays) {
  const Mip50Table table;
  const std::string done = bytes("0D 0A 58 30");
  EXPECT_EQ(encodeAnswer(table, Mip50Done{}), done);
  EXPECT_EQ(read(done), std::vector<Mip50Answer>{Mip50Done{}});

  const std::string position = bytes("0D 0A 4D 23 32 31 20 20 20 20 31") + "      42800\r\n";
  EXPECT_EQ(encodeAnswer(table, Mip50Value{21, {1, 42800}}), position);
  EXPECT_EQ(read(position + done), (std::vector<Mip50Answer>{Mip50Value{21, {1, 42800}}, Mip50Done{}}));

  EXPECT_EQ(read("\r\nM#26 1 33 5700\r\n"), (std::vector<Mip50Answer>{Mip50Value{26, {1, 33, 5700}}}));
  EXPECT_EQ(read("\r\nM#20    1   7\r\n"), (std::vector<Mip50Answer>{Mip50Value{20, {1, 7}}}));
  EXPECT_EQ(read("\r\nM#57 1 2\r\n"), (std::vector<Mip50Answer>{Mip50Value{57, {1, 2}}}));
  EXPECT_EQ(read("\r\nM#21 1 -15000\r\n"), (std::vector<Mip50Answer>{Mip50Value{21, {1, -15000}}}));

  const std::string refusal = "\r\nE#180 1 'A'\r\n";
  EXPECT_EQ(encodeAnswer(table, Mip50Refusal{180, 1, 'A'}), refusal);
  EXPECT_EQ(read(refusal), (std::vector<Mip50Answer>{Mip50Refusal{180, 1, 'A'}}));
  EXPECT_EQ(read("\r\nE#181 1 'A'\r\n"), (std::vector<Mip50Answer>{Mip50Refusal{181, 1, 'A'}}));

  for (const bool entered : {true, false}) {
    const std::string banner = encodeAnswer(table, Mip50Banner{entered});
    EXPECT_EQ(read(banner), std::vector<Mip50Answer>{Mip50Banner{entered}});
  }
  EXPECT_EQ(encodeAnswer(table, Mip50Banner{true}), "\r\nP0 ASCII - Commandmode\r\n");
  EXPECT_EQ(encodeAnswer(table, Mip50Banner{false}), "\r\nP0 End ASCII - Commandmode\r\n");
}

TEST(Mip50Codec, TheAcknowledgeCountsWithoutALineEndAndLineEndsMayBeAny) {
  EXPECT_EQ(read("X0"), std::vector<Mip50Answer>{Mip50Done{}});
  EXPECT_EQ(read("\n\rX0\r\r\n\nX0X0"), (std::vector<Mip50Answer>{Mip50Done{}, Mip50Done{}, Mip50Done{}}));
  EXPECT_TRUE(read("\r\n\n\r").empty());
  EXPECT_TRUE(read("\r\nM#21 1 5").empty()) << "a value counts when its line has ended: digits may follow";
}

TEST(Mip50Codec, WhatMeansNothingIsNoise) {
  for (const char* line : {"M#21", "M#x 1 2", "M#21 1 2 3 4 5 6 7 8", "M#21 1 4x8", "M#21 1 99999999999",
                           "E#", "E#180 1 A", "E#180 1 'AB'", "hello", "M#-1 1 2", "X1"}) {
    const auto answers = read(std::string("\r\n") + line + "\r\n");
    ASSERT_EQ(answers.size(), 1U) << line;
    EXPECT_TRUE(std::holds_alternative<Mip50Noise>(answers.front())) << line;
  }
}

TEST(Mip50Codec, ALineWithoutEndTakesNoMemory) {
  const Mip50Table table;
  Mip50AnswerReader reader(table);
  std::vector<Mip50Answer> answers;
  for (int i = 0; i < 1000; ++i) {
    reader.take("zzzzzzzzzz", answers);
    EXPECT_LE(reader.pending(), Mip50AnswerReader::kLongestLine + 1);
  }
  EXPECT_EQ(answers.size(), 1U);
  reader.take("\r\nX0", answers);
  EXPECT_EQ(answers.back(), Mip50Answer(Mip50Done{}));
}

TEST(Mip50Codec, AnySplittingGivesTheSameAnswers) {
  const Mip50Table table;
  RandomStream random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Mip50Answer> sent;
    std::string wire;
    for (int i = 0; i < 6; ++i) {
      const auto value = static_cast<std::int64_t>(random.below(4'000'000)) - 2'000'000;
      switch (random.below(4)) {
        case 0:
          sent.emplace_back(Mip50Done{});
          break;
        case 1:
          sent.emplace_back(Mip50Value{21, {1, value}});
          break;
        case 2:
          sent.emplace_back(Mip50Refusal{180, 1, 'A'});
          break;
        default:
          sent.emplace_back(Mip50Value{26, {1, static_cast<std::int64_t>(random.below(42)), value}});
          break;
      }
      wire += encodeAnswer(table, sent.back());
    }
    Mip50AnswerReader reader(table);
    std::vector<Mip50Answer> answers;
    for (std::string_view rest = wire; !rest.empty();) {
      const std::size_t part = std::min<std::size_t>(rest.size(), 1 + random.below(7));
      reader.take(rest.substr(0, part), answers);
      rest.remove_prefix(part);
    }
    EXPECT_EQ(answers, sent) << wire;
  }
}

TEST(Mip50Codec, CommandsAreReadHoweverTheyComeAndBadOnesAreTold) {
  const Mip50Table table;
  Mip50CommandReader reader(table);
  std::vector<Mip50CommandReader::Item> items;
  using Trouble = Mip50CommandReader::Trouble;
  // The three line ends that clients send, and none.
  reader.take("A1x42", items);
  EXPECT_TRUE(items.empty());
  reader.take("800G\r\nP1xG\n\rn1xGf1xG", items);
  ASSERT_EQ(items.size(), 4U);
  EXPECT_EQ(std::get<Mip50Command>(items[0]), (Mip50Command{Mip50Verb::MoveAbsolute, 1, 42800.0, 0}));
  EXPECT_EQ(std::get<Mip50Command>(items[3]).verb, Mip50Verb::RegulationOff);
  items.clear();
  reader.take("A1x4280A1x42800G" + std::string(200, '7') + "GP1xG", items);
  ASSERT_EQ(items.size(), 3U);
  EXPECT_EQ(std::get<Trouble>(items[0]), Trouble::Unknown);
  EXPECT_EQ(std::get<Trouble>(items[1]), Trouble::TooLong);
  EXPECT_EQ(std::get<Mip50Command>(items[2]).verb, Mip50Verb::ReadPosition);
}

}  // namespace
}  // namespace tiltmap
