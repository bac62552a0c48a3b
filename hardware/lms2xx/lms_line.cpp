#include "hardware/lms2xx/lms_line.h"

#include <algorithm>

namespace tiltmap {

using namespace lms2xx;

Status fillCells(LmsLine& line) {
  const double metres = metresPerCount(line.raw.unit);
  if (metres <= 0.0)
    return fail("the scanner measures in a unit that is not known", "header of the scan",
                "set it to centimetres or millimetres");
  if (line.measuring_mode == MeasuringMode::Energy)
    return fail("the scanner sends energies instead of distances", "measuring mode 3F",
                "set it to a mode with distances");
  line.range_m.clear();
  line.code.clear();
  line.intensity.clear();
  for (const std::uint16_t raw : line.raw.values) {
    const Value value = decodeValue(raw, line.measuring_mode);
    // A distance of nothing is none: the beam met the window, or the value was never filled in.
    const bool there = value.measured() && value.distance > 0;
    line.range_m.push_back(there ? static_cast<float>(value.distance * metres) : 0.0F);
    line.code.push_back(there ? cell_code::kMeasured : value.measured() ? cell_code::kMissing : value.code);
  }
  if (line.raw.reflectivity.empty()) return {};
  line.intensity.assign(line.range_m.size(), 0.0F);
  const auto first = static_cast<std::size_t>(std::max(line.raw.reflectivity_first - 1, 0));
  for (std::size_t i = 0; i < line.raw.reflectivity.size() && first + i < line.intensity.size(); ++i)
    line.intensity[first + i] = line.raw.reflectivity[i];
  return {};
}

ScannerGeometry geometryOf(const Variant& variant, ScannerGeometry rest) {
  rest.columns = variant.values();
  rest.azimuth_start_rad = variant.startDegrees() * kDegree;
  rest.azimuth_step_rad = variant.resolution_cdeg * 0.01 * kDegree;
  return rest;
}

Result<LmsLine> interleaved(std::span<const LmsLine> partials) {
  const std::size_t count = partials.size();
  const auto wrong = [](const std::string& what) {
    return fail(what, "interlaced scans", "take them again");
  };
  if (count != 2 && count != 4) return wrong("a line takes two or four partial scans");
  std::vector<const LmsLine*> at(count, nullptr);
  for (const LmsLine& partial : partials) {
    const int shift = partial.raw.partial.value_or(-1);
    const int place = count == 4 ? shift : shift == 0 ? 0 : shift == 2 ? 1 : -1;
    if (place < 0 || at[static_cast<std::size_t>(place)])
      return wrong("a partial scan is missing or there twice");
    if (partial.range_m.size() != (shift == 0 ? 181U : 180U)) return wrong("a partial scan is not whole");
    at[static_cast<std::size_t>(place)] = &partial;
  }
  LmsLine line = *at[0];
  line.raw = {};
  line.raw.unit = at[0]->raw.unit;
  line.variant = {180, static_cast<int>(100 / count)};
  line.range_m.clear();
  line.code.clear();
  line.lost_before = 0;
  for (std::size_t i = 0; i < 180 * count + 1; ++i) {
    const LmsLine& from = *at[i % count];
    line.raw.values.push_back(from.raw.values[i / count]);
    line.range_m.push_back(from.range_m[i / count]);
    line.code.push_back(from.code[i / count]);
  }
  for (const LmsLine* from : at) {
    line.earliest_start = std::min(line.earliest_start, from->earliest_start);
    line.first_byte = std::max(line.first_byte, from->first_byte);
    if (from->last_byte >= line.last_byte) {
      line.last_byte = from->last_byte;
      line.unix_time_s = from->unix_time_s;
    }
    line.status.raw = static_cast<Byte>(line.status.raw | from->status.raw);
    line.lost_before += from->lost_before;
  }
  return line;
}

}  // namespace tiltmap
