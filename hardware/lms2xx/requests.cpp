#include "hardware/lms2xx/requests.h"

#include <algorithm>
#include <stdexcept>

namespace tiltmap::lms2xx {

namespace {

Request withWords(Byte command, ByteVector before, std::initializer_list<int> words) {
  Request request{command, std::move(before)};
  for (const int value : words) addWord(request.data, static_cast<unsigned>(value));
  return request;
}

Request withPassword(Byte mode, std::string_view password) {
  Request request{command::kMode, ByteVector(password.size() + 1)};
  request.data.front() = mode;
  std::ranges::copy(password, request.data.begin() + 1);
  return request;
}

}  // namespace

Byte Request::answer() const {
  return command == command::kReset ? command::kResetAccepted : static_cast<Byte>(command | kAnswerBit);
}

bool Variant::legal() const {
  if (angle_deg == 180) return resolution_cdeg == 100 || resolution_cdeg == 50;
  return angle_deg == 100 && (resolution_cdeg == 100 || resolution_cdeg == 50 || resolution_cdeg == 25);
}

namespace request {

Request reset() {
  return {command::kReset, {}};
}
Request status() {
  return {command::kStatus, {}};
}
Request errors() {
  return {command::kErrors, {}};
}
Request operatingHours() {
  return {command::kHours, {}};
}
Request type() {
  return {command::kType, {}};
}
Request readConfiguration() {
  return {command::kReadConfiguration, {}};
}
Request readConfiguration2() {
  return {command::kReadConfiguration2, {}};
}
Request installationMode(std::string_view password) {
  return withPassword(mode::kInstallation, password);
}
Request testPassword(std::string_view password) {
  return withPassword(mode::kTestPassword, password);
}
Request setMode(Byte mode) {
  return {command::kMode, {mode}};
}
Request stream() {
  return setMode(mode::kStream);
}
Request onRequest() {
  return setMode(mode::kOnRequest);
}
Request streamPartial() {
  return setMode(mode::kStreamPartial);
}
Request streamMean(int count) {
  return {command::kMode, {mode::kStreamMean, static_cast<Byte>(count)}};
}
Request streamRange(int first, int last) {
  return withWords(command::kMode, {mode::kStreamRange}, {first, last});
}
Request streamReflectivity(int first, int last) {
  return withWords(command::kMode, {mode::kStreamReflectivity}, {first, last});
}

Request setRate(int baud) {
  switch (baud) {
    case 9600:
      return setMode(mode::kRate9600);
    case 19200:
      return setMode(mode::kRate19200);
    case 38400:
      return setMode(mode::kRate38400);
    case 500000:
      return setMode(mode::kRate500000);
    default:
      throw std::invalid_argument("lms2xx::request::setRate: no such rate");
  }
}

Request scan() {
  return {command::kMeasure, {0x01}};
}
Request partialScan() {
  return {command::kMeasure, {0x08}};
}
Request meanScan(int count) {
  return {command::kMean, {static_cast<Byte>(count)}};
}
Request range(int first, int last) {
  return withWords(command::kRange, {}, {first, last});
}
Request rangeWithFields(int first, int last) {
  return withWords(command::kFields, {}, {first, last});
}
Request reflectivity(int first, int last) {
  return withWords(command::kReflectivity, {}, {first, last});
}
Request energy(int first, int last) {
  return withWords(command::kEnergy, {}, {1, first, last});
}
Request cartesian(int first, int last) {
  return withWords(command::kCartesian, {}, {first, last});
}
Request setVariant(const Variant& variant) {
  return withWords(command::kVariant, {}, {variant.angle_deg, variant.resolution_cdeg});
}
Request permanentRate(bool keep_current) {
  return {command::kPermanentRate, {static_cast<Byte>(keep_current ? 1 : 0)}};
}
Request activeFieldSet() {
  return {command::kFieldSet, {0x00}};
}
Request writeConfiguration(std::span<const Byte> block) {
  return {command::kWriteConfiguration, ByteVector(block.begin(), block.end())};
}

}  // namespace request

}  // namespace tiltmap::lms2xx
