#include "tests/benchmarks/pair_run.h"

#include <algorithm>

namespace tiltmap::benchmarks {

namespace {

constexpr double kGoodM = 0.02;

std::string share(std::size_t part, std::size_t whole) {
  return std::to_string(part) + "/" + std::to_string(whole);
}

Row rowOf(const std::string& subject, const PairMethod& method,
          const std::vector<const PairMeasurement*>& own) {
  std::vector<double> wall, cpu, metres, radians, floors;
  std::size_t failed = 0;
  std::size_t good = 0;
  for (const PairMeasurement* m : own) {
    wall.push_back(m->timing.wall_ms);
    cpu.push_back(m->timing.cpu_ms);
    metres.push_back(m->error.translation_m);
    radians.push_back(m->error.rotation_rad);
    if (m->times_floor > 0.0) floors.push_back(m->times_floor);
    failed += m->fixed_from_moving ? 0 : 1;
    good += m->fixed_from_moving && m->error.translation_m <= kGoodM ? 1 : 0;
  }
  Row row{.subject = subject, .program = method.name};
  row.wall_ms = median(wall);
  row.cpu_ms = median(cpu);
  row.median_mm = median(metres) * 1e3;
  row.median_deg = median(radians) / kDegree;
  if (!floors.empty()) row.times_floor = median(floors);
  row.most_mm = quantile(metres, 0.95) * 1e3;
  row.worst_mm = *std::max_element(metres.begin(), metres.end()) * 1e3;
  row.worst_deg = *std::max_element(radians.begin(), radians.end()) / kDegree;
  row.within = share(good, own.size());
  if (failed > 0) row.remark = std::to_string(failed) + " gave up";
  return row;
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const std::size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle), values.end());
  const double upper = values[middle];
  if (values.size() % 2 == 1) return upper;
  return 0.5 *
         (upper + *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle)));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

std::vector<PairMeasurement> runPairs(const std::vector<PairProblem>& problems,
                                      const std::vector<PairMethod>& methods, int rounds,
                                      const std::function<void(const std::string&)>& tell) {
  std::vector<PairMeasurement> all;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    const PairProblem& problem = problems[p];
    tell(problem.name);
    std::vector<TimedJob> jobs;
    for (const PairMethod& method : methods) jobs.push_back(method.load(problem));
    std::vector<PairMeasurement> own(methods.size());
    for (int round = 0; round < rounds; ++round) {
      for (std::size_t m = 0; m < methods.size(); ++m) {
        std::optional<Pose> found;
        own[m].timing.keepQuietest(timed([&] {
          if (Result<Pose> pose = jobs[m](); pose) found = *pose;
        }));
        own[m].fixed_from_moving = found;
      }
    }
    for (std::size_t m = 0; m < methods.size(); ++m) {
      own[m].problem = p;
      own[m].method = m;
      if (problem.true_fixed_from_moving)
        own[m].error = difference(own[m].fixed_from_moving.value_or(problem.start_fixed_from_moving),
                                  *problem.true_fixed_from_moving);
      if (problem.floor) own[m].times_floor = own[m].error.translation_m / problem.floor->translation_m;
      all.push_back(own[m]);
    }
  }
  return all;
}

void addPairRows(Table& table, const std::string& subject, const std::vector<PairMethod>& methods,
                 const std::vector<PairMeasurement>& measurements) {
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<const PairMeasurement*> own;
    for (const PairMeasurement& measurement : measurements)
      if (measurement.method == m) own.push_back(&measurement);
    if (!own.empty()) table.rows.push_back(rowOf(subject, methods[m], own));
  }
  table.setRatios(subject, methods.front().name);
}

}  // namespace tiltmap::benchmarks
