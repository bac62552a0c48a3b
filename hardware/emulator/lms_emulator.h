// An LMS 2xx seen from the wire: everything that the telegram listing says it does, at the time it says.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "hardware/emulator/emulated_instrument.h"
#include "hardware/emulator/site_view.h"
#include "hardware/lms2xx/framer.h"
#include "hardware/lms2xx/unit_state.h"

namespace tiltmap {

struct LmsEmulatorSettings {
  std::string type = "LMS291;S05;V02.30 ";
  std::string version = "V02.30";
  Byte address = 0;
  std::string password = std::string(lms2xx::kFactoryPassword);
  lms2xx::Configuration configuration = lms2xx::Configuration::factory();
  int baud = 9600;          // at the first power-on; afterwards 9600 unless it was made permanent
  bool keeps_rate = false;  // made permanent by somebody
  bool booted = true;       // else it is switched on now
  double boot_s = 5.0;      // at most 60 on a real one
  double acknowledge_low_s = 0.002, acknowledge_high_s = 0.006;  // at most 60 ms
  double answer_s = 0.060;     // from request to answer, as logged from a real LMS 200
  double configure_s = 0.417;  // a written configuration, as logged
  double host_gap_s = 0.006;   // a longer gap inside a request makes it forget the request
  double turn_s = 0.01332;     // of the mirror
  // Whether a single request gives a scan that begins after it, or the next one to be complete (which may
  // have begun before): the listing does not say, so the less convenient one.
  bool fresh_on_request = false;
  std::uint64_t seed = 1;  // of faults, and of the acknowledge's delay
};

// What goes wrong. Probabilities are for each byte sent, counts are used up.
struct LmsFaults {
  double lose_byte = 0.0;
  double flip_bit = 0.0;
  double duplicate_byte = 0.0;
  double insert_byte = 0.0;
  double split = 0.0;  // a pause of split_s behind a byte
  double split_s = 0.005;
  double merge_s = 0.0;      // bytes come in heaps, this far apart, as from some adapters
  int lose_acknowledge = 0;  // so many of the next requests are answered without one
  int refuse_checksum = 0;   // so many are answered by 15
  int miss_request = 0;      // so many are not heard at all
  int late_answers = 0;      // so many come late_s later
  double late_s = 2.0;
  int cut_telegrams = 0;  // so many scans end after 100 bytes
  bool refuse_configuration = false;
  bool refuse_variant = false;
  bool dirty_window = false;
  bool dazzled = false;  // no value, code 1FFE
  bool silent = false;   // does not hear and does not speak, for ever
};

class LmsEmulator : public EmulatedScanner {
 public:
  // What was sent, for comparison with what a driver made of it.
  struct SentScan {
    Instant measured_from{}, measured_to{};
    Instant first_byte{};
    lms2xx::Measurement measurement;
    std::vector<Echo> echoes;
  };
  using TiltAt = std::function<double(Instant)>;

  // Nothing is owned; the view and the wire must outlive it (the wire until another one is given).
  LmsEmulator(const Clock& clock, SiteView& view, LmsEmulatorSettings settings = {});

  // The wire it is plugged into; nullptr: none.
  void plug(DeviceWire* wire) override;
  // Radians at an instant that has passed; level where there is none.
  void setTilt(TiltAt tilt) override { tilt_ = std::move(tilt); }
  void onScan(std::function<void(const SentScan&)> heard) { on_scan_ = std::move(heard); }

  Instant nextEvent() const override;
  void act(Instant now) override;

  LmsFaults& faults() { return faults_; }
  // "lose-byte=0.001", "dirty-window", "power-cut=2": what `fault` on a control line says; "none" ends all.
  Status applyFault(const std::string& text) override;
  static std::vector<std::string> faultNames();
  std::vector<std::string> knownFaults() const override { return faultNames(); }

  // Off now; on again after `off`, then booting, at 9600 or the permanent rate.
  void cutPower(Duration off);

  // As if another program had changed it; nobody is told.
  void setBaud(int baud) { baud_ = baud; }

  int baud() const { return baud_; }
  Byte mode() const { return mode_; }
  const lms2xx::Variant& variant() const { return variant_; }
  const lms2xx::Configuration& configuration() const { return settings_.configuration; }
  int configurationWrites() const { return configuration_writes_; }
  bool on() const { return power_ == Power::On; }
  // When the scan that is being measured at `at` ends.
  Instant scanEnd(Instant at, int turns) const;

 private:
  enum class Power { Off, Booting, On };
  struct Outgoing {
    Instant start{};
    std::function<ByteVector(Instant)> make;  // what to send, asked at its start
    std::function<void()> then;               // after its last byte
    ByteVector bytes;
    std::size_t sent = 0;
    bool begun = false;
  };

  void powerOn(Instant now);
  void listen(Instant now);
  void hear(std::span<const Byte> bytes, Instant now);
  void handle(const lms2xx::Telegram& request, Instant now);
  void handleMode(std::span<const Byte> data, Instant now);
  void handleMeasure(const lms2xx::Telegram& request, Instant now);
  void handleVariant(std::span<const Byte> data, Instant now);
  void handleConfiguration(std::span<const Byte> data, Instant now);
  void answer(Byte command, const ByteVector& data, Instant now, std::function<void()> then = {});
  void refuse(Instant now) { answer(lms2xx::command::kRefused, {}, now); }
  void answerMode(Byte result, Instant now, std::function<void()> then = {});
  void queueBytes(Instant start, ByteVector bytes);
  // Before an answer; returns when it has left the wire.
  Instant acknowledge(Instant now);
  void queueScan(Instant not_before, const lms2xx::Measurement& shape, int turns);
  void queueStream(Instant now);
  void transmit(Instant now);
  Instant transmitDue() const;
  void emit(Byte byte, Outgoing& outgoing);
  void flush();
  void deliver(std::span<const Byte> bytes);
  bool streaming() const;
  Byte statusByte() const;
  lms2xx::UnitStatus status() const;
  lms2xx::Measurement shapeOf(Byte mode) const;
  ByteVector measure(lms2xx::Measurement shape, int turns, Instant end);
  bool isS14() const;

  const Clock& clock_;
  SiteView& view_;
  LmsEmulatorSettings settings_;
  LmsFaults faults_;
  DeviceWire* wire_ = nullptr;
  TiltAt tilt_;
  std::function<void(const SentScan&)> on_scan_;
  RandomStream random_;

  Power power_ = Power::Off;
  Instant power_event_ = kNever;  // switched on, or booted
  Instant mirror_start_{};        // a turn began here
  int baud_ = 9600;
  Byte mode_ = lms2xx::mode::kOnRequest;
  ByteVector mode_data_;
  lms2xx::Variant variant_;
  bool installation_ = false;
  int configuration_writes_ = 0;
  std::uint64_t scans_ = 0;
  Byte telegram_index_ = 0;

  lms2xx::Framer framer_{lms2xx::Sender::Host};
  Instant last_heard_{};
  std::deque<Outgoing> out_;
  ByteVector burst_;
  ByteVector held_;  // by merge_s
  Instant held_until_ = kNever;
};

}  // namespace tiltmap
