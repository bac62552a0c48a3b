#include "tests/benchmarks/window_run.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <nlohmann/json.hpp>

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// What the program printed as one JSON object; null where there was none.
Json told(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return {};
  std::string output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  if (::pclose(pipe) != 0) return {};
  const Json json = Json::parse(output, nullptr, false);
  return json.is_object() ? json : Json();
}

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// Stops captured in the window, each with its verdict, and a silent instrument. False where a verdict came
// later than 0.5 s, or an event waited for 50 ms.
bool addVerdictRow(Table& table, const std::string& command) {
  constexpr double kLimitMs = 500.0, kLatencyLimitMs = 50.0;
  const Json json = told(command);
  if (json.is_null() || json.contains("trouble") || json.at("milliseconds").empty()) {
    table.notes.push_back("Skipped: no stop was captured in the window. " +
                          (json.is_null() ? std::string() : json.value("trouble", std::string())));
    return json.is_null();
  }
  const auto times = json.at("milliseconds").get<std::vector<double>>();
  const auto lights = json.at("lights").get<std::vector<std::string>>();
  Row row{.subject = "stops captured in the window, emulated at four times their speed",
          .program = "last line to verdict, slowest"};
  row.wall_ms = *std::ranges::max_element(times);
  for (std::size_t i = 0; i < times.size(); ++i)
    row.remark += formatted("%s%.0f ms %s", i == 0 ? "" : "; ", times[i], lights[i].c_str());
  table.rows.push_back(row);
  const Json silent = json.value("silent", Json::object());
  if (!silent.contains("worst_ms")) return *row.wall_ms <= kLimitMs;
  Row late{.subject = "the window while an instrument is silent", .program = "longest wait of an event"};
  late.wall_ms = silent.at("worst_ms").get<double>();
  late.cpu_ms = silent.at("most_work_ms").get<double>();
  late.remark = formatted("median %.1f ms of %d looks; %s", silent.at("median_ms").get<double>(),
                          silent.at("looks").get<int>(),
                          silent.at("noticed").get<bool>() ? "looked for meanwhile" : "never missed");
  table.rows.push_back(late);
  return *row.wall_ms <= kLimitMs && *late.wall_ms < kLatencyLimitMs;
}

}  // namespace

bool addWindowRows(Table& table, const fs::path& benchmark, const fs::path& program, const fs::path& scratch,
                   const std::function<void(const std::string&)>& tell) {
  fs::remove_all(scratch);
  fs::create_directories(scratch);
  const std::string display = "LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s '-screen 0 1920x1200x24' ";
  const std::string quiet = " 2>/dev/null";
  bool kept = true;
  const std::string frames = "3D view of 1170 x 553, software OpenGL, 10 million points";
  for (const std::string how : {"scan", "height", "scan shaded"}) {
    tell("frames of 10 million points " + how);
    const Json json = told(display + quoted(benchmark) + " frames " + quoted(scratch / "frames") +
                           " 10000000 " + how + quiet);
    if (json.is_null()) {
      table.notes.push_back("Skipped: the window's benchmark did not run; it needs xvfb-run.");
      return kept;
    }
    const double rate = json.at("frames_per_s").get<double>();
    const long long points = json.at("moving_points").get<long long>();
    const long long all = json.at("points").get<long long>();
    // A rate of a view that is still empty would be none.
    kept = kept && rate >= 20.0 && points >= 50000 && all >= 10000000;
    Row moving{.subject = frames, .program = "turning, by " + how};
    moving.wall_ms = 1e3 / rate;
    moving.cpu_ms = json.at("cpu_ms_per_frame").get<double>();
    moving.remark =
        formatted("%.1f frames/s, slowest twentieth %.0f ms, %lld points in %d tiles of 24 px", rate,
                  json.at("slowest_twentieth_ms").get<double>(), points, json.at("moving_tiles").get<int>());
    table.rows.push_back(moving);
    Row refined{.subject = frames, .program = "all points after the last move"};
    refined.wall_ms = json.at("refined_ms").get<double>();
    refined.remark = formatted(
        "the 200 ms of rest included; longest piece between two events %.0f ms; %lld "
        "points of %lld scans; %.0f MB",
        json.at("longest_piece_ms").get<double>(), all, json.at("scans").get<long long>(),
        json.at("memory_mb").get<double>());
    table.rows.push_back(refined);
  }

  tell("start of the window");
  const fs::path project = scratch / "demo.tiltmap";
  const std::string made = quoted(program) + " new " + quoted(project) + " && " + quoted(program) +
                           " simulate " + quoted(project) + " --experiment exp2fixed --quiet && " +
                           quoted(program) + " register " + quoted(project) + " --quiet && " +
                           quoted(program) + " relax " + quoted(project) + " --quiet";
  if (std::system(("(" + made + ") >/dev/null 2>&1").c_str()) != 0) {
    table.notes.push_back("Skipped: the project for the window's start could not be made.");
    return kept;
  }
  // The first start warms up.
  Json best;
  for (int round = 0; round < 3; ++round) {
    const Json json = told(display + quoted(benchmark) + " start " + quoted(scratch / "start") + " " +
                           quoted(project) + quiet);
    if (!json.is_null() && round > 0 &&
        (best.is_null() || json.at("usable_ms").get<double>() < best.at("usable_ms").get<double>()))
      best = json;
  }
  if (best.is_null()) {
    table.notes.push_back("Skipped: the window did not start.");
    return kept;
  }
  const std::string begin = "the window, warm, with the demo project of 14 scans";
  Row usable{.subject = begin, .program = "start to usable window"};
  usable.wall_ms = best.at("usable_ms").get<double>();
  table.rows.push_back(usable);
  Row drawn{.subject = begin, .program = "opening to all points drawn"};
  drawn.wall_ms = best.at("drawn_ms").get<double>();
  const long long shown = best.at("points").get<long long>();
  drawn.remark = formatted("%lld points", shown);
  table.rows.push_back(drawn);
  Row memory{.subject = begin, .program = "memory then"};
  memory.remark = formatted("%.0f MB, at most %.0f MB", best.at("memory_mb").get<double>(),
                            best.at("memory_peak_mb").get<double>());
  table.rows.push_back(memory);
  tell("verdicts in the window");
  kept = addVerdictRow(
             table, display + quoted(benchmark) + " verdict " + quoted(scratch / "verdict") + " 5" + quiet) &&
         kept;
  return kept && *usable.wall_ms < 1000.0 && *drawn.wall_ms < 1000.0 && shown > 0 &&
         best.at("memory_peak_mb").get<double>() < 400.0;
}

}  // namespace tiltmap::benchmarks
