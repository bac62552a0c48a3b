// tiltmap capture P.tiltmap --scanner URL --tilt URL | --emulate E | --resume
#include <array>
#include <cstdio>
#include <iostream>
#include <poll.h>
#include <unistd.h>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "hardware/capture/capture_operation.h"

namespace tiltmap::cli {

namespace {

// Set while a command may use standard input for answers; the window has none.
bool answers_at_terminal = false;

Result<std::string> askAtTerminal(const std::string& question, const std::stop_token& stop) {
  if (!answers_at_terminal)
    return fail("there is nobody to ask: " + question, "capture",
                "capture with `tiltmap capture` in a terminal");
  std::cerr << "\n" << question << ": " << std::flush;
  std::string line;
  while (!stop.stop_requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 50) <= 0) continue;
    char letter = 0;
    const ssize_t count = ::read(STDIN_FILENO, &letter, 1);
    if (count == 0 && line.empty())
      return fail("standard input has ended, and with it the answers", "capture",
                  "run it in a terminal; --resume goes on");
    if (count <= 0 || letter == '\n') return line;
    line += letter;
  }
  return fail(kCancelled, "capture", "`tiltmap capture PROJECT --resume` goes on");
}

std::string summary(const nlohmann::json& report) {
  double seconds = 0.0;
  for (const auto& scan : report["seconds_per_scan"]) seconds = std::max(seconds, scan.get<double>());
  const auto counted = [](int number, const std::string& what) {
    return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
  };
  std::string text = "captured " + counted(report["stops"].get<int>(), "stop") + ", " +
                     counted(report["lines"].get<int>(), "line") + "; " + fixedReal(seconds, 1) +
                     " s a scan at most";
  if (report.contains("motor")) {
    const auto& motor = report["motor"];
    text += " (motor of " + shortestReal(motor["counts_per_ms"]) + " counts/ms, " +
            shortestReal(motor["counts_per_ms2"]) + " counts/ms2, " + shortestReal(motor["settling_ms"]) +
            " ms settling)";
  }
  text += "; on the disk within " + fixedReal(report["slowest_store_ms"].get<double>(), 0) + " ms";
  if (report.contains("known_rig"))
    text += "\ntaken over from earlier stops: " + report["known_rig"].get<std::string>() +
            "; --known-rig=false leaves it away";
  if (const int spoiled = report["spoiled"].get<int>(); spoiled > 0)
    text += "\ntaken again, because damaged on the wire or measured before the tilt stood: " +
            counted(spoiled, "line");
  if (const int found = report["recoveries"].get<int>(); found > 0)
    text += "\ninstruments found again: " + counted(found, "time");
  return text;
}

}  // namespace

void registerOperations() {
  addOperation(makeCaptureOperation(askAtTerminal));
}

void addCapture(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "capture", "Take scans with a tilted scanner, real or emulated, line by line into the project");
  auto path = std::make_shared<std::string>();
  command->add_option("project", *path, "The project")->required();
  auto flags = ParameterFlags::addTo(*command, operations().find("capture")->parameters());
  command->callback([path, flags, &chosen] {
    chosen.body = [path, flags](Context& context) -> int {
      auto values = flags->values();
      if (!values) return context.console.wrongUsage(values.error());
      answers_at_terminal = true;
      return operationCommand(context, *path, "capture", "default", *values, summary);
    };
  });
}

}  // namespace tiltmap::cli
