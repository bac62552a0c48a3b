// Any bytes as what a MIP 50 answers, as what a client sends it, and as a table of its strings.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hardware/tilt/mip50_codec.h"

namespace {

using namespace tiltmap;

void require(bool held) {
  if (!held) std::abort();
}

std::vector<Mip50Answer> answersOf(const Mip50Table& table, std::string_view text, std::size_t piece) {
  Mip50AnswerReader reader(table);
  std::vector<Mip50Answer> answers;
  for (; !text.empty(); text.remove_prefix(std::min(piece, text.size()))) {
    reader.take(text.substr(0, piece), answers);
    require(reader.pending() <= Mip50AnswerReader::kLongestLine + 1);
  }
  return answers;
}

void readAnswers(const Mip50Table& table, std::string_view text, std::size_t piece) {
  const auto answers = answersOf(table, text, piece);
  require(answers == answersOf(table, text, std::max<std::size_t>(text.size(), 1)));
  for (const Mip50Answer& answer : answers) {
    if (std::holds_alternative<Mip50Noise>(answer)) continue;
    const std::string wire = encodeAnswer(table, answer);
    require(answersOf(table, wire, wire.size()) == std::vector<Mip50Answer>{answer});
  }
}

void readCommands(const Mip50Table& table, std::string_view text, std::size_t piece) {
  Mip50CommandReader reader(table);
  std::vector<Mip50CommandReader::Item> items;
  for (; !text.empty(); text.remove_prefix(std::min(piece, text.size())))
    reader.take(text.substr(0, piece), items);
  for (const auto& item : items) {
    const auto* command = std::get_if<Mip50Command>(&item);
    if (!command) continue;
    const auto again = decodeCommand(table, encodeCommand(table, *command));
    require(again.has_value() && again->verb == command->verb && again->axis == command->axis);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t piece = 1 + (data[0] >> 2) % 40;
  static const Mip50Table kTable;
  switch (data[0] & 3) {
    case 0:
      readAnswers(kTable, text, piece);
      break;
    case 1:
      readCommands(kTable, text, piece);
      break;
    default:
      if (const auto table = parseMip50Table(text, "fuzz")) {
        const auto again = parseMip50Table(mip50TableText(*table), "fuzz");
        require(again.has_value() && *again == *table);
        // Whatever the strings are, nothing may be read beyond.
        Mip50CommandReader reader(*table);
        std::vector<Mip50CommandReader::Item> items;
        reader.take("A1x5GP1xG", items);
        (void)answersOf(*table, "\r\nX0\r\nM#21 1 5\r\n", piece);
      }
  }
  return 0;
}
