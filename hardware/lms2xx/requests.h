// Everything that the driver asks of an LMS 2xx.
#pragma once

#include <string_view>

#include "hardware/lms2xx/telegram.h"

namespace tiltmap::lms2xx {

struct Request {
  Byte command = 0;
  ByteVector data;

  ByteVector encoded(Byte address = 0) const { return encodeRequest(command, data, address); }
  // The answer is expected under this command.
  Byte answer() const;
  bool operator==(const Request&) const = default;
};

// Sub-commands of 20: operating modes and rates.
namespace mode {
inline constexpr Byte kInstallation = 0x00;
inline constexpr Byte kDiagnostic = 0x10;
inline constexpr Byte kStream = 0x24;
inline constexpr Byte kOnRequest = 0x25;
inline constexpr Byte kStreamMean = 0x26;
inline constexpr Byte kStreamRange = 0x27;
inline constexpr Byte kStreamMeanRange = 0x28;
inline constexpr Byte kStreamFields = 0x29;
inline constexpr Byte kStreamPartial = 0x2A;
inline constexpr Byte kStreamEnergy = 0x2B;
inline constexpr Byte kTestPassword = 0x30;
inline constexpr Byte kRate38400 = 0x40;
inline constexpr Byte kRate19200 = 0x41;
inline constexpr Byte kRate9600 = 0x42;
inline constexpr Byte kRate500000 = 0x48;
inline constexpr Byte kStreamReflectivity = 0x50;
}  // namespace mode

inline constexpr std::string_view kFactoryPassword = "SICK_LMS";
inline constexpr std::array<int, 4> kRates{9600, 19200, 38400, 500000};

// Field of view in degrees and spacing in hundredths of one.
struct Variant {
  int angle_deg = 180;
  int resolution_cdeg = 50;

  int values() const { return angle_deg * 100 / resolution_cdeg + 1; }
  // Turns of the mirror that one scan takes: a turn measures whole degrees only.
  int turns() const { return 100 / resolution_cdeg; }
  // Degrees of the first value on the scale of the 180 degree scan (0 right, 180 left).
  double startDegrees() const { return 90.0 - angle_deg / 2.0; }
  // One of the pairs that the telegram listing allows.
  bool legal() const;
  bool operator==(const Variant&) const = default;
};

namespace request {
Request reset();
Request status();
Request errors();
Request operatingHours();
Request type();
Request readConfiguration();
Request readConfiguration2();
Request installationMode(std::string_view password = kFactoryPassword);
Request testPassword(std::string_view password = kFactoryPassword);
Request setMode(Byte mode);
Request stream();
Request onRequest();
Request streamPartial();
Request streamMean(int count);
Request streamRange(int first, int last);
Request streamReflectivity(int first, int last);
// Throws std::invalid_argument for a rate that there is not.
Request setRate(int baud);
Request scan();
Request partialScan();
Request meanScan(int count);
Request range(int first, int last);
Request rangeWithFields(int first, int last);
Request reflectivity(int first, int last);
Request energy(int first, int last);
Request cartesian(int first, int last);
Request setVariant(const Variant& variant);
Request permanentRate(bool keep_current);
Request activeFieldSet();
Request writeConfiguration(std::span<const Byte> block);
}  // namespace request

}  // namespace tiltmap::lms2xx
