// Any bytes, as a scanner's stream, as a host's, and as the inside of a telegram whose checksum is right.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "hardware/lms2xx/framer.h"
#include "hardware/lms2xx/measurement.h"
#include "hardware/lms2xx/requests.h"
#include "hardware/lms2xx/unit_state.h"

namespace {

using namespace tiltmap;
using namespace tiltmap::lms2xx;

void require(bool held) {
  if (!held) std::abort();
}

// Everything that is found, pieces of so many bytes at a time; at the end the bytes stop coming.
std::vector<Token> tokensOf(std::span<const Byte> bytes, Sender sender, std::size_t piece) {
  Framer framer(sender);
  std::vector<Token> found;
  const auto take = [&] {
    while (auto token = framer.next()) found.push_back(std::move(*token));
    require(framer.buffered() < kLongestPayload + kOverhead);
  };
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    framer.push(bytes.subspan(at, std::min(piece, bytes.size() - at)));
    take();
  }
  while (framer.giveUpFirst()) take();
  require(!framer.waiting() && framer.start().empty());
  return found;
}

void readAsEverything(const Telegram& telegram) {
  if (const auto measurement = parseMeasurement(telegram)) {
    const ByteVector again = encodeMeasurement(*measurement, static_cast<Byte>(telegram.address & 0x7F));
    const auto tokens = tokensOf(again, Sender::Scanner, again.size());
    require(tokens.size() == 1);
    const auto second = parseMeasurement(std::get<Telegram>(tokens[0]));
    require(second && *second == *measurement);
    for (const std::uint16_t raw : measurement->values)
      for (const int mode : {0, 1, 2, 3, 4, 5, 6, 15, 63}) {
        const auto measuring = static_cast<MeasuringMode>(mode);
        require(encodeValue(decodeValue(raw, measuring), measuring) == raw);
      }
  }
  if (const auto status = parseStatus(telegram)) {
    const ByteVector data = statusData(*status);
    require(data.size() == kStatusData);
  }
  if (const auto configuration = parseConfiguration(telegram)) {
    Configuration changed = *configuration;
    changed.setUnit(Unit::Millimetre);
    changed.setSendsIndices(true);
    changed.setMeasuringMode(MeasuringMode::FieldA);
    changed.setSensitivity(3);
    require(changed.unit() == Unit::Millimetre && changed.sendsIndices() && changed.sensitivity() == 3 &&
            changed.measuringMode() == MeasuringMode::FieldA &&
            changed.block().size() == configuration->block().size());
    changed.setUnit(configuration->unit());
    changed.setSendsIndices(configuration->sendsIndices());
    require(request::writeConfiguration(changed.block()).encoded().size() == changed.block().size() + 7);
  }
  (void)parseWriteAnswer(telegram);
  (void)parseVariantAnswer(telegram);
  require(parseErrors(telegram).size() <= kLongestPayload);
  const UnitType type = parseType(telegram.data());
  require(type.text.size() <= telegram.payload.size());
  for (const Byte name : telegram.payload) (void)isMeasurement(name);
  (void)type.sendsReflectivity();
  (void)warningsOf({telegram.status()});
}

// Every request that the driver may make, with any numbers, is found again at the other end.
void askEverything(unsigned a, unsigned b) {
  const int first = static_cast<int>(a & 0xFFFFU), last = static_cast<int>(b & 0xFFFFU);
  const Variant variant{first, last};
  (void)variant.legal();
  for (const Request& request : {request::reset(),
                                 request::status(),
                                 request::errors(),
                                 request::operatingHours(),
                                 request::type(),
                                 request::readConfiguration(),
                                 request::readConfiguration2(),
                                 request::installationMode(),
                                 request::testPassword(),
                                 request::setMode(static_cast<Byte>(a)),
                                 request::stream(),
                                 request::onRequest(),
                                 request::streamPartial(),
                                 request::streamMean(first),
                                 request::streamRange(first, last),
                                 request::streamReflectivity(first, last),
                                 request::setRate(kRates[a % 4]),
                                 request::scan(),
                                 request::partialScan(),
                                 request::meanScan(first),
                                 request::range(first, last),
                                 request::rangeWithFields(first, last),
                                 request::reflectivity(first, last),
                                 request::energy(first, last),
                                 request::cartesian(first, last),
                                 request::setVariant(variant),
                                 request::permanentRate(a % 2 == 0),
                                 request::activeFieldSet(),
                                 request::writeConfiguration(Configuration::factory().block())}) {
    const ByteVector bytes = request.encoded(static_cast<Byte>(b & 0x7F));
    const auto found = tokensOf(bytes, Sender::Host, bytes.size());
    require(found.size() == 1);
    const auto& telegram = std::get<Telegram>(found[0]);
    require(telegram.command() == request.command && std::ranges::equal(telegram.data(), request.data));
    require(request.answer() >= 0x80);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const Byte> bytes(data + 1, size - 1);
  const std::size_t piece = data[0] % 64 + 1U;
  for (const Sender sender : {Sender::Scanner, Sender::Host}) {
    const auto found = tokensOf(bytes, sender, piece);
    require(found == tokensOf(bytes, sender, std::max<std::size_t>(bytes.size(), 1)));
    for (const Token& token : found)
      if (const auto* telegram = std::get_if<Telegram>(&token)) readAsEverything(*telegram);
  }
  // The checksum keeps most bytes out; here they are let in.
  if (!bytes.empty() && bytes.size() <= kLongestPayload) {
    const Telegram inside{static_cast<Byte>(0x80 | data[0]), ByteVector(bytes.begin(), bytes.end())};
    const auto found = tokensOf(encode(inside), Sender::Scanner, piece);
    require(found.size() == 1 && std::get<Telegram>(found[0]) == inside);
    readAsEverything(inside);
    const Request request{bytes[0], ByteVector(bytes.begin() + 1, bytes.end())};
    require(!request.encoded(static_cast<Byte>(data[0] & 0x7F)).empty() && request.answer() >= 0x80);
    if (bytes.size() == 4) askEverything(word(bytes, 0), word(bytes, 2));
  }
  return 0;
}
