// The scans of an emulated LMS 2xx: when one is measured, what is in it, and how it is told.
#include <algorithm>
#include <cmath>

#include "hardware/emulator/lms_emulator.h"

namespace tiltmap {

using namespace lms2xx;

namespace {

std::uint16_t rawOf(const Echo& echo, Unit unit, MeasuringMode mode) {
  Value value;
  if (!cell_code::hasPoint(echo.code)) {
    value.code = echo.code;
    return encodeValue(value, mode);
  }
  const long counts = std::lround(static_cast<double>(echo.range_m) / metresPerCount(unit));
  const long furthest = (1L << std::min(distanceBits(mode), 15)) - 10L;
  if (counts > furthest)
    value.code = cell_code::kLmsFirst;  // above the greatest value of this unit
  else
    value.distance = static_cast<std::uint16_t>(counts);
  return encodeValue(value, mode);
}

}  // namespace

Instant LmsEmulator::scanEnd(Instant at, int turns) const {
  const Duration length = turns * durationOf(settings_.turn_s);
  const auto done = (at - mirror_start_) / length;
  return mirror_start_ + (done + 1) * length;
}

void LmsEmulator::queueScan(Instant not_before, const Measurement& shape, int turns) {
  // Scans follow one another; the first that is complete once the line is free is sent at once.
  const Instant start = scanEnd(not_before - Duration(1), turns);
  Outgoing outgoing;
  outgoing.start = start;
  outgoing.make = [this, shape, turns](Instant end) { return measure(shape, turns, end); };
  out_.push_back(std::move(outgoing));
}

Measurement LmsEmulator::shapeOf(Byte mode) const {
  Measurement shape;
  switch (mode) {
    case mode::kStreamPartial:
      shape.partial = 0;
      break;  // which one is known at its end
    case mode::kStreamMean:
      shape.command = 0xB6;
      shape.mean_of = mode_data_[0];
      break;
    case mode::kStreamRange:
    case mode::kStreamReflectivity:
      shape.command = mode == mode::kStreamRange ? 0xB7 : 0xC4;
      shape.first = word(mode_data_, 0) & 0x7FFF;
      shape.last = word(mode_data_, 2);
      break;
    default:
      break;
  }
  return shape;
}

void LmsEmulator::queueStream(Instant now) {
  if (!streaming() || !out_.empty()) return;
  const int turns = mode_ == mode::kStreamPartial ? 1
                    : mode_ == mode::kStreamMean  ? variant_.turns() * mode_data_[0]
                                                  : variant_.turns();
  queueScan(now, shapeOf(mode_), turns);
}

ByteVector LmsEmulator::measure(Measurement shape, int turns, Instant end) {
  const Duration turn = durationOf(settings_.turn_s);
  const auto turn_number = (end - mirror_start_) / turn;
  ScannerGeometry geometry;
  geometry.rows = 1;
  Variant variant = variant_;
  int scans = std::max(1, shape.mean_of.value_or(1));
  double start_deg = variant.startDegrees();
  if (shape.partial) {
    shape.partial = static_cast<int>((turn_number - 1) % 4);
    variant = {180, 100};
    start_deg = 0.25 * *shape.partial;
    geometry.columns = *shape.partial == 0 ? 181 : 180;
  } else {
    geometry.columns = variant.values();
  }
  geometry.azimuth_start_rad = start_deg * kDegree;
  geometry.azimuth_step_rad = variant.resolution_cdeg * 0.01 * kDegree;

  SentScan sent;
  sent.measured_to = end;
  sent.measured_from = end - turns * turn;
  sent.first_byte = end;
  const TiltFunction tilt = [this, from = sent.measured_from](double seconds) {
    return tilt_ ? tilt_(from + durationOf(seconds)) : 0.0;
  };
  const Unit unit = settings_.configuration.unit();
  const MeasuringMode measuring = settings_.configuration.measuringMode();
  std::vector<double> sums;
  for (int k = 0; k < scans; ++k) {
    const double begin = k * secondsOf(turn) * variant.turns();
    sent.echoes = view_.line(geometry, tilt, begin, ++scans_);
    if (faults_.dazzled)
      for (Echo& echo : sent.echoes) echo = {0.0F, cell_code::kLmsDazzled, 0.0F};
    if (scans == 1) break;
    sums.resize(sent.echoes.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i)
      sums[i] += static_cast<double>(sent.echoes[i].range_m) / scans;
  }
  const std::size_t first = shape.first ? static_cast<std::size_t>(*shape.first - 1) : 0;
  const std::size_t last = shape.last ? static_cast<std::size_t>(*shape.last) : sent.echoes.size();
  for (std::size_t i = first; i < last; ++i) {
    Echo echo = sent.echoes[i];
    if (!sums.empty() && cell_code::hasPoint(echo.code)) echo.range_m = static_cast<float>(sums[i]);
    shape.values.push_back(rawOf(echo, unit, measuring));
    if (shape.command == 0xC4) shape.reflectivity.push_back(static_cast<Byte>(echo.intensity));
  }
  shape.unit = unit;
  shape.status = statusByte();
  if (shape.command == 0xC4) {
    shape.reflectivity_first = *shape.first;
    shape.first.reset();
  }
  if (settings_.configuration.sendsIndices())
    shape.indices = Indices{static_cast<Byte>(turn_number & 255), telegram_index_};
  ++telegram_index_;
  sent.measurement = shape;
  if (on_scan_) on_scan_(sent);
  ByteVector bytes = encodeMeasurement(shape, settings_.address);
  if (faults_.cut_telegrams > 0) {
    --faults_.cut_telegrams;
    bytes.resize(std::min<std::size_t>(bytes.size(), 100));
  }
  return bytes;
}

}  // namespace tiltmap
