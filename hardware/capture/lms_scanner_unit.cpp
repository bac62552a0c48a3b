#include "hardware/capture/lms_scanner_unit.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/text.h"

namespace tiltmap {

using namespace lms2xx;

namespace {

constexpr double kTurnS = 0.01332;
// The listing allows 14 ms between bytes; behind USB they come in heaps.
constexpr double kByteGapS = 0.06;
// Telegrams whose beginnings are remembered: long enough ago, and the mirror may have drifted.
constexpr std::size_t kRecent = 8;
// Before so many have come nobody can tell whether one was held back on its way, by an adapter or by a
// machine that was busy: they set the rhythm and are not told. More where they come so quickly that an
// adapter's usual delay (16 ms) could pass for some of them.
constexpr std::size_t kRhythm = 2;
constexpr Duration kUsualDelay = std::chrono::milliseconds(20);
// So many parts of a period the best guess of a whole telegram may be late by, and the rhythm still be
// counted right; the first bytes of the one under way may be late by the rest of it.
constexpr int kLateParts = 4;
constexpr Byte kScanAnswer = 0xB0;

// One channel for two owners.
class SharedChannel : public ByteChannel {
 public:
  explicit SharedChannel(std::shared_ptr<ByteChannel> channel) : channel_(std::move(channel)) {}
  Result<std::size_t> read(std::span<Byte> buffer, Instant deadline) override {
    return channel_->read(buffer, deadline);
  }
  Status write(std::span<const Byte> bytes) override { return channel_->write(bytes); }
  Status setLine(const LineSettings& line) override { return channel_->setLine(line); }
  LineSettings line() const override { return channel_->line(); }
  Status discardInput() override { return channel_->discardInput(); }
  ChannelState state() const override { return channel_->state(); }
  void close() override { channel_->close(); }
  const std::string& name() const override { return channel_->name(); }

 private:
  std::shared_ptr<ByteChannel> channel_;
};

}  // namespace

LmsScannerUnit::LmsScannerUnit(Opener opener, Clock& clock, LmsSettings settings)
    : clock_(clock),
      settings_(settings),
      scanner_(
          [this, opener = std::move(opener)]() -> Result<std::unique_ptr<ByteChannel>> {
            channel_.reset();
            auto opened = opener();
            if (!opened) return fail(opened.error());
            channel_ = std::move(*opened);
            return std::make_unique<SharedChannel>(channel_);
          },
          clock, settings) {}

LmsScannerUnit::~LmsScannerUnit() = default;

Status LmsScannerUnit::prepare(const JobControl& job) {
  if (streaming_) return {};
  job.tell(-1.0, "looking for the scanner");
  auto report = scanner_.connect(job.stop);
  if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
  if (!report) return fail(report.error());
  name_ = report->type.text + " at " + report->port;
  warnings_.insert(warnings_.end(), report->warnings.begin(), report->warnings.end());
  if (report->configuration.plausible() && report->configuration.measuringMode() == MeasuringMode::Energy)
    return fail("the scanner is set to send energies instead of distances", name_,
                "set its measuring mode to 0");
  latest_status_.reset();
  geometry_ = scanner_.geometry();
  const bool indices = report->configuration.plausible() && report->configuration.sendsIndices();
  telegram_size_ = scanWireSize(scanner_.variant().values(), indices);
  if (Status status = scanner_.startStream(LmsStream::Scans, job.stop); !status) return status;
  streaming_ = true;
  framer_.clear();
  held_.reset();
  recent_.clear();
  told_ = false;
  began_ = kNever;
  last_byte_ = clock_.now();
  return {};
}

double LmsScannerUnit::turnDuration() const {
  return kTurnS;
}
double LmsScannerUnit::lineDuration() const {
  return kTurnS * scanner_.variant().turns();
}

Status LmsScannerUnit::receive() {
  std::array<Byte, 1024> buffer;
  while (true) {
    const auto count = channel_->read(buffer, clock_.now());
    if (!count) {
      streaming_ = false;
      return fail(count.error());
    }
    if (*count == 0) return {};
    // After a pause nobody knows whether what comes was measured now or lay somewhere meanwhile.
    if (clock_.now() - last_byte_ > mostDelay()) recent_.clear();
    last_byte_ = clock_.now();
    framer_.push(std::span(buffer).first(*count));
  }
}

LineTimes LmsScannerUnit::timesOf(std::size_t bytes_here) {
  const Duration scan = durationOf(kTurnS * scanner_.variant().turns());
  const Duration period = durationOf(scanner_.streamPeriod());
  began_ = std::min(began_, last_byte_ - channel_->line().wireTime(bytes_here));
  // Telegrams that come sooner one after the other than they can have been measured lay somewhere meanwhile:
  // the rhythm has to be found anew, and until then no line is believed.
  const Duration measured = period * static_cast<Duration::rep>(recent_.size());
  if (!recent_.empty() && began_ - recent_.front() < measured - mostDelay()) recent_.clear();
  // Telegrams begin in an even rhythm: what earlier ones tell of it holds for this one, whose own first bytes
  // may have been held back by an adapter or by a machine that was busy.
  Instant began = began_;
  for (const Instant earlier : recent_) {
    const auto periods = (began_ - earlier + period / kLateParts) / period;
    began = std::min(began, earlier + periods * period);
  }
  return {began - scan - durationOf(settings_.latency_s), began};
}

// What is late by less is put right by the rhythm.
Duration LmsScannerUnit::mostDelay() const {
  const Duration period = durationOf(scanner_.streamPeriod());
  return std::max(period - period / kLateParts, kUsualDelay);
}

bool LmsScannerUnit::hasRhythm() const {
  return recent_.size() >= kRhythm &&
         durationOf(scanner_.streamPeriod()) * static_cast<Duration::rep>(recent_.size()) >= 2 * kUsualDelay;
}

// When the bytes that seemed to begin a telegram turn out to begin none, neither did it begin then.
void LmsScannerUnit::forgetBeginning() {
  const Framer::Counts& counts = framer_.counts();
  const std::size_t dropped = counts.noise + counts.bad_checksum + counts.cut;
  if (std::exchange(dropped_, dropped) != dropped) began_ = kNever;
}

ScannerEvent LmsScannerUnit::spoiled(const char* why) {
  told_ = false;
  began_ = kNever;
  return LineSpoiled{why};
}

Result<std::optional<ScannerEvent>> LmsScannerUnit::whole(const Telegram& telegram) {
  if (telegram.command() == command::kPowerOn) {
    streaming_ = false;
    return fail("the scanner was switched on just now: its power was interrupted", name_,
                "look at its supply");
  }
  if (telegram.command() != kScanAnswer) return std::nullopt;  // late, of an earlier request
  const LineTimes times = timesOf(telegram.wireSize());
  const bool announced = std::exchange(told_, false);
  const bool in_rhythm = hasRhythm();
  recent_.push_back(began_);
  if (recent_.size() > kRecent) recent_.erase(recent_.begin());
  began_ = kNever;
  if (!in_rhythm) return std::nullopt;
  auto measurement = parseMeasurement(telegram);
  if (!measurement || static_cast<int>(measurement->values.size()) != geometry_.columns)
    return ScannerEvent(LineSpoiled{"it is no scan of the kind that was asked for"});
  LmsLine line;
  line.raw = std::move(*measurement);
  line.variant = scanner_.variant();
  line.status.raw = line.raw.status;
  if (scanner_.report().configuration.plausible())
    line.measuring_mode = scanner_.report().configuration.measuringMode();
  if (Status status = fillCells(line); !status) return fail(status.error());
  latest_status_ = line.status;
  for (std::string& warning : warningsOf(line.status))
    if (std::ranges::find(warnings_, warning) == warnings_.end()) warnings_.push_back(std::move(warning));
  LineTaken taken{times, std::move(line.range_m), std::move(line.code), std::move(line.intensity)};
  if (announced) return ScannerEvent(std::move(taken));
  // It came in one heap: its beginning is told first all the same.
  held_ = std::move(taken);
  return ScannerEvent(LineBegun{times});
}

// The first bytes of a telegram that looks like a scan of the size it should have.
std::optional<ScannerEvent> LmsScannerUnit::beginning() {
  const auto start = framer_.start();
  // Every byte tells when it began, the first one best of all: a pause may follow it.
  const LineTimes times = timesOf(start.size());
  if (!hasRhythm()) return std::nullopt;
  if (start.size() < 5 || told_ || start[4] != kScanAnswer || word(start, 2) + kOverhead != telegram_size_)
    return std::nullopt;
  told_ = true;
  bad_then_ = framer_.counts().bad_checksum;
  return LineBegun{times};
}

Result<std::optional<ScannerEvent>> LmsScannerUnit::poll() {
  if (!streaming_) return fail("the scanner is not ready", name_, "prepare it first");
  if (held_) return std::exchange(held_, std::nullopt);
  if (Status status = receive(); !status) return fail(status.error());
  while (true) {
    const auto token = framer_.next();
    forgetBeginning();
    if (!token) break;
    const auto* telegram = std::get_if<Telegram>(&*token);
    if (!telegram) continue;
    auto event = whole(*telegram);
    if (!event || *event) return event;
  }
  if (told_ && framer_.counts().bad_checksum != bad_then_)
    return std::optional(spoiled("its checksum is wrong"));
  if (framer_.waiting() && clock_.now() - last_byte_ >= durationOf(kByteGapS)) {
    framer_.giveUpFirst();
    if (told_) return std::optional(spoiled("it was cut off"));
    began_ = kNever;
    return std::nullopt;
  }
  if (!framer_.waiting()) {
    began_ = kNever;
    return std::nullopt;
  }
  return beginning();
}

std::vector<InstrumentFact> LmsScannerUnit::facts() const {
  const LmsReport& report = scanner_.report();
  if (report.type.text.empty()) return {};
  const UnitStatus& status = report.status;
  // The window's sensors against the clean reference ones, which the unit itself judges.
  std::string dirt;
  for (const int value : status.pollution) {
    if (!dirt.empty()) dirt += ' ';
    dirt += std::to_string(value);
  }
  const bool dirty_then = std::ranges::any_of(
      report.warnings, [](const std::string& text) { return text.find("dirty") != std::string::npos; });
  // Each line says how the unit is by now.
  const bool dirty = latest_status_ ? latest_status_->polluted() : dirty_then;
  constexpr int kError = 3;
  const bool failing = status.defective || (latest_status_ && latest_status_->severity() >= kError);
  return {{"type", report.type.text},
          {"firmware", status.version},
          {"rate", std::to_string(report.baud) + " Bd"},
          {"field of view", std::to_string(status.variant.angle_deg) + "\u00b0 by " +
                                fixedReal(status.variant.resolution_cdeg / 100.0, 2) + "\u00b0"},
          {"window", (dirty ? "dirty, wipe it (" : "clean (") + dirt + ")", dirty},
          {"condition", failing ? "reports a defect" : "no defect reported", failing}};
}

Status LmsScannerUnit::release() {
  if (!std::exchange(streaming_, false)) return {};
  return scanner_.stopStream();
}

std::vector<std::string> LmsScannerUnit::takeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace tiltmap
