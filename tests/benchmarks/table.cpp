#include "tests/benchmarks/table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

namespace tiltmap::benchmarks {

namespace {

using Cells = std::array<std::string, 12>;

constexpr std::array<const char*, 12> kColumns = {"program",   "time ms", "CPU ms",  "x ours",
                                                  "median mm", "deg",     "x floor", "95 % mm",
                                                  "worst mm",  "deg",     "within",  "remark"};

std::string number(const std::optional<double>& value, const char* format) {
  if (!value) return "";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), format, *value);
  return text.data();
}

// Three digits that mean something, without exponents.
std::string digits(const std::optional<double>& value) {
  if (!value) return "";
  return number(value, *value < 1.0 ? "%.3f" : *value < 10.0 ? "%.2f" : *value < 100.0 ? "%.1f" : "%.0f");
}

Cells cellsOf(const Row& row) {
  return {row.program,
          digits(row.wall_ms),
          digits(row.cpu_ms),
          digits(row.times_ours),
          digits(row.median_mm),
          number(row.median_deg, "%.4f"),
          digits(row.times_floor),
          digits(row.most_mm),
          digits(row.worst_mm),
          number(row.worst_deg, "%.3f"),
          row.within,
          row.remark};
}

void printCells(std::ostream& out, const Cells& cells, const std::array<std::size_t, 12>& widths) {
  std::string line;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string padding(widths[c] - cells[c].size(), ' ');
    const bool text = c == 0 || c + 1 == cells.size();
    line += (c > 0 ? "  " : "") + (text ? cells[c] + padding : padding + cells[c]);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  out << line << '\n';
}

}  // namespace

void Table::setRatios(const std::string& subject, const std::string& ours) {
  const auto own = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.subject == subject && row.program == ours;
  });
  if (own == rows.end() || !own->cpu_ms || *own->cpu_ms <= 0.0) return;
  const double own_ms = *own->cpu_ms;
  for (Row& row : rows)
    if (row.subject == subject && row.cpu_ms) row.times_ours = *row.cpu_ms / own_ms;
}

void Table::print(std::ostream& out) const {
  for (const std::string& line : heading) out << line << '\n';
  std::array<std::size_t, 12> widths{};
  Cells names;
  for (std::size_t c = 0; c < names.size(); ++c) {
    names[c] = kColumns[c];
    widths[c] = names[c].size();
  }
  for (const Row& row : rows) {
    const Cells cells = cellsOf(row);
    for (std::size_t c = 0; c < cells.size(); ++c) widths[c] = std::max(widths[c], cells[c].size());
  }
  out << '\n';
  printCells(out, names, widths);
  std::string subject;
  for (const Row& row : rows) {
    if (row.subject != subject) out << "-- " << row.subject << '\n';
    subject = row.subject;
    printCells(out, cellsOf(row), widths);
  }
  if (!notes.empty()) out << '\n';
  for (const std::string& note : notes) out << note << '\n';
}

nlohmann::json Table::json() const {
  nlohmann::json list = nlohmann::json::array();
  for (const Row& row : rows) {
    nlohmann::json entry = {{"subject", row.subject}, {"program", row.program}};
    const auto add = [&entry](const char* key, const std::optional<double>& value) {
      if (value) entry[key] = *value;
    };
    add("wall_ms", row.wall_ms);
    add("cpu_ms", row.cpu_ms);
    add("times_ours", row.times_ours);
    add("median_mm", row.median_mm);
    add("median_deg", row.median_deg);
    add("times_floor", row.times_floor);
    add("most_mm", row.most_mm);
    add("worst_mm", row.worst_mm);
    add("worst_deg", row.worst_deg);
    if (!row.within.empty()) entry["within"] = row.within;
    if (!row.remark.empty()) entry["remark"] = row.remark;
    list.push_back(std::move(entry));
  }
  return {{"heading", heading}, {"rows", std::move(list)}, {"notes", notes}};
}

}  // namespace tiltmap::benchmarks
