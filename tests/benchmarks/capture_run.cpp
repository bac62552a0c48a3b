#include "tests/benchmarks/capture_run.h"

#include <ctime>

#include "core/base/text.h"
#include "core/project/live_project.h"
#include "core/scan/beam_tilts.h"
#include "hardware/capture/instruments.h"
#include "tests/support/map_distance.h"

namespace tiltmap::benchmarks {

namespace {

namespace fs = std::filesystem;

constexpr int kLines = 101;

double processorMs() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

struct Case {
  const char* program;
  double speed;
  int baud;
  bool steady = false;
};

struct Taken {
  SweepReport report;
  double cpu_ms = 0.0;
  Scan scan;
};

Result<Taken> takeScan(const fs::path& scratch, const Case& one) {
  const fs::path path = scratch / "capture.tiltmap";
  fs::remove(path);
  auto project = Project::create(path);
  if (!project) return fail(project.error());
  const RigSettings rig;
  auto experiment = Experiment::make(ExperimentId::Exp2Fixed, 1);
  if (!experiment) return fail(experiment.error());
  auto bench = EmulatedBench::make(*experiment, rig, one.speed, one.baud);
  if (!bench) return fail(bench.error());
  SweepOptions settings;
  settings.steady = one.steady;
  Sweep sweep((*bench)->instruments(), settings);
  if (Status status = sweep.prepare({}); !status) return fail(status.error());
  AddScan add;
  add.scan.geometry = sweep.geometry(kLines, rig.start_rad, rig.step_rad);
  const ScannerGeometry geometry = add.scan.geometry;
  ProjectEdit edit;
  edit.title = "capture";
  edit.steps.emplace_back(std::move(add));
  auto change = (*project)->apply(edit);
  if (!change) return fail(change.error());
  OwnLiveProject live(**project);
  const double before = processorMs();
  auto report = sweep.run(geometry, std::vector<bool>(kLines, false),
                          [&](int row, ScanLine line) {
                            return live.appendLine(change->scans_added.front(), row, std::move(line));
                          },
                          {});
  if (!report) return fail(report.error());
  Taken taken{*report, processorMs() - before, {}};
  auto image = (*project)->snapshot()->find(change->scans_added.front())->image();
  if (!image) return fail(image.error());
  taken.scan.image = *image;
  taken.scan.geometry = geometry;
  return taken;
}

Row timeRow(const Case& one, const Taken& taken) {
  Row row{.subject = "one scan, 101 lines of 361", .program = one.program};
  row.wall_ms = 1000.0 * taken.report.duration_s;
  row.cpu_ms = taken.cpu_ms;
  row.within = std::to_string(taken.report.taken) + "/" + std::to_string(kLines);
  row.remark = fixedReal(1000.0 * taken.report.duration_s / kLines, 1) + " ms a line; on the disk within " +
               fixedReal(1000.0 * taken.report.slowest_store_s, 1) + " ms";
  return row;
}

// Where the points lie, beside the surfaces that a scan taken line by line saw from the same place.
Row placeRow(const std::string& program, const Scan& still, const Scan& scan) {
  const test::MapDistance distance = test::mapDistance(still, scan);
  Row row{.subject = "points of that scan off the surfaces it sees line by line", .program = program};
  row.median_mm = 1000.0 * distance.median_m;
  row.remark = "nine tenths within " + fixedReal(1000.0 * distance.ninety_m, 1) + " mm; " +
               std::to_string(distance.points) + " points";
  return row;
}

}  // namespace

void addCaptureRows(Table& table, const fs::path& scratch,
                    const std::function<void(const std::string&)>& tell) {
  const Mip50EmulatorSettings motor;
  table.heading.push_back("capture   emulated instruments: a motor of " + shortestReal(motor.most_speed) +
                          " counts/ms and " + shortestReal(motor.most_acceleration) + " counts/ms2, " +
                          shortestReal(1000.0 * motor.settle_s) +
                          " ms settling; wall is the instruments' time, from the way to the first line on");
  fs::create_directories(scratch);
  std::vector<Row> places;
  Scan still;
  for (const Case& one :
       {Case{"9600 Bd, virtual clock", 0.0, 9600}, Case{"38400 Bd, virtual clock", 0.0, 38400},
        Case{"500000 Bd, virtual clock", 0.0, 500000},
        Case{"38400 Bd, continuous, virtual clock", 0.0, 38400, true},
        Case{"500000 Bd, continuous, virtual clock", 0.0, 500000, true},
        Case{"38400 Bd, real time, pseudo terminals", 1.0, 38400},
        Case{"38400 Bd, continuous, real time", 1.0, 38400, true}}) {
    tell(std::string("capture at ") + one.program);
    const auto taken = takeScan(scratch, one);
    if (!taken) {
      table.notes.push_back(std::string("capture at ") + one.program + ": " + taken.error().what);
      continue;
    }
    table.rows.push_back(timeRow(one, *taken));
    if (one.speed > 0.0) continue;
    if (!one.steady) {
      if (one.baud != 38400) continue;
      still = taken->scan;
      places.push_back(placeRow("line by line", still, still));
    } else if (still.image) {
      const std::string rate = std::to_string(one.baud) + " Bd";
      places.push_back(placeRow("continuous, " + rate, still, taken->scan));
      Scan lines = taken->scan;
      if (auto image = withoutBeamTilts(*lines.image, lines.geometry)) {
        lines.image = *image;
        places.push_back(placeRow("  correction switched off, " + rate, still, lines));
      }
    }
  }
  table.rows.insert(table.rows.end(), places.begin(), places.end());
}

}  // namespace tiltmap::benchmarks
