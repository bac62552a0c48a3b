// Any bytes, as what a Hokuyo scanner answers, as what it is told, and as the insides of both.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "core/base/text.h"
#include "hardware/scip/scip_codec.h"

namespace {

using namespace tiltmap;
using namespace tiltmap::scip;

void require(bool held) {
  if (!held) std::abort();
}

std::vector<ReplyReader::Item> itemsOf(std::string_view text, std::size_t piece) {
  ReplyReader reader;
  std::vector<ReplyReader::Item> items;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    reader.push(text.substr(at, piece), items);
    require(reader.begun().size() <= reader.bytesHere());
  }
  return items;
}

void insides(const std::vector<std::string>& lines, const ScanOrder& order) {
  if (const auto data = parseScan(lines, order)) {
    const auto again = parseScan(encodeScan(*data, order.characters()), order);
    require(again && *again == *data);
  }
  if (const auto properties = parseProperties(lines)) {
    const auto again = parseProperties(encodeProperties(*properties));
    require(again && *again == *properties);
    if (const auto parameters = parseParameters(*properties)) {
      const auto same = parseParameters(parameterProperties(*parameters));
      require(same && *same == *parameters);
      require(parameters->azimuthStep() > 0.0 && parameters->azimuthStart() > -1e6);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto items = itemsOf(text, data[0] % 16 + 1U);
  require(items == itemsOf(text, text.size()));
  for (const auto& item : items)
    if (const auto* reply = std::get_if<Reply>(&item)) {
      const auto again = itemsOf(encodeReply(*reply), 5);
      require(again.size() == 1 && again.front() == item);
      require(!statusText(reply->status).empty());
      insides(reply->lines, parseOrder(reply->echo).value_or(ScanOrder{"MD", 0, 2, 1, 0, 0}));
    }
  std::vector<std::string> lines;
  for (const std::string_view line : splitAt(text, '\n')) lines.emplace_back(line);
  for (const char* letters : {"MD", "MS", "ME"})
    insides(lines, {letters, 0, static_cast<int>(data[0] % 70), 1, 0, 0});
  if (const auto order = parseOrder(lines.front())) {
    const auto again = parseOrder(encodeOrder(*order));
    require(again == order && order->values() > 0);
  }
  if (const auto value = decodeNumber(lines.front()))
    require(encodeNumber(*value, static_cast<int>(lines.front().size())) == lines.front());
  return 0;
}
