// An LMS 2xx as capture wants it: streaming, and telling when a line has begun to arrive.
#pragma once

#include <functional>
#include <memory>

#include "hardware/capture/scanner_unit.h"
#include "hardware/lms2xx/lms_scanner.h"

namespace tiltmap {

// The driver finds the scanner and sets it up; while it streams the bytes are looked at here as they come,
// without waiting.
//
// A streaming scanner sends the scan that was completed last, so that the turns of its mirror that were
// measured end where the telegram begins. When that was is told from the bytes: n bytes that are here began
// to come n byte times ago or earlier. The best guess of all portions of a telegram counts, and
// LmsSettings::latency_s is what an adapter may hold all of them back.
class LmsScannerUnit : public ScannerUnit {
 public:
  using Opener = LmsScanner::Opener;
  LmsScannerUnit(Opener opener, Clock& clock, LmsSettings settings);
  ~LmsScannerUnit() override;

  const std::string& name() const override { return name_; }
  Status prepare(const JobControl& job) override;
  int columns() const override { return geometry_.columns; }
  double azimuthStart() const override { return geometry_.azimuth_start_rad; }
  double azimuthStep() const override { return geometry_.azimuth_step_rad; }
  double lineDuration() const override;
  double turnDuration() const override;
  double linePeriod() const override { return scanner_.streamPeriod(); }
  Result<std::optional<ScannerEvent>> poll() override;
  Status release() override;
  std::vector<std::string> takeWarnings() override;
  std::vector<InstrumentFact> facts() const override;

 private:
  Status receive();
  LineTimes timesOf(std::size_t bytes_here);
  Duration mostDelay() const;
  bool hasRhythm() const;
  Result<std::optional<ScannerEvent>> whole(const lms2xx::Telegram& telegram);
  std::optional<ScannerEvent> beginning();
  void forgetBeginning();
  ScannerEvent spoiled(const char* why);

  Clock& clock_;
  LmsSettings settings_;
  std::shared_ptr<ByteChannel> channel_;  // shared with the driver, which is idle while a stream runs
  LmsScanner scanner_;
  std::string name_ = "LMS 2xx";
  ScannerGeometry geometry_;
  lms2xx::Framer framer_;
  std::size_t telegram_size_ = 0;
  bool streaming_ = false;
  bool told_ = false;  // the telegram under way has been announced
  Instant last_byte_{};
  Instant began_ = kNever;       // by its own bytes: best guess for the telegram under way
  std::vector<Instant> recent_;  // the same of the telegrams before
  std::size_t bad_then_ = 0, dropped_ = 0;
  std::optional<ScannerEvent> held_;  // follows the one that was just told
  std::vector<std::string> warnings_;
  std::optional<lms2xx::StatusByte> latest_status_;  // of the last line
};

}  // namespace tiltmap
