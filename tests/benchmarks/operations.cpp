#include "tests/benchmarks/operations.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include <benchmark/benchmark.h>

namespace tiltmap::benchmarks {

namespace {

// Google Benchmark names a run "operation/repeats:5/real_time"; the operation is its place in our list.
struct Collected {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;
  bool any = false;
  std::string error;
};

class Collector : public benchmark::BenchmarkReporter {
 public:
  explicit Collector(std::vector<Collected>& collected) : collected_(collected) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      Collected& own = collected_.at(std::stoul(run.run_name.function_name));
      if (run.error_occurred) {
        own.error = run.error_message;
        continue;
      }
      const double wall = run.GetAdjustedRealTime();
      const double cpu = run.GetAdjustedCPUTime();
      own.wall_ms = own.any ? std::min(own.wall_ms, wall) : wall;
      own.cpu_ms = own.any ? std::min(own.cpu_ms, cpu) : cpu;
      own.any = true;
    }
  }

 private:
  std::vector<Collected>& collected_;
};

std::string resultText(double value, const std::string& what) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(),
                value == static_cast<double>(static_cast<long long>(value)) ? "%.0f" : "%.4f", value);
  return std::string(text.data()) + " " + what;
}

}  // namespace

void addOperationRows(Table& table, const std::vector<Operation>& operations, int repetitions) {
  std::vector<Collected> collected(operations.size());
  std::vector<double> results(operations.size());
  for (std::size_t i = 0; i < operations.size(); ++i) {
    benchmark::RegisterBenchmark(std::to_string(i).c_str(),
                                 [&, i](benchmark::State& state) {
                                   for (auto _ : state) {
                                     // Not DoNotOptimize: g++ lets it overwrite a variable that lives on; the
                                     // call through the function is kept
                                     // anyway.
                                     results[i] = operations[i].run();
                                   }
                                 })
        ->Unit(benchmark::kMillisecond)
        ->MinTime(0.1)
        ->Repetitions(repetitions)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  }
  std::array<char, 24> program{"benchmarks"};
  std::array<char, 48> interleave{"--benchmark_enable_random_interleaving=true"};
  std::array<char*, 2> arguments{program.data(), interleave.data()};
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  Collector collector(collected);
  benchmark::RunSpecifiedBenchmarks(&collector);

  // Rows of one subject stand together, ours first; the first row of a subject is what the others are held
  // against.
  std::vector<std::string> subjects;
  for (const Operation& operation : operations)
    if (std::find(subjects.begin(), subjects.end(), operation.subject) == subjects.end())
      subjects.push_back(operation.subject);
  for (const std::string& subject : subjects) {
    const std::size_t first = table.rows.size();
    for (std::size_t i = 0; i < operations.size(); ++i) {
      if (operations[i].subject != subject) continue;
      Row row{.subject = subject, .program = operations[i].program};
      if (collected[i].any) {
        row.wall_ms = collected[i].wall_ms;
        row.cpu_ms = collected[i].cpu_ms;
      }
      row.remark =
          collected[i].error.empty() ? resultText(results[i], operations[i].result) : collected[i].error;
      table.rows.push_back(std::move(row));
    }
    table.setRatios(subject, std::string(table.rows[first].program));
  }
}

}  // namespace tiltmap::benchmarks
