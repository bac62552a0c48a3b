#include "hardware/tilt/mip50_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/base/text.h"
#include "core/geometry/pose.h"

namespace tiltmap {

namespace {

constexpr double kPause = 0.05;  // before a position is read once more
constexpr int kAttempts = 3;     // to bring the tilt where it should stand

}  // namespace

Mip50Unit::Mip50Unit(std::unique_ptr<ByteChannel> channel, Clock& clock, TiltDrive drive, Mip50Table table,
                     int axis)
    : channel_(std::move(channel)),
      clock_(clock),
      drive_(drive),
      table_(std::move(table)),
      axis_(axis),
      name_("MIP 50 at " + channel_->name()),
      reader_(table_) {
  if (Status status = drive_.check(); !status)
    throw std::invalid_argument("Mip50Unit: " + status.error().what);
}

Mip50Unit::~Mip50Unit() = default;

// Sends raw bytes and waits half a second for an answer (for the banner where that is asked for).
Result<bool> Mip50Unit::probe(const JobControl& job, std::string_view bytes, bool banner) {
  answers_.clear();
  if (Status status = channel_->write({reinterpret_cast<const Byte*>(bytes.data()), bytes.size()}); !status)
    return fail(status.error());
  const Instant end = clock_.now() + durationOf(0.5);
  while (clock_.now() < end) {
    if (job.stopRequested()) return fail(kCancelled, name_, "start it again");
    clock_.sleepFor(durationOf(0.002));
    if (Status status = take(); !status) return fail(status.error());
    for (const Mip50Answer& answer : answers_) {
      if (banner && std::holds_alternative<Mip50Banner>(answer)) return true;
      if (!banner &&
          (std::holds_alternative<Mip50Value>(answer) || std::holds_alternative<Mip50Refusal>(answer)))
        return true;
    }
  }
  return false;
}

Status Mip50Unit::findAsciiMode(const JobControl& job) {
  mode_known_ = false;
  const std::string question = encodeCommand(table_, positionRequest().command);
  for (int i = 0; i <= table_.repeats; ++i) {
    auto found = probe(job, question, false);
    if (!found) return fail(found.error());
    if (*found) {
      mode_known_ = true;
      return {};
    }
    if (table_.enter_ascii.empty()) continue;
    // Perhaps it stands in its text menu.
    if (auto entered = probe(job, table_.enter_ascii, true); !entered) return fail(entered.error());
  }
  return lost(silent());
}

Status Mip50Unit::home(const JobControl& job) {
  job.tell(-1.0, "the tilt searches its home position");
  Request search = request(Mip50Verb::Home);
  search.limit_s = table_.home_limit_s;
  move_deadline_ = clock_.now() + durationOf(table_.home_limit_s);
  script_ = {search, positionRequest()};
  if (Status status = runScript(&job); !status) return status;
  position_ = last_value_;
  const double off =
      std::abs(static_cast<double>(position_) * 2.0 * std::numbers::pi / drive_.counts_per_turn);
  if (off > drive_.tolerance_rad)
    return lost({"the search for home ended at count " + std::to_string(position_) + " instead of 0", name_,
                 "check the home switch and the controller's parameters 30 to 33 and 38"});
  return {};
}

Status Mip50Unit::prepare(const JobControl& job) {
  if (ready_) return {};
  reader_.clear();
  answers_.clear();
  script_.clear();
  sent_ = false;
  tries_ = 0;
  quiet_until_ = {};
  if (Status status = channel_->discardInput(); !status) return status;
  job.tell(-1.0, "looking for the tilt controller");
  if (Status status = findAsciiMode(job); !status) return status;
  clock_.sleepFor(durationOf(kPause));
  // A move or a search for home that a killed program began may still be going on.
  move_deadline_ = clock_.now() + durationOf(table_.home_limit_s);
  Request clear = request(Mip50Verb::ClearError);
  clear.value_number = table_.error_number;
  last_value_ = 0;
  script_ = {request(Mip50Verb::RegulationOff), clear};
  if (Status status = runScript(&job); !status) return status;
  if (last_value_ != 0)
    warnings_.push_back("the tilt controller had stored an error: " +
                        troubleOf(static_cast<int>(last_value_), table_.errors) + "; it has been cleared");
  script_ = {request(Mip50Verb::Ramp, drive_.acceleration), request(Mip50Verb::Speed, drive_.speed),
             request(Mip50Verb::RegulationOn)};
  if (Status status = runScript(&job); !status) return status;
  if (Status status = home(job); !status) return status;
  irregular_ = false;
  attempts_ = 0;
  steady_.reset();
  reading_ = {drive_.angleOf(position_), position_, clock_.now() + durationOf(drive_.settle_s)};
  phase_ = Phase::Still;
  ready_ = true;
  return {};
}

Status Mip50Unit::checkAngle(double angle_rad) const {
  return withinLimits(angle_rad, drive_.minimum_rad, drive_.maximum_rad, name_, "with the tilt's address");
}

Status Mip50Unit::plan() {
  std::int64_t from = position_;
  double longest_s = 0.0;
  for (const std::int64_t station : segmentsOf(drive_, position_, target_)) {
    script_.push_back(moveRequest(from, station));
    longest_s += script_.back().limit_s;
    from = station;
  }
  script_.push_back(positionRequest());
  move_deadline_ = clock_.now() + durationOf(longest_s);
  phase_ = Phase::Moving;
  ended_ = clock_.now();
  return {};
}

Status Mip50Unit::moveTo(double angle_rad) {
  if (!ready_) return fail("the tilt is not ready to move", name_, "prepare it first");
  if (Status status = checkAngle(angle_rad); !status) return status;
  target_ = drive_.countsOf(angle_rad);
  attempts_ = 0;
  only_reading_ = false;
  irregular_ = false;
  steady_.reset();
  if (phase_ == Phase::Still) {
    if (Status status = plan(); !status) return status;
  } else {
    // After a stop: what was under way ends first, and then it is seen where that was.
    if (!script_.empty()) script_.erase(script_.begin() + (sent_ ? 1 : 0), script_.end());
    if (phase_ == Phase::Gliding) script_.push_back(request(Mip50Verb::Speed, drive_.speed));
    script_.push_back(positionRequest());
    phase_ = Phase::Reading;
  }
  return poll().map([](const auto&) {});
}

// The position has been read: is it the target? True when the tilt stands there for good.
Result<bool> Mip50Unit::arrived() {
  const std::int64_t before = position_;
  position_ = last_value_;
  if (phase_ == Phase::Reading && std::exchange(only_reading_, false)) {
    reading_ = {drive_.angleOf(position_), position_, clock_.now() + durationOf(drive_.settle_s)};
    phase_ = Phase::Still;
    return true;
  }
  if (phase_ == Phase::Reading) return plan().map([] { return false; });
  const double off = std::abs(drive_.angleOf(position_) - drive_.angleOf(target_));
  if (phase_ == Phase::Gliding && !irregular_ && off <= drive_.tolerance_rad) settleSteady();
  const bool again = phase_ == Phase::Checking;
  const bool same = again && std::abs(position_ - before) <= 2;
  if (off <= drive_.tolerance_rad) {
    if (!irregular_ || same) {
      reading_ = {drive_.angleOf(position_), position_,
                  (irregular_ ? clock_.now() : ended_) + durationOf(drive_.settle_s)};
      phase_ = Phase::Still;
      return true;
    }
  } else if (same || !irregular_) {
    // It stands, but elsewhere.
    if (++attempts_ > kAttempts)
      return fail(lost({"the tilt does not reach " + angleText(drive_.angleOf(target_)) + ": it stands at " +
                            angleText(drive_.angleOf(position_)),
                        name_,
                        "see whether something blocks it and whether the motor has its supply; "
                        "going on with the capture searches home again"})
                      .error());
    irregular_ = true;  // from now on look twice
    return plan().map([] { return false; });
  } else if (again && clock_.now() > move_deadline_ + durationOf(table_.move_extra_s)) {
    return fail(lost({"the tilt does not come to rest", name_,
                      "see whether something blocks it; going on with the capture searches home again"})
                    .error());
  }
  phase_ = Phase::Checking;
  quiet_until_ = clock_.now() + durationOf(kPause);
  script_.push_back(positionRequest());
  return false;
}

Result<std::optional<TiltReading>> Mip50Unit::poll() {
  if (phase_ == Phase::Lost)
    return fail("the tilt has to be prepared again", name_, "go on with the capture, which does it");
  while (true) {
    const auto through = advance();
    if (!through) return fail(through.error());
    if (!*through) return std::nullopt;
    if (phase_ == Phase::Idle) return std::nullopt;
    if (phase_ == Phase::Still) return reading_;
    const auto there = arrived();
    if (!there) return fail(there.error());
  }
}

void Mip50Unit::stop() {
  if (phase_ == Phase::Lost) return;
  if (phase_ == Phase::Gliding && sent_) {
    // Whether it works shows when the unit is prepared again.
    const std::string& text = table_.interrupt;
    (void)channel_->write({reinterpret_cast<const Byte*>(text.data()), text.size()});
    mode_known_ = false;
    (void)lost({});
    return;
  }
  if (!script_.empty()) script_.erase(script_.begin() + (sent_ ? 1 : 0), script_.end());
  if (phase_ != Phase::Still) phase_ = Phase::Idle;
}

Status Mip50Unit::findWhereItStands() {
  if (!ready_ || phase_ != Phase::Idle) return {};
  irregular_ = false;
  script_.push_back(positionRequest());
  only_reading_ = true;
  phase_ = Phase::Reading;
  return poll().map([](const auto&) {});
}

Status Mip50Unit::identify(const JobControl& job) {
  if (ready_) return {};
  reader_.clear();
  answers_.clear();
  script_.clear();
  sent_ = false;
  if (Status status = channel_->discardInput(); !status) return status;
  return findAsciiMode(job);
}

std::vector<InstrumentFact> Mip50Unit::facts() const {
  return {{"rate", std::to_string(channel_->line().baud) + " Bd"},
          {"regulation", ready_ ? "on, home found" : "off"}};
}

Status Mip50Unit::release() {
  if (!ready_) return {};
  if (phase_ != Phase::Gliding) stop();  // a steady move is let come to its end: stopping it costs the home
  move_deadline_ = clock_.now() + durationOf(table_.move_extra_s);
  script_.push_back(request(Mip50Verb::RegulationOff));
  ready_ = false;
  phase_ = Phase::Idle;
  return runScript(nullptr);
}

Result<std::int64_t> Mip50Unit::readParameter(int number) {
  if (!mode_known_) return fail("the tilt is not ready", name_, "prepare it first");
  Request read = request(Mip50Verb::ReadParameter);
  read.command.parameter = number;
  read.value_number = table_.parameter_number;
  last_value_ = 0;
  script_.push_back(read);
  if (Status status = runScript(nullptr); !status) return fail(status.error());
  return last_value_;
}

std::vector<std::string> Mip50Unit::takeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace tiltmap
