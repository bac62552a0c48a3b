#include "hardware/lms2xx/framer.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "hardware/lms2xx/requests.h"

namespace tiltmap::lms2xx {
namespace {

ByteVector someScan(RandomStream& random, std::size_t values) {
  ByteVector data{static_cast<Byte>(values & 255), static_cast<Byte>(values >> 8)};
  for (std::size_t i = 0; i < 2 * values; ++i) data.push_back(static_cast<Byte>(random.below(256)));
  return encodeAnswer(0xB0, data, 0x10);
}

std::vector<ByteVector> telegramsOf(Framer& framer) {
  std::vector<ByteVector> found;
  while (const auto token = framer.next())
    if (const auto* telegram = std::get_if<Telegram>(&*token)) found.push_back(encode(*telegram));
  return found;
}

TEST(Framer, AcknowledgeThenAnswer) {
  Framer framer;
  framer.push(parseHex("06 02 80 03 00 A0 00 10 16 0A 15").value());
  EXPECT_EQ(framer.next(), Token(Ack{}));
  EXPECT_EQ(std::get<Telegram>(*framer.next()).command(), 0xA0);
  EXPECT_EQ(framer.next(), Token(Nak{}));
  EXPECT_FALSE(framer.next());
  EXPECT_FALSE(framer.waiting());
  EXPECT_EQ(framer.counts().noise, 0U);
}

TEST(Framer, AnyPiecesGiveTheSame) {
  RandomStream random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<ByteVector> sent;
    ByteVector stream;
    for (int i = 0; i < 5; ++i) {
      sent.push_back(someScan(random, random.below(402)));
      stream.insert(stream.end(), sent.back().begin(), sent.back().end());
    }
    Framer framer;
    std::vector<ByteVector> found;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t piece = std::min<std::size_t>(stream.size() - at, 1 + random.below(300));
      framer.push(std::span(stream).subspan(at, piece));
      at += piece;
      for (auto& telegram : telegramsOf(framer)) found.push_back(std::move(telegram));
      EXPECT_LE(framer.buffered(), kLongestPayload + kOverhead + 300);
    }
    EXPECT_EQ(found, sent);
    EXPECT_EQ(framer.counts().noise, 0U);
  }
}

TEST(Framer, FindsEveryTelegramBehindAnyNoise) {
  RandomStream random(8);
  for (int round = 0; round < 200; ++round) {
    Framer framer;
    ByteVector noise(random.below(600));
    for (Byte& byte : noise)
      byte = random.below(3) == 0   ? kStx
             : random.below(3) == 0 ? Byte{0x80}
                                    : static_cast<Byte>(random.below(256));
    const ByteVector telegram = someScan(random, 361);
    framer.push(noise);
    framer.push(telegram);
    auto found = telegramsOf(framer);
    // A false beginning may wait for more than there is; silence then tells that it was none.
    while (framer.giveUpFirst())
      for (auto& later : telegramsOf(framer)) found.push_back(std::move(later));
    EXPECT_NE(std::ranges::find(found, telegram), found.end()) << "round " << round;
  }
}

TEST(Framer, ACutScanDoesNotHideTheAnswerBehindIt) {
  RandomStream random(9);
  ByteVector stream = someScan(random, 361);
  stream.resize(200);
  const ByteVector answer = parseHex("06 02 80 03 00 A0 00 10 16 0A").value();
  stream.insert(stream.end(), answer.begin(), answer.end());
  Framer framer;
  framer.push(stream);
  EXPECT_TRUE(telegramsOf(framer).empty()) << "it looks like a scan that goes on";
  EXPECT_EQ(framer.begunCommand(), 0xB0);
  std::vector<ByteVector> found;
  while (found.empty() && framer.giveUpFirst()) found = telegramsOf(framer);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(hexText(found[0]), "02 80 03 00 A0 00 10 16 0A");
  EXPECT_GT(framer.counts().cut, 0U);
}

TEST(Framer, OneWrongBitIsFoundAndTheNextTelegramStillThere) {
  const ByteVector first = parseHex("02 80 0A 00 B0 03 00 F4 01 F5 01 F6 01 10 42 08").value();
  const ByteVector second = parseHex("02 80 03 00 A0 00 10 16 0A").value();
  for (std::size_t bit = 0; bit < first.size() * 8; ++bit) {
    ByteVector stream = first;
    stream[bit / 8] = static_cast<Byte>(stream[bit / 8] ^ 1U << bit % 8);
    stream.insert(stream.end(), second.begin(), second.end());
    Framer framer;
    framer.push(stream);
    auto found = telegramsOf(framer);
    while (framer.giveUpFirst())
      for (auto& later : telegramsOf(framer)) found.push_back(std::move(later));
    // Another address of the same unit is the one change that the checksum is asked about and that stays
    // plausible; even that it finds.
    ASSERT_EQ(found.size(), 1U) << "bit " << bit;
    EXPECT_EQ(found[0], second);
  }
}

TEST(Framer, HearsOneSideOnly) {
  Framer host(Sender::Host);
  host.push(parseHex("02 80 03 00 A0 00 10 16 0A 06 02 00 01 00 31 15 12").value());
  const auto found = telegramsOf(host);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(hexText(found[0]), "02 00 01 00 31 15 12");
  Framer scanner;
  scanner.push(parseHex("02 00 01 00 31 15 12").value());
  EXPECT_TRUE(telegramsOf(scanner).empty());
  // Any unit's address is taken.
  scanner.push(encodeAnswer(0xA0, ByteVector{0}, 0x10, 0x7F));
  EXPECT_EQ(telegramsOf(scanner).size(), 1U);
}

TEST(Framer, ImpossibleLengthsAreNoTelegrams) {
  Framer framer;
  framer.push(parseHex("02 80 00 00 02 80 35 03 02 80 FF FF").value());
  EXPECT_TRUE(telegramsOf(framer).empty());
  EXPECT_FALSE(framer.waiting());
  EXPECT_EQ(framer.counts().noise, 12U);
  framer.push(parseHex("02 80").value());
  EXPECT_FALSE(framer.next());
  EXPECT_TRUE(framer.waiting());
  framer.clear();
  EXPECT_FALSE(framer.waiting());
  EXPECT_FALSE(framer.giveUpFirst());
}

}  // namespace
}  // namespace tiltmap::lms2xx
