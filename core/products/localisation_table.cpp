#include "core/products/localisation_table.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"

namespace tiltmap {

namespace {

constexpr std::array<const char*, 7> kTextHeader = {"stop",      "x [m]",     "y [m]",    "z [m]",
                                                    "heading x", "heading y", "heading z"};

std::array<std::string, 7> cellsOf(const LocalisationRow& row, int position_places, int heading_places) {
  return {std::to_string(row.stop),
          fixedReal(row.position_m.x(), position_places),
          fixedReal(row.position_m.y(), position_places),
          fixedReal(row.position_m.z(), position_places),
          fixedReal(row.heading.x(), heading_places),
          fixedReal(row.heading.y(), heading_places),
          fixedReal(row.heading.z(), heading_places)};
}

}  // namespace

std::string localisationCaption(const std::string& stage) {
  if (stage == "odometry") return "Stops as the odometry measured them";
  if (stage == "pairwise") return "Stops after pairwise registration";
  if (stage == "relaxed") return "Stops after global relaxation";
  if (stage == "truth") return "Stops as they truly are";
  return "Stops at stage " + stage;
}

LocalisationTable localisationTable(const std::string& stage, const std::vector<Pose>& world_from_scan) {
  LocalisationTable table{stage, localisationCaption(stage), {}};
  table.rows.reserve(world_from_scan.size());
  for (const Pose& pose : world_from_scan)
    table.rows.push_back({table.rows.size(), pose.translation(), pose.heading()});
  return table;
}

std::string textOf(const LocalisationTable& table) {
  std::vector<std::array<std::string, 7>> lines;
  lines.emplace_back();
  std::copy(kTextHeader.begin(), kTextHeader.end(), lines.front().begin());
  for (const LocalisationRow& row : table.rows) lines.push_back(cellsOf(row, 3, 4));

  std::array<std::size_t, 7> width{};
  for (const auto& line : lines)
    for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
  std::string text = table.caption + "\n";
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      if (c > 0) text += "  ";
      text += std::string(width[c] - line[c].size(), ' ') + line[c];
    }
    text += "\n";
  }
  return text;
}

std::string csvOf(const LocalisationTable& table) {
  std::string text = "stop,x_m,y_m,z_m,heading_x,heading_y,heading_z\n";
  for (const LocalisationRow& row : table.rows) {
    const auto cells = cellsOf(row, 6, 6);
    text += joined({cells.begin(), cells.end()}, ",") + "\n";
  }
  return text;
}

}  // namespace tiltmap
