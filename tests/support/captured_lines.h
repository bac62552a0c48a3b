// Comparing what a capture stored with what the emulated site truly gave at the tilt that was read back.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/project/project.h"
#include "hardware/capture/scanner_unit.h"
#include "hardware/emulator/rig.h"

namespace tiltmap::test {

// Empty where the line is what the site gives at its tilt, beam by beam; else what differs.
inline std::string differsFromSite(const RigView& view, const ScannerGeometry& geometry, double tilt_rad,
                                   const float* range_m, const CellCode* code) {
  const std::vector<Echo> truth = view.truth(geometry, tilt_rad);
  for (std::size_t j = 0; j < truth.size(); ++j)
    if (truth[j].code != code[j] || std::abs(truth[j].range_m - range_m[j]) > 1e-5F)
      return "beam " + std::to_string(j) + " has " + std::to_string(range_m[j]) + " m, code " +
             std::to_string(code[j]) + " instead of " + std::to_string(truth[j].range_m) + " m, code " +
             std::to_string(truth[j].code);
  return {};
}

// A captured stop of exp1, seed 7, has so many lines, and each is what the site gives at its tilt.
inline void expectTrueScan(const ProjectSnapshot& snapshot, std::size_t index, int lines) {
  const ScanEntry& entry = snapshot.scans().at(index);
  EXPECT_EQ(entry.lines, lines);
  const auto image = entry.image();
  ASSERT_TRUE(image);
  RigView view(*Experiment::make(ExperimentId::Exp1, 7), {});
  view.moveTo(static_cast<int>(index));
  for (int row = 0; row < entry.rows; ++row) {
    if ((*image)->code(row, 0) == cell_code::kNotScanned) continue;
    const std::size_t first = (*image)->index(row, 0);
    EXPECT_EQ(differsFromSite(view, entry.geometry, (*image)->lineTilt(row),
                              (*image)->data().range_m.data() + first, (*image)->data().code.data() + first),
              "")
        << "stop " << index << " row " << row;
  }
}

// The next whole line of a scanner that sends, on a clock that costs nothing.
inline Result<LineTaken> nextLine(VirtualClock& clock, ScannerUnit& scanner, double limit_s = 3.0) {
  const Instant end = clock.now() + durationOf(limit_s);
  while (clock.now() < end) {
    auto event = scanner.poll();
    if (!event) return fail(event.error());
    if (*event)
      if (auto* taken = std::get_if<LineTaken>(&**event)) return std::move(*taken);
    clock.sleepFor(durationOf(0.0005));
  }
  return fail("nothing came", "test", "");
}

// How far the tilt of a row may be from where it was sent.
inline constexpr double kTiltToleranceRad = 0.0004;

}  // namespace tiltmap::test
