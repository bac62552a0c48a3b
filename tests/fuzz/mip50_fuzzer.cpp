// Any bytes, as what a MIP 50 sends, as what it is sent, and as a table of its strings.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "hardware/tilt/mip50_codec.h"

namespace {

using namespace tiltmap;

void require(bool held) {
  if (!held) std::abort();
}

template <class Reader, class Item>
std::vector<Item> itemsOf(const Mip50Table& table, std::string_view text, std::size_t piece) {
  Reader reader(table);
  std::vector<Item> items;
  for (std::size_t at = 0; at < text.size(); at += piece) reader.take(text.substr(at, piece), items);
  reader.clear();
  return items;
}

void readTable(std::string_view text) {
  const auto table = parseMip50Table(text, "table");
  if (!table) return;
  const auto again = parseMip50Table(mip50TableText(*table), "table");
  require(again && *again == *table);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Mip50Table table;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t piece = data[0] % 32 + 1U, whole = std::max<std::size_t>(text.size(), 1);

  const auto answers = itemsOf<Mip50AnswerReader, Mip50Answer>(table, text, piece);
  require(answers == itemsOf<Mip50AnswerReader, Mip50Answer>(table, text, whole));
  for (const Mip50Answer& answer : answers) {
    const std::string sent = encodeAnswer(table, answer);
    // What a controller can say is understood as before; its columns are not made for greater numbers.
    if (std::holds_alternative<Mip50Noise>(answer)) continue;
    if (const auto* value = std::get_if<Mip50Value>(&answer)) {
      const auto fits = [](std::int64_t number) { return number > -1000 && number < 1000; };
      if (value->number < 1 || value->number > 99 || !std::ranges::all_of(value->values, fits)) continue;
    }
    const auto heard = itemsOf<Mip50AnswerReader, Mip50Answer>(table, sent + "\r\n", piece);
    require(!heard.empty() && heard.front() == answer);
  }

  using Item = Mip50CommandReader::Item;
  const auto commands = itemsOf<Mip50CommandReader, Item>(table, text, piece);
  require(commands == itemsOf<Mip50CommandReader, Item>(table, text, whole));
  for (const Item& item : commands)
    if (const auto* command = std::get_if<Mip50Command>(&item)) {
      const auto second = decodeCommand(table, encodeCommand(table, *command));
      require(second && second->verb == command->verb && second->axis == command->axis);
    }
  readTable(text);
  return 0;
}
