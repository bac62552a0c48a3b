#include "core/scan/scan_health.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/text.h"

namespace tiltmap {

namespace {

struct Count {
  std::size_t beams = 0, dead = 0, dazzled = 0, too_short = 0, down = 0, silent = 0;

  BeamShares shares() const {
    const auto share = [](std::size_t part, std::size_t whole) {
      return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
    };
    return {share(dead, beams), share(dazzled, beams), share(too_short, beams), share(silent, down)};
  }
};

std::string percent(double share) {
  return fixedReal(100.0 * share, 0) + " %";
}

// The neighbouring bad sectors around the worst one, as an operator sees them.
std::string where(const std::vector<SectorHealth>& sectors, std::size_t first, std::size_t last) {
  return "beams " + fixedReal(sectors[first].from_rad / kDegree, 0) + "° to " +
         fixedReal(sectors[last].to_rad / kDegree, 0) + "° (0° is right)";
}

void judgeSectors(ScanHealth& health) {
  std::size_t first = 0, length = 0;
  for (std::size_t i = 0; i < health.sectors.size(); ++i) {
    std::size_t n = 0;
    while (i + n < health.sectors.size() && health.sectors[i + n].bad) ++n;
    if (n > length) first = i, length = n;
  }
  if (length == 0) return;
  health.good = false;
  BeamShares worst;
  for (std::size_t i = first; i < first + length; ++i) {
    worst.too_short = std::max(worst.too_short, health.sectors[i].shares.too_short);
    worst.dazzled = std::max(worst.dazzled, health.sectors[i].shares.dazzled);
    worst.dead = std::max(worst.dead, health.sectors[i].shares.dead);
    worst.silent = std::max(worst.silent, health.sectors[i].shares.silent);
  }
  const std::string beams = where(health.sectors, first, first + length - 1);
  if (worst.too_short >= std::max(worst.dead, worst.silent))
    health.reason = "The window is dirty or covered: " + beams +
                    " end right before the scanner. Clean the window and scan again.";
  else if (worst.dazzled > 0.5 * worst.dead && worst.dazzled > 0.1)
    health.reason =
        "The scanner is dazzled: " + beams + " saw only light. Turn it from the sun and scan again.";
  else
    health.reason = "Nothing comes back from " + beams + ". Look at the window and scan again.";
}

}  // namespace

ScanHealth scanHealth(const RangeImage& image, const ScannerGeometry& geometry, bool whole,
                      const ScanHealthSettings& settings) {
  ScanHealth health;
  health.lines = image.scannedLines();
  const bool regular = image.isRegular();
  const double width = std::abs(geometry.azimuth_step_rad) * image.columns();
  const auto sectors =
      regular ? std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(width / settings.sector_rad)))
              : std::size_t{1};
  std::vector<Count> counts(sectors);
  Count total;
  std::size_t view = 0, hidden = 0;
  for (int row = 0; row < image.rows(); ++row) {
    bool scanned = whole;
    for (int column = 0; column < image.columns() && !scanned; ++column)
      scanned = image.code(row, column) != cell_code::kNotScanned;
    if (!scanned) continue;
    for (int column = 0; column < image.columns(); ++column) {
      const CellCode code = image.code(row, column);
      if (code == cell_code::kMasked) continue;
      Count& sector =
          counts[static_cast<std::size_t>(column) * sectors / static_cast<std::size_t>(image.columns())];
      const bool point = image.hasPoint(row, column);
      const double range = point ? static_cast<double>(image.range(row, column)) : 0.0;
      const bool dazzled = code == cell_code::kLmsDazzled;
      const bool dead = dazzled || code == cell_code::kMissing || code == cell_code::kNotScanned;
      double rise = 0.0;  // of the beam, sine
      if (regular) rise = geometry.direction(image.lineTilt(row), geometry.azimuthOfColumn(column)).z();
      const bool down = regular && rise <= -std::sin(settings.level_rad);
      for (Count* count : {&sector, &total}) {
        ++count->beams;
        count->dead += dead ? 1 : 0;
        count->dazzled += dazzled ? 1 : 0;
        count->too_short += point && range < settings.short_m ? 1 : 0;
        count->down += down ? 1 : 0;
        count->silent += down && cell_code::isFar(code) ? 1 : 0;
      }
      if (regular && std::abs(rise) < std::sin(settings.level_rad)) {
        ++view;
        hidden += point && range < settings.near_m ? 1 : 0;
      }
    }
  }
  health.shares = total.shares();
  health.hidden = view > 0 ? static_cast<double>(hidden) / static_cast<double>(view) : 0.0;
  for (std::size_t i = 0; i < sectors && regular; ++i) {
    SectorHealth sector;
    const double step = geometry.azimuth_step_rad * image.columns() / static_cast<double>(sectors);
    sector.from_rad = geometry.azimuth_start_rad + step * static_cast<double>(i);
    sector.to_rad = sector.from_rad + step;
    sector.shares = counts[i].shares();
    sector.bad = sector.shares.too_short + sector.shares.dead > settings.most_bad_beams ||
                 (counts[i].down >= 20 && sector.shares.silent > settings.most_bad_beams);
    health.sectors.push_back(sector);
  }
  judgeSectors(health);
  if (health.good && total.beams == 0) {
    health.good = false;
    health.reason = "No line was scanned. Scan again.";
  } else if (health.good && health.shares.dead > settings.most_dead) {
    health.good = false;
    health.reason = percent(health.shares.dead) + " of the beams gave no answer. Scan again.";
  } else if (health.good && health.hidden > settings.most_hidden) {
    health.good = false;
    health.reason = "Things within " + fixedReal(settings.near_m, 1) + " m hide " + percent(health.hidden) +
                    " of the view. Move to where the view is free and scan again.";
  }
  return health;
}

}  // namespace tiltmap
