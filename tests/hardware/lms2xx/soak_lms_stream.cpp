// soak_lms_stream: the driver, through the real serial port class, listens to a scanner that streams as fast
// as it can, for MINUTES (default 10) each of 180 degrees by 1 (75 lines a second) and by 0.5 (37.5). No line
// may be lost. The scanner is a process of its own behind a pseudo terminal, so that the processor time told
// is the driver's alone.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/text.h"
#include "hardware/emulator/emulator_thread.h"
#include "hardware/emulator/lms_emulator.h"
#include "hardware/lms2xx/lms_scanner.h"
#include "hardware/transport/pseudo_terminal.h"
#include "hardware/transport/serial_port.h"

namespace tiltmap {
namespace {

// Runs until its parent is gone; writes the terminal's name to the descriptor.
[[noreturn]] void beTheScanner(int tell, int parent_gone) {
  RealClock clock;
  auto terminal = PseudoTerminal::open(clock);
  if (!terminal) std::_Exit(1);
  RoundView view;
  LmsEmulator emulator(clock, view);
  emulator.plug(terminal->get());
  const EmulatorThread thread(clock, {{&emulator, terminal->get()}});
  const std::string name = (*terminal)->name() + "\n";
  if (write(tell, name.data(), name.size()) < 0) std::_Exit(1);
  char byte = 0;
  while (read(parent_gone, &byte, 1) > 0) {
  }
  std::_Exit(0);
}

double processorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

bool stream(const std::string& port, const lms2xx::Variant& variant, double minutes) {
  RealClock clock;
  LmsSettings settings;
  settings.baud = 500000;
  settings.variant = variant;
  settings.indices = true;
  LmsScanner scanner(
      [&]() -> Result<std::unique_ptr<ByteChannel>> {
        auto opened = SerialPort::open(port, {9600}, clock);
        if (!opened) return fail(opened.error());
        return std::move(*opened);
      },
      clock, settings);
  const auto failed = [](const Error& error) {
    std::printf("FAILED: %s (%s)\n", error.what.c_str(), error.where.c_str());
    return false;
  };
  if (const auto report = scanner.recover(60.0); !report) return failed(report.error());
  if (const auto begun = scanner.startStream(); !begun) return failed(begun.error());
  const Instant begin = clock.now();
  const double processor = processorSeconds();
  double longest = 0.0;
  Instant last = begin;
  std::size_t lines = 0;
  while (secondsOf(clock.now() - begin) < minutes * 60.0) {
    const auto line = scanner.next();
    if (!line) return failed(line.error());
    ++lines;
    longest = std::max(longest, secondsOf(line->last_byte - last));
    last = line->last_byte;
  }
  const double seconds = secondsOf(last - begin);
  const double used = processorSeconds() - processor;
  const auto counts = scanner.statistics();
  const double due = seconds / scanner.streamPeriod();
  const bool good = counts.lost_lines == 0 && std::abs(static_cast<double>(lines) - due) < 0.01 * due + 3.0;
  std::printf(
      "%s  %d by %.2f degrees at 500000 Bd: %zu lines in %.1f s (%.2f a second), %zu lost, %zu bytes of "
      "noise, longest "
      "pause %.0f ms, processor %.1f %% of one core\n",
      good ? "passed" : "FAILED", variant.angle_deg, variant.resolution_cdeg / 100.0, lines, seconds,
      static_cast<double>(lines) / seconds, counts.lost_lines, counts.noise_bytes, longest * 1e3,
      100.0 * used / seconds);
  std::fflush(stdout);
  return good;
}

int soak() {
  const char* given = std::getenv("MINUTES");
  const double minutes = given ? parseReal(given).value_or(0.0) : 10.0;
  if (!(minutes > 0.0)) {
    std::fprintf(stderr, "MINUTES must be a positive number\n");
    return 2;
  }
  int told[2], alive[2];
  if (pipe(told) != 0 || pipe(alive) != 0) return 1;
  const pid_t child = fork();
  if (child < 0) return 1;
  if (child == 0) {
    close(alive[1]);
    beTheScanner(told[1], alive[0]);
  }
  close(told[1]);
  close(alive[0]);
  std::string port;
  for (char c = 0; read(told[0], &c, 1) == 1 && c != '\n';) port += c;
  bool good = !port.empty();
  if (!good) std::printf("FAILED: there are no pseudo terminals\n");
  for (const lms2xx::Variant& variant : {lms2xx::Variant{180, 100}, lms2xx::Variant{180, 50}})
    if (!port.empty() && !stream(port, variant, minutes)) good = false;
  close(alive[1]);
  waitpid(child, nullptr, 0);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace tiltmap

int main() {
  return tiltmap::soak();
}
