#include "hardware/emulator/terminal_rig.h"

#include "core/base/text.h"
#include "hardware/transport/tcp_channel.h"

namespace tiltmap {

namespace {

Result<std::unique_ptr<DeviceWire>> scannerWire(RealClock& clock, const RigSettings& settings,
                                                const std::string& link) {
  if (settings.scannerOverNetwork()) {
    const auto port = link.empty() ? std::optional<long long>(0) : parseInteger(link);
    if (!port || *port < 0 || *port > 65535)
      return fail("`" + link + "` is no port of a network", "emulated scanner",
                  "give a number up to 65535, or none for any that is free");
    auto wire = TcpWire::listen(clock, static_cast<int>(*port));
    if (!wire) return fail(wire.error());
    return std::move(*wire);
  }
  auto terminal = PseudoTerminal::open(clock, link);
  if (!terminal) return fail(terminal.error());
  return std::move(*terminal);
}

}  // namespace

Result<std::unique_ptr<TerminalRig>> TerminalRig::open(RealClock& clock, Experiment experiment,
                                                       const RigSettings& settings,
                                                       const std::string& scanner_link,
                                                       const std::string& tilt_link) {
  auto scanner = scannerWire(clock, settings, scanner_link);
  if (!scanner) return fail(scanner.error());
  auto tilt = PseudoTerminal::open(clock, tilt_link);
  if (!tilt) return fail(tilt.error());
  return std::unique_ptr<TerminalRig>(new TerminalRig(clock, std::move(experiment), settings,
                                                      std::move(*scanner), std::move(*tilt), scanner_link,
                                                      tilt_link));
}

TerminalRig::TerminalRig(RealClock& clock, Experiment experiment, const RigSettings& settings,
                         std::unique_ptr<DeviceWire> scanner, std::unique_ptr<DeviceWire> tilt,
                         std::string scanner_link, std::string tilt_link)
    : clock_(clock),
      scanner_link_(std::move(scanner_link)),
      tilt_link_(std::move(tilt_link)),
      scanner_(std::move(scanner)),
      tilt_(std::move(tilt)),
      rig_(clock, std::move(experiment), settings, *scanner_, *tilt_),
      thread_(clock, {{&rig_.scanner(), scanner_.get()}, {&rig_.tilt(), tilt_.get()}}) {}

int TerminalRig::stop() {
  return thread_.locked([&] { return rig_.stop(); });
}

Status TerminalRig::moveTo(int stop) {
  return thread_.locked([&] { return rig_.moveTo(stop); });
}

Status TerminalRig::replug(std::unique_ptr<DeviceWire>& terminal, const std::string& link, bool scanner) {
  if (dynamic_cast<TcpWire*>(terminal.get()))
    return thread_.locked([&]() -> Status {
      terminal->hangUp();
      return {};
    });
  // The new one first, so that it cannot get the name of the old one. Closing takes the link away.
  auto fresh = PseudoTerminal::open(clock_);
  if (!fresh) return fail(fresh.error());
  return thread_.locked([&]() -> Status {
    terminal->close();
    if (!link.empty()) {
      // Once more, with the link; the one without it has kept the old name from being given out again.
      auto linked = PseudoTerminal::open(clock_, link);
      if (!linked) return fail(linked.error());
      fresh = std::move(linked);
    }
    if (scanner)
      rig_.scanner().plug(fresh->get());
    else
      rig_.tilt().rewire(**fresh);
    thread_.setWire(scanner ? 0 : 1, fresh->get());
    terminal = std::move(*fresh);
    return {};
  });
}

Status TerminalRig::fault(const std::string& text) {
  if (text == "unplug-scanner") return replug(scanner_, scanner_link_, true);
  if (text == "unplug-tilt") return replug(tilt_, tilt_link_, false);
  return thread_.locked([&] { return rig_.fault(text); });
}

std::vector<std::string> TerminalRig::faultNames() const {
  std::vector<std::string> names = rig_.faultNames();
  names.insert(names.end(), {"unplug-scanner", "unplug-tilt"});
  return names;
}

}  // namespace tiltmap
