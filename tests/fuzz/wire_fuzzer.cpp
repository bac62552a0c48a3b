// Any bytes, read as a recorded session; what is read is written and read again.
#include <cstdint>
#include <cstdlib>

#include "hardware/transport/session_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tiltmap;
  const auto require = [](bool held) {
    if (!held) std::abort();
  };
  const auto session = parseSession({reinterpret_cast<const char*>(data), size}, "file");
  if (!session) return 0;
  std::string text = "# tiltmap wire session 1\n# x\n# begun 0\n";
  for (const WireRecord& record : session->records) text += recordText(record);
  const auto again = parseSession(text, "file");
  require(again && again->records.size() == session->records.size());
  for (std::size_t i = 0; i < again->records.size(); ++i) {
    const WireRecord &a = session->records[i], &b = again->records[i];
    require(a.kind == b.kind && a.bytes == b.bytes && a.line == b.line);
  }
  return 0;
}
