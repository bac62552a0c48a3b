// The one table that everything measured ends in.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tiltmap::benchmarks {

// One program doing one thing. What was not measured stays empty.
struct Row {
  std::string subject;  // what was done, to which data; rows of one subject stand together
  std::string program;  // who did it
  std::optional<double> wall_ms{};
  std::optional<double> cpu_ms{};      // of all threads together
  std::optional<double> times_ours{};  // its CPU time over that of our row of the subject; above 1: slower
  std::optional<double> median_mm{}, median_deg{};
  std::optional<double> times_floor{};  // median over the pairs of the error over that pair's noise floor
  std::optional<double> most_mm{};      // 95 % are below
  std::optional<double> worst_mm{}, worst_deg{};
  std::string within{};  // "12/13"
  std::string remark{};
};

struct Table {
  std::vector<std::string> heading;  // machine, compiler, date, commit, how it was measured: a line each
  std::vector<Row> rows;
  std::vector<std::string> notes;  // what was skipped, and why

  // Sets times_ours of all rows of a subject from the row whose program is `ours`. By CPU time: with one
  // thread it is the wall time of a quiet machine, and what else runs there disturbs it least.
  void setRatios(const std::string& subject, const std::string& ours);
  void print(std::ostream& out) const;
  nlohmann::json json() const;
};

}  // namespace tiltmap::benchmarks
