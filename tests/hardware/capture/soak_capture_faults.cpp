// soak_capture_faults: scans of the emulated rig under faults of both instruments, thrown at random moments.
// Every line that was stored must be what the site truly gives at the tilt that was read back; what is
// missing must be missing, and when an interrupted scan is gone on with it has to become whole.
//
//   SCANS=1000 LINES=101 SEED=1 soak_capture_faults      (default: 1000 scans of 101 lines)
//   FIRST=560 SCANS=571 soak_capture_faults              a part of it again, from a multiple of 20 on
#include <cstdio>
#include <cstdlib>
#include <map>

#include "core/project/live_project.h"
#include "hardware/capture/instruments.h"
#include "tests/support/captured_lines.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

int wished(const char* name, int usual) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : usual;
}

// Throws a fault every few seconds of emulated time, and ends those that do not end by themselves.
class Mischief : public Actor {
 public:
  Mischief(VirtualClock& clock, EmulatedBench& bench, std::uint64_t seed) : bench_(bench), random_(seed) {
    next_ = clock.now() + durationOf(random_.uniform(1.0, 9.0));
  }
  Instant nextEvent() const override { return next_; }
  void act(Instant now) override {
    static const char* const kFaults[] = {"lose-byte=0.0003",
                                          "flip-bit=0.0003",
                                          "duplicate-byte=0.0003",
                                          "insert-byte=0.0003",
                                          "split=0.01",
                                          "cut-telegram",
                                          "power-cut=2",
                                          "silent",
                                          "lose-acknowledge",
                                          "miss-request",
                                          "late-answer=1",
                                          "motor-stall",
                                          "follow-error",
                                          "lost-steps",
                                          "tilt-late-reply",
                                          "tilt-lost-acknowledge",
                                          "tilt-silence",
                                          "tilt-lost-byte",
                                          "tilt-flipped-byte",
                                          "tilt-inserted-byte",
                                          "tilt-lost-command-byte",
                                          "tilt-flipped-command-byte",
                                          "tilt-power-cut",
                                          "unplug"};
    if (ending_) {
      (void)bench_.fault("none");
      (void)bench_.fault("tilt-recover");
    } else {
      const std::string name = kFaults[random_.below(std::size(kFaults))];
      ++thrown[name];
      if (name == "unplug")
        bench_.unplug();
      else if (const Status status = bench_.fault(name); !status)
        std::printf("a fault is not known: %s\n", name.c_str()), std::exit(1);
    }
    ending_ = !ending_;
    next_ = now + durationOf(ending_ ? random_.uniform(0.5, 6.0) : random_.uniform(1.0, 12.0));
  }
  std::map<std::string, int> thrown;

 private:
  EmulatedBench& bench_;
  RandomStream random_;
  Instant next_;
  bool ending_ = false;
};

struct Tally {
  int scans = 0, lines = 0, wrong = 0, unfinished = 0, resumed = 0, spoiled = 0, recoveries = 0;
};

// One scan into the project, gone on with as often as it takes. False: something stored was not true.
bool scanOnce(Project& project, EmulatedBench& bench, int stop, int rows, Tally& tally) {
  OwnLiveProject live(project);
  const RigSettings rig;
  if (!bench.moveTo(stop)) return false;
  ScanId scan = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    SweepOptions settings;
    settings.patience_s = 20.0;
    Sweep sweep(bench.instruments(), settings);
    if (!sweep.prepare({})) {
      bench.clock().sleepFor(durationOf(2.0));
      continue;
    }
    const ScannerGeometry geometry = sweep.geometry(rows, rig.start_rad, rig.step_rad);
    std::vector<bool> taken(static_cast<std::size_t>(rows), false);
    if (scan == 0) {
      AddScan add;
      add.scan.geometry = geometry;
      ProjectEdit edit;
      edit.title = "scan";
      edit.steps.emplace_back(std::move(add));
      scan = project.apply(edit)->scans_added.front();
    } else {
      ++tally.resumed;
      const auto image = project.snapshot()->find(scan)->image();
      for (int row = 0; row < rows; ++row)
        taken[static_cast<std::size_t>(row)] = (*image)->code(row, 0) != cell_code::kNotScanned;
    }
    const auto report =
        sweep.run(geometry, taken,
                  [&](int row, ScanLine line) { return live.appendLine(scan, row, std::move(line)); }, {});
    if (report) {
      tally.spoiled += report->spoiled;
      tally.recoveries += report->recoveries;
      break;
    }
  }
  ++tally.scans;
  const ScanEntry* entry = scan ? project.snapshot()->find(scan) : nullptr;
  if (!entry || entry->lines < rows) ++tally.unfinished;
  if (!entry) return true;
  const auto image = entry->image();
  bool all_true = true;
  for (int row = 0; row < rows; ++row) {
    if ((*image)->code(row, 0) == cell_code::kNotScanned) continue;
    ++tally.lines;
    const std::size_t first = (*image)->index(row, 0);
    const double tilt = (*image)->lineTilt(row);
    std::string wrong = std::abs(tilt - entry->geometry.tiltOfRow(row)) > test::kTiltToleranceRad
                            ? "tilt " + std::to_string(tilt)
                            : test::differsFromSite(bench.rig().view(), entry->geometry, tilt,
                                                    (*image)->data().range_m.data() + first,
                                                    (*image)->data().code.data() + first);
    if (wrong.empty()) continue;
    ++tally.wrong;
    all_true = false;
    std::printf("scan %d line %d: %s\n", tally.scans, row, wrong.c_str());
  }
  return all_true;
}

int soak() {
  const int scans = wished("SCANS", 1000), rows = wished("LINES", 101);
  const auto seed = static_cast<std::uint64_t>(wished("SEED", 1));
  const test::TemporaryFolder folder;
  constexpr int kScansAProject = 20;  // keeps the file small; each with another site
  const int first = wished("FIRST", 0) / kScansAProject * kScansAProject;
  Tally tally;
  tally.scans = first;
  std::map<std::string, int> thrown;
  std::unique_ptr<Project> project;
  std::unique_ptr<EmulatedBench> bench;
  std::unique_ptr<Mischief> mischief;
  for (int i = first; i < scans; ++i) {
    if (i % kScansAProject == 0) {
      if (bench) dynamic_cast<VirtualClock&>(bench->clock()).detach(*mischief);
      if (mischief)
        for (const auto& [name, count] : mischief->thrown) thrown[name] += count;
      project.reset();
      const std::filesystem::path path = folder / "soak.tiltmap";
      std::filesystem::remove(path);
      project = std::move(*Project::create(path));
      RigSettings rig;
      rig.scanner.seed = rig.tilt.seed = seed * 100000 + static_cast<std::uint64_t>(i);
      bench = *EmulatedBench::make(
          *Experiment::make(ExperimentId::Exp2Fixed, seed + static_cast<std::uint64_t>(i)), rig, 0.0);
      auto& clock = dynamic_cast<VirtualClock&>(bench->clock());
      mischief = std::make_unique<Mischief>(clock, *bench, seed * 7919 + static_cast<std::uint64_t>(i));
      clock.attach(*mischief);
    }
    scanOnce(*project, *bench, i % 14, rows, tally);
  }
  dynamic_cast<VirtualClock&>(bench->clock()).detach(*mischief);
  for (const auto& [name, count] : mischief->thrown) thrown[name] += count;
  std::printf(
      "%d scans, %d lines stored, %d wrong, %d scans unfinished; %d times gone on, %d lines taken again, "
      "%d instruments found again\nfaults:",
      tally.scans - first, tally.lines, tally.wrong, tally.unfinished, tally.resumed, tally.spoiled,
      tally.recoveries);
  for (const auto& [name, count] : thrown) std::printf(" %s %d", name.c_str(), count);
  std::printf("\n");
  return tally.wrong == 0 && tally.lines > 0 ? 0 : 1;
}

}  // namespace
}  // namespace tiltmap

int main() {
  return tiltmap::soak();
}
