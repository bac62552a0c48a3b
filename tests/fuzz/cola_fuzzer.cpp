// Any bytes, as a stream of CoLa telegrams and as the text of one.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "core/base/text.h"
#include "hardware/cola/cola_codec.h"

namespace {

using namespace tiltmap;
using namespace tiltmap::cola;

void require(bool held) {
  if (!held) std::abort();
}

std::vector<Reader::Item> itemsOf(std::span<const Byte> bytes, std::size_t piece) {
  Reader reader;
  std::vector<Reader::Item> items;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.push(bytes.subspan(at, std::min(piece, bytes.size() - at)), items);
    require(reader.begun().size() <= Reader::kLongest);
  }
  reader.clear();
  return items;
}

void meaning(std::string_view text) {
  if (const auto scan = parseScan(text)) {
    const auto again = parseScan(scanText(*scan));
    require(again && *again == *scan);
    (void)scan->channel("DIST1");
  }
  if (const auto setting = requestedSetting(text)) (void)parseSetting(splitAt(settingWords(*setting), ' '));
  for (const std::string_view word : splitAt(text, ' ')) {
    if (const auto value = number(word)) {
      require(number(hexNumber(*value)) == value);
      require(!errorText(*value).empty());
    }
    if (const auto value = signedNumber(word)) require(signedNumber(decimal(*value)) == value);
    if (const auto value = realNumber(word)) require(realNumber(hexReal(*value)) == value);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::span<const Byte> bytes(data + 1, size - 1);
  const auto items = itemsOf(bytes, data[0] % 16 + 1U);
  require(items == itemsOf(bytes, bytes.size()));
  for (const auto& item : items)
    if (const auto* telegram = std::get_if<Telegram>(&item)) {
      meaning(telegram->text);
      // Whatever came as a telegram is one again; a text that begins with marks would look like dialect B.
      const auto again = itemsOf(encode(*telegram), 3);
      if (!telegram->text.empty()) require(again.size() == 1 && again.front() == item);
    }
  meaning({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return 0;
}
