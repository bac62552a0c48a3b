#include "hardware/capture/capture_plan.h"

#include <algorithm>

#include "core/base/text.h"
#include "hardware/capture/capture_operation.h"
#include "hardware/capture/instruments.h"
#include "hardware/capture/stop_odometry.h"

namespace tiltmap {

ExperimentId experimentOf(CaptureDrive drive) {
  switch (drive) {
    case CaptureDrive::Exp1:
      return ExperimentId::Exp1;
    case CaptureDrive::Exp2:
      return ExperimentId::Exp2;
    case CaptureDrive::Loop:
      return ExperimentId::Loop;
    case CaptureDrive::Survey:
      return ExperimentId::Survey;
    default:
      return ExperimentId::Exp2Fixed;
  }
}

const ParameterTable<CaptureSettings>& captureTable() {
  static const ParameterTable<CaptureSettings> table = [] {
    ParameterTable<CaptureSettings> t("capture");
    using S = CaptureSettings;
    t.text("scanner", &S::scanner,
           "The scanner: lms2xx:PORT, lms1xx:HOST or urg:PORT, options behind `?` (baud, resolution, ...)",
           "ours");
    t.text(
        "tilt", &S::tilt,
        "The tilt unit: mip50:PORT or epos:PORT, options behind `?` (baud, level, min, max), or manual: to "
        "set each angle by hand",
        "ours");
    t.choice("emulate", &S::emulate,
             {{"none", CaptureDrive::None},
              {"exp1", CaptureDrive::Exp1},
              {"exp2", CaptureDrive::Exp2},
              {"exp2fixed", CaptureDrive::Exp2Fixed},
              {"loop", CaptureDrive::Loop},
              {"survey", CaptureDrive::Survey}},
             "Emulated instruments on a simulated drive instead of real ones; stores its odometry and truth",
             "ours");
    t.integer("seed", &S::seed, "", 0, 2147483647,
              "Of the emulated drive: another seed, another site of the same kind", "ours");
    t.real("speed", &S::speed, "", 0.0, 100.0,
           "Emulated instruments so many times as fast as they are; 0: as fast as the machine can, in memory",
           "ours");
    t.integer("baud", &S::baud, "", 9600, 500000,
              "Rate of the emulated scanner: 9600, 19200, 38400 or 500000; a real one's is in its URL",
              "ours");
    t.choice(
        "mode", &S::mode, {{"stop", CaptureMode::Stop}, {"continuous", CaptureMode::Continuous}},
        "stop: each line while the tilt stands still. continuous: the tilt moves on at one speed and every "
        "beam gets its own angle; faster",
        "stop: thesis 3.2; continuous: ours");
    t.integer("lines", &S::lines, "", 1, 2000, "Lines of a scan", "thesis 3.2: 101");
    t.angle("step", &S::step_rad, 0.01, 45.0, "Tilt from line to line, upwards", "thesis 3.2: 0.8 deg");
    t.angle("start", &S::start_rad, -180.0, 180.0, "Tilt of the first line, 0 level, positive up",
            "ours; the thesis gives the range of 80 deg, not where it lies");
    t.integer("stops", &S::stops, "", 0, 5000,
              "Stops to capture, asking for the odometry between them; 0: one, or all of an emulated drive",
              "ours");
    t.text("odometry", &S::odometry,
           "X,Y,HEADING of the stop in the frame of the last one: metres right and forward, degrees left",
           "thesis 5.1");
    t.text("odometry-from", &S::odometry_from,
           "Where the stops' poses come from, in place of steps: a TUM file with one pose for each stop of "
           "the project, or tcp://HOST:PORT, who sends lines `stamp x y z qx qy qz qw`",
           "ours");
    t.choice("odometry-axes", &S::odometry_axes,
             {{"ros", BodyAxes::ForwardLeftUp}, {"tiltmap", BodyAxes::RightForwardUp}},
             "Axes of the vehicle in those poses. ros: x forward, y left; tiltmap: x right, y forward",
             "ours; REP 103");
    t.boolean(
        "resume", &S::resume,
        "Go on with the capture that was interrupted: at its next line, with everything it was begun with",
        "ours");
    t.real("patience", &S::patience_s, "s", 1.0, 3600.0,
           "How long an instrument that got lost is looked for before the capture ends", "ours");
    t.boolean(
        "known-rig", &S::known_rig,
        "Give the stop the calibration and the mask of the machine's body that earlier stops of the same "
        "instruments and sweep have in the project",
        "ours");
    return t;
  }();
  return table;
}

namespace {

// The last capture that the project remembers, with what was left of its stops.
const JobRecord* lastCapture(const ProjectSnapshot& snapshot) {
  const auto found = std::find_if(snapshot.jobs().rbegin(), snapshot.jobs().rend(),
                                  [](const JobRecord& job) { return job.operation == kCaptureId; });
  return found == snapshot.jobs().rend() ? nullptr : &*found;
}

Result<CapturePlan> resumed(const ProjectSnapshot& snapshot, const CaptureSettings& given) {
  const JobRecord* record = lastCapture(snapshot);
  if (!record || snapshot.scans().empty())
    return fail("there is no capture to go on with", snapshot.path().string(), "begin one without --resume");
  CapturePlan plan;
  if (Status status = captureTable().apply(record->values, plan.settings); !status)
    return fail(status.error());
  plan.settings.patience_s = given.patience_s;
  plan.settings.speed = plan.settings.emulate == CaptureDrive::None ? 1.0 : given.speed;
  plan.stops = std::max(1, plan.settings.stops);
  const ScanEntry& last = snapshot.scans().back();
  plan.first_stop = static_cast<int>(snapshot.scans().size()) - 1;
  if (last.lines < last.rows) {
    plan.unfinished = &last;
    return plan;
  }
  // Interrupted between two stops.
  plan.settings.odometry.clear();
  ++plan.first_stop;
  if (--plan.stops == 0)
    return fail("the last capture was completed", snapshot.path().string(),
                "begin another one without --resume");
  return plan;
}

}  // namespace

Result<CapturePlan> planCapture(const ProjectSnapshot& snapshot, const CaptureSettings& settings) {
  if (settings.resume) return resumed(snapshot, settings);
  CapturePlan plan;
  plan.settings = settings;
  plan.stops = std::max(1, settings.stops);
  if (settings.emulate == CaptureDrive::None) return plan;
  if (!snapshot.scans().empty())
    return fail("the project already has scans, of another world than the emulated drive",
                snapshot.path().string(),
                "capture into a new project (`tiltmap new`), or go on with --resume");
  const auto poses = experimentPoses(experimentOf(settings.emulate),
                                     static_cast<std::uint64_t>(settings.seed), settings.stops);
  if (!poses) return fail(poses.error());
  plan.stops = static_cast<int>(poses->size());
  return plan;
}

std::string emulatedSource(CaptureDrive drive, int seed) {
  return "emulated " + std::string(nameOf(experimentOf(drive))) + " seed " + std::to_string(seed);
}

Result<CapturePlan> planNextStop(const ProjectSnapshot& snapshot, const CaptureSettings& settings) {
  CapturePlan plan;
  plan.settings = settings;
  const auto& scans = snapshot.scans();
  const bool emulated = settings.emulate != CaptureDrive::None;
  if (emulated) {
    plan.drive_stops = defaultStops(experimentOf(settings.emulate));
    plan.first_stop = static_cast<int>(scans.size());
    const std::string source = emulatedSource(settings.emulate, settings.seed);
    for (const ScanEntry& scan : scans)
      if (scan.source != source)
        return fail("the project has scans of another world than the emulated drive", scan.name,
                    "capture into a new project");
  }
  if (settings.resume) {
    const JobRecord* record = lastCapture(snapshot);
    if (!record || scans.empty() || scans.back().lines >= scans.back().rows)
      return fail("there is no interrupted scan to go on with", snapshot.path().string(),
                  "capture the next stop");
    CaptureSettings then;
    if (Status status = captureTable().apply(record->values, then); !status) return fail(status.error());
    plan.settings.mode = then.mode;
    plan.unfinished = &scans.back();
    if (emulated) --plan.first_stop;
    return plan;
  }
  if (emulated && plan.first_stop >= plan.drive_stops)
    return fail("the emulated drive ends here: all its " + std::to_string(plan.drive_stops) +
                    " stops are in the project",
                "", "connect to another drive and capture into a new project");
  return plan;
}

namespace {

Status checkOdometryFrom(const ProjectSnapshot& snapshot, const CaptureSettings& settings) {
  if (settings.odometry_from.empty()) return {};
  if (!settings.odometry.empty())
    return fail("the step is given twice", "capture --odometry-from",
                "leave --odometry or --odometry-from away");
  if (Status status = checkStopOdometry(settings.odometry_from); !status) return status;
  if (!isOdometryFeed(settings.odometry_from) || snapshot.scans().empty()) return {};
  // A feed knows poses in its own frame alone.
  if (const JobRecord* record = lastCapture(snapshot)) {
    CaptureSettings then;
    if (captureTable().apply(record->values, then) && then.odometry_from == settings.odometry_from) return {};
  }
  return fail("the last stop was not placed by this feed, so where it is in the feed's frame is not known",
              settings.odometry_from,
              "give this step with --odometry X,Y,HEADING, or begin a project with the feed");
}

}  // namespace

Status checkCapture(const ProjectSnapshot& snapshot, const CaptureSettings& settings,
                    const AskOperator& ask) {
  if (settings.baud != 9600 && settings.baud != 19200 && settings.baud != 38400 && settings.baud != 500000)
    return fail("the scanner has no rate of " + std::to_string(settings.baud) + " Bd", "capture --baud",
                "give 9600, 19200, 38400 or 500000");
  if (auto step = parseStep(settings.odometry); !step) return fail(step.error());
  if (settings.emulate != CaptureDrive::None) {
    if (!settings.scanner.empty() || !settings.tilt.empty() || !settings.odometry.empty() ||
        !settings.odometry_from.empty())
      return fail("an emulated drive brings its own instruments and odometry", "capture --emulate",
                  "leave --scanner, --tilt, --odometry and --odometry-from away");
    return {};
  }
  if (Status status = checkOdometryFrom(snapshot, settings); !status) return status;
  if (settings.scanner.empty() || settings.tilt.empty())
    return fail(
        std::string("no ") + (settings.scanner.empty() ? "scanner" : "tilt unit") + " is named", "capture",
        "give --scanner lms2xx:PORT --tilt mip50:PORT (`tiltmap devices` lists ports), or --emulate exp1");
  if (settings.mode == CaptureMode::Continuous && settings.tilt.starts_with("manual"))
    return fail("a tilt that is set by hand cannot move on steadily", "capture --mode continuous",
                "capture line by line: --mode stop");
  if (settings.stops > 1 && !ask)
    return fail("several stops need somebody to ask for the odometry between them", "capture --stops",
                "capture one stop at a time");
  RealClock unused;
  return namedInstruments(settings.scanner, settings.tilt, unused, ask).map([](const auto&) {});
}

Result<Pose> parseStep(const std::string& text) {
  if (trimmed(text).empty()) return Pose();
  const auto parts = splitAt(text, ',');
  std::vector<double> numbers;
  for (const std::string_view part : parts)
    if (const auto number = parseReal(trimmed(part)); number && std::abs(*number) < 1e6)
      numbers.push_back(*number);
  if (parts.size() != 3 || numbers.size() != 3)
    return fail(
        printable(text) + " is no odometry", "capture --odometry",
        "give X,Y,HEADING: metres right, metres forward, degrees to the left, for example 0.1,5.2,-3");
  return Pose::planar(numbers[0], numbers[1], numbers[2] * kDegree);
}

}  // namespace tiltmap
