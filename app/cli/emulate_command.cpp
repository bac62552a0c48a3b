// tiltmap emulate --experiment E [--seed N] [--scanner-link PATH --tilt-link PATH] [--stop K] [--speed X]
#include <poll.h>
#include <unistd.h>

#include "app/cli/command.h"
#include "core/base/text.h"
#include "hardware/emulator/terminal_rig.h"

namespace tiltmap::cli {

namespace {

struct EmulateWords {
  std::string experiment = "exp2fixed";
  int seed = 1, stop = 0, stops = 0;
  double speed = 1.0;
  std::string scanner_link, tilt_link, tilt_model = "mip50", scanner_model = "lms291";
};

// What a control line asks for; the error is told and nothing changes.
Status obey(TerminalRig& rig, std::string_view line) {
  const auto words = splitWords(line);
  if (words.empty()) return {};
  if (words[0] == "next" && words.size() == 1) return rig.moveTo(rig.stop() + 1);
  if (words[0] == "stop" && words.size() == 2) {
    const auto stop = parseInteger(words[1]);
    if (stop && *stop >= 0 && *stop < 1'000'000) return rig.moveTo(static_cast<int>(*stop));
  }
  if (words[0] == "fault" && words.size() == 2) return rig.fault(std::string(words[1]));
  return fail(printable(line) + " is no control line", "standard input",
              "write next, stop K, or fault NAME; names: " + joined(rig.faultNames(), ", "));
}

void control(Context& context, TerminalRig& rig, std::string_view line) {
  if (const Status status = obey(rig, line); !status) {
    context.console.warn(status.error().what + " (" + status.error().remedy + ")");
    return;
  }
  if (!trimmed(line).empty())
    context.console.note("done: " + std::string(trimmed(line)) + "; scanner at " + rig.scannerPort() +
                         ", tilt at " + rig.tiltPort());
}

// Until Ctrl-C. Standard input may end before.
void serve(Context& context, TerminalRig& rig) {
  bool listening = true;
  std::string line;
  while (!context.stop.stop_requested()) {
    pollfd input{listening ? STDIN_FILENO : -1, POLLIN, 0};
    if (::poll(&input, 1, 50) <= 0) continue;
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) != 1) {
      listening = false;
    } else if (letter == '\n') {
      control(context, rig, line);
      line.clear();
    } else if (line.size() < 1000) {
      line += letter;
    }
  }
}

int emulate(Context& context, const EmulateWords& words) {
  const auto id = experimentNamed(words.experiment);
  if (!id) return context.console.wrongUsage(id.error());
  auto experiment = Experiment::make(*id, static_cast<std::uint64_t>(words.seed), words.stops);
  if (!experiment) return context.console.failed(experiment.error());
  RealClock clock(words.speed);
  RigSettings settings;
  if (Status status = settings.chooseScanner(words.scanner_model); !status)
    return context.console.wrongUsage(status.error());
  if (Status status = settings.chooseTilt(words.tilt_model); !status)
    return context.console.wrongUsage(status.error());
  auto rig = TerminalRig::open(clock, *experiment, settings, words.scanner_link, words.tilt_link);
  if (!rig) return context.console.failed(rig.error());
  if (Status status = (*rig)->moveTo(words.stop); !status) return context.console.failed(status.error());
  const std::int64_t level = settings.levelCount();
  const std::string scanner = words.scanner_link.empty() || settings.scannerOverNetwork()
                                  ? (*rig)->scannerPort()
                                  : words.scanner_link;
  const std::string tilt = words.tilt_link.empty() ? (*rig)->tiltPort() : words.tilt_link;
  context.console.printJson({{"scanner", scanner},
                             {"tilt", tilt},
                             {"level", level},
                             {"stops", experiment->stops()},
                             {"motor",
                              {{"counts_per_ms", settings.tilt.most_speed},
                               {"counts_per_ms2", settings.tilt.most_acceleration},
                               {"settling_ms", 1000.0 * settings.tilt.settle_s}}}});
  context.console.print("--scanner " + settings.scannerUrl(scanner) + " --tilt \"" + settings.tiltUrl(tilt) +
                        "\"\nmotor of " + shortestReal(settings.tilt.most_speed) + " counts/ms, " +
                        shortestReal(settings.tilt.most_acceleration) + " counts/ms2, " +
                        shortestReal(1000.0 * settings.tilt.settle_s) + " ms settling; Ctrl-C ends it");
  serve(context, **rig);
  return kDone;
}

}  // namespace

void addEmulate(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "emulate", "Be a scanner and its tilt unit, at pseudo terminals, looking at a simulated site");
  auto words = std::make_shared<EmulateWords>();
  command->add_option("--experiment", words->experiment, "exp1, exp2, exp2fixed, loop or survey")
      ->capture_default_str();
  command->add_option("--seed", words->seed, "Another seed, another site")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--stop", words->stop, "Where the drive stands to begin with")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--stops", words->stops, "Stops of the drive, 0 for the experiment's own")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--speed", words->speed, "So many times as fast as the instruments are")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option(
      "--scanner-link", words->scanner_link,
      "A link to make to the scanner's terminal; of one at a network, the number of its port");
  command->add_option("--tilt-link", words->tilt_link, "A link to make to the tilt unit's terminal");
  command
      ->add_option("--scanner-model", words->scanner_model,
                   "The scanner: " + joined(RigSettings::scannerModels(), ", "))
      ->capture_default_str();
  command
      ->add_option("--tilt-model", words->tilt_model,
                   "The tilt unit: " + joined(RigSettings::tiltModels(), ", "))
      ->capture_default_str();
  command->footer(
      "Lines on standard input: next, stop K, fault NAME. The instruments are booted, at 9600 and 19200 Bd "
      "(epos: 115200, epos-v1: 38400).");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return emulate(context, *words); };
  });
}

}  // namespace tiltmap::cli
