// What emulated scanners of newer makes have in common: a mirror that measures all beams in one turn, a
// stream of telegrams, power, and what goes wrong on the wire.
#pragma once

#include <deque>
#include <functional>
#include <map>

#include "core/base/random.h"
#include "hardware/emulator/emulated_instrument.h"
#include "hardware/emulator/site_view.h"

namespace tiltmap {

struct LineScannerTiming {
  double turn_s = 0.02;
  double boot_s = 10.0;
  bool booted = true;        // else it is switched on now
  double answer_s = 0.01;    // from a request to the answer's first byte
  double process_s = 0.003;  // from the last beam of a line to its telegram's first byte
  double bytes_per_s = 1e7;  // of the wire
  std::uint64_t seed = 1;    // of faults
};

// Probabilities are for each byte sent, counts are used up.
struct LineScannerFaults {
  double lose_byte = 0.0, flip_bit = 0.0, duplicate_byte = 0.0, insert_byte = 0.0;
  double split = 0.0;  // a pause of split_s behind a piece
  double split_s = 0.03;
  double merge_s = 0.0;   // bytes come in heaps, this far apart
  int noise = 0;          // before so many of the next telegrams stands something that is none
  int cut_telegrams = 0;  // so many end in the middle
  int late_answers = 0;   // so many come late_s later
  double late_s = 3.0;
  int miss_requests = 0;
  bool refuse_configuration = false;
  bool dirty_window = false;
  bool dazzled = false;
  bool silent = false;
};

class LineScannerEmulator : public EmulatedScanner {
 public:
  // A line as it was measured.
  struct SentLine {
    Instant from{}, to{};
    std::vector<Echo> echoes;
  };

  void plug(DeviceWire* wire) override;
  void setTilt(std::function<double(Instant)> tilt) override { tilt_ = std::move(tilt); }
  Status applyFault(const std::string& text) override;
  std::vector<std::string> knownFaults() const override;
  Instant nextEvent() const override;
  void act(Instant now) override;

  LineScannerFaults& faults() { return faults_; }
  void onLine(std::function<void(const SentLine&)> heard) { on_line_ = std::move(heard); }
  // Off now; on again after `off`, then booting.
  void cutPower(Duration off);
  bool on() const { return power_ == Power::On; }

 protected:
  // Nothing is owned; clock and view must outlive it.
  LineScannerEmulator(const Clock& clock, SiteView& view, LineScannerTiming timing);

  virtual void hear(std::span<const Byte> bytes, Instant now) = 0;
  // Another client, or no power: what was ordered is over.
  virtual void forgetOrders() = 0;
  virtual void forgetSettings() = 0;  // no power
  virtual bool streaming() const = 0;
  // The telegram of a line that is to be sent at `now`; empty for none.
  virtual ByteVector lineTelegram(const SentLine& line, Instant now) = 0;
  virtual const ScannerGeometry& geometry() const = 0;
  // Bytes that arrive at another rate than this are not understood; 0: any.
  virtual int baud() const { return 0; }
  // Whether single bytes may be lost and garbled; not so in a network.
  virtual bool garbles() const { return true; }

  void answer(ByteVector bytes, Instant now);
  // The turn that ended last.
  SentLine measure(Instant end);
  Instant lastTurnEnd(Instant now) const;
  Instant poweredOn() const { return mirror_start_; }
  void setTurn(double turn_s) { timing_.turn_s = turn_s; }
  void setWire(double bytes_per_s) { timing_.bytes_per_s = bytes_per_s; }
  void hangUp();
  const LineScannerTiming& timing() const { return timing_; }
  DeviceWire* wire() const { return wire_; }

 private:
  enum class Power { Off, Booting, On };
  struct Piece {
    Instant at;
    ByteVector bytes;
  };
  void powerOn(Instant now);
  void listen(Instant now);
  void queue(ByteVector bytes, Instant start);
  void garble(ByteVector& bytes);
  void deliver(Instant now);

  const Clock& clock_;
  SiteView& view_;
  LineScannerTiming timing_;
  LineScannerFaults faults_;
  RandomStream random_;
  DeviceWire* wire_ = nullptr;
  int client_ = 0;
  std::function<double(Instant)> tilt_;
  std::function<void(const SentLine&)> on_line_;
  Power power_ = Power::Off;
  Instant power_event_ = kNever;
  Instant mirror_start_{};
  Instant next_turn_ = kNever;  // its end, while it streams
  std::uint64_t lines_ = 0;
  std::deque<Piece> out_;
  Instant wire_free_{};
  ByteVector held_;
  Instant held_until_ = kNever;
};

}  // namespace tiltmap
