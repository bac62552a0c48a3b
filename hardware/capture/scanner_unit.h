// A planar scanner that keeps sending lines, as capture sees it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/scan/range_image.h"
#include "hardware/transport/clock.h"
#include "hardware/transport/instrument_fact.h"

namespace tiltmap {

// When the beams of a line were fired: from the first one to the last, on the scanner's clock, with what is
// not known about it on the late side of `from` and of `to`.
struct LineTimes {
  Instant from{}, to{};
  // How long before `to` the last turn of the mirror was over, as well as it is known: for lines taken while
  // the tilt moves, which need the likeliest instant and not a safe one.
  Duration spare{};

  Instant ended() const { return to - spare; }
};

// A line is on its way: it has been measured, and what moves now cannot spoil it any more.
struct LineBegun {
  LineTimes measured;
};
// All of it is here, and its checksum is right. As wide as columns().
struct LineTaken {
  LineTimes measured;  // may be known better than when it began
  std::vector<float> range_m;
  std::vector<CellCode> code;
  std::vector<float> intensity;  // empty where the scanner tells none
};
// What had begun came to nothing: cut off, or its checksum wrong.
struct LineSpoiled {
  std::string why;
};
using ScannerEvent = std::variant<LineBegun, LineTaken, LineSpoiled>;

// One thread. Failures are written for the operator; after one, prepare() begins anew and nothing that was
// set has to be set again.
class ScannerUnit {
 public:
  virtual ~ScannerUnit() = default;

  virtual const std::string& name() const = 0;
  // Finds the scanner, sets it up and lets it send lines. Returns at once when it sends already. Looks at the
  // stop token every 50 ms.
  virtual Status prepare(const JobControl& job) = 0;
  // Of the lines, known once prepared.
  virtual int columns() const = 0;
  virtual double azimuthStart() const = 0;
  virtual double azimuthStep() const = 0;
  // For lines taken while the tilt moves, known once prepared, seconds: the turns of the mirror that measure
  // one, a turn, and from one line that is sent to the next. 0: its beams cannot be told apart in time.
  virtual double lineDuration() const { return 0.0; }
  virtual double turnDuration() const { return 0.0; }
  virtual double linePeriod() const { return 0.0; }
  // Does what is due; the next thing that has happened, nothing while there is none. Never waits.
  virtual Result<std::optional<ScannerEvent>> poll() = 0;
  // No more lines.
  virtual Status release() = 0;
  // What the operator should know, once each.
  virtual std::vector<std::string> takeWarnings() { return {}; }
  // Identity and health: as it told them when it was prepared, and what its lines have told since.
  virtual std::vector<InstrumentFact> facts() const { return {}; }
};

}  // namespace tiltmap
