#include "hardware/tilt/epos_unit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/base/text.h"
#include "core/geometry/pose.h"
#include "hardware/tilt/cia402.h"

namespace tiltmap {

using namespace cia402;

namespace {

constexpr double kLookS = 0.002;  // between two looks at the status of a moving motor
constexpr double kTakenS = 0.5;   // until a set-point is acknowledged
constexpr double kHaltS = 0.1;    // what stop() may take
constexpr double kMoveFactor = 2.0, kMoveExtraS = 2.0;
constexpr double kPauseS = 0.05;
constexpr int kAttempts = 3;  // to bring the tilt where it should stand

}  // namespace

EposUnit::EposUnit(std::unique_ptr<ByteChannel> channel, Clock& clock, TiltDrive drive, EposSettings settings)
    : channel_(std::move(channel)),
      clock_(clock),
      drive_(drive),
      settings_(std::move(settings)),
      name_("EPOS at " + channel_->name()),
      link_(*channel_, clock) {
  if (Status status = drive_.check(); !status)
    throw std::invalid_argument("EposUnit: " + status.error().what);
  if (settings_.node < 1 || settings_.node > 127 || !(settings_.counts_per_motor_turn >= 1.0) ||
      !(settings_.home_speed > 0.0) || settings_.home_method < -4 || settings_.home_method > 35)
    throw std::invalid_argument("EposUnit: settings out of their ranges");
  if (settings_.bauds.empty()) settings_.bauds = {115200, 38400, 57600, 19200, 9600};
}

EposUnit::~EposUnit() = default;

// Down to whole revolutions a minute, so that the motor is never faster than the drive allows.
double EposUnit::rpm(double counts_per_ms) const {
  return std::max(1.0, std::floor(counts_per_ms * 60000.0 / settings_.counts_per_motor_turn));
}

EposRequest EposUnit::reading(std::uint16_t index, Byte sub) const {
  return {false, index, sub, 0, static_cast<Byte>(settings_.node)};
}
EposRequest EposUnit::writing(std::uint16_t index, Byte sub, std::int64_t value) const {
  return {true, index, sub, static_cast<std::uint32_t>(value), static_cast<Byte>(settings_.node)};
}

Error EposUnit::silent() const {
  return {"the tilt controller does not answer", name_,
          "check its power, the cable (one crossing of wires 2 and 3), its rate (" +
              std::to_string(channel_->line().baud) + " Bd now) and its node (" +
              std::to_string(settings_.node) + "); then go on with the capture"};
}

Status EposUnit::lost(Error error) {
  phase_ = Phase::Lost;
  ready_ = false;
  steps_.clear();
  waiting_until_.reset();
  fault_.reset();
  link_.reset();
  return fail(std::move(error));
}

Status EposUnit::troubled(const EposRequest& request, std::uint32_t abort) {
  return lost({"the tilt controller refuses object " + hexWord(request.index) + ": " + eposAbortText(abort),
               name_,
               "see that node, homing method and type of the controller are right; going on with the "
               "capture prepares it anew"});
}

// Waits for one answer.
Result<std::uint32_t> EposUnit::ask(const EposRequest& request, const JobControl* job) {
  link_.begin(request);
  std::optional<Instant> give_up;
  while (true) {
    auto answer = link_.poll();
    if (!answer) return fail(answer.error().what.empty() ? silent() : answer.error());
    const bool stopped = job && job->stopRequested();
    // Not in the middle of a handshake, if that can be helped.
    if (stopped && !give_up) give_up = clock_.now() + durationOf(kPauseS);
    if (stopped && (*answer || clock_.now() >= *give_up)) {
      link_.reset();
      return fail(kCancelled, name_, "start it again");
    }
    if (*answer) {
      if ((*answer)->error != 0) return fail(troubled(request, (*answer)->error).error());
      return (*answer)->value.value_or(0);
    }
    clock_.sleepFor(durationOf(0.001));
  }
}

Status EposUnit::checkAngle(double angle_rad) const {
  return withinLimits(angle_rad, drive_.minimum_rad, drive_.maximum_rad, name_, "with the tilt's address");
}

void EposUnit::plan() {
  using Kind = Step::Kind;
  // A steady move may have left another one.
  if (speed_told_ != rpm(drive_.speed)) {
    speed_told_ = rpm(drive_.speed);
    steps_.push_back({Kind::Write, writing(kSpeed, 0, static_cast<std::int64_t>(speed_told_))});
  }
  std::int64_t from = position_;
  double longest_s = 0.0;
  for (const std::int64_t station : segmentsOf(drive_, position_, target_)) {
    const double limit_s =
        kMoveFactor * drive_.moveDuration(static_cast<double>(station - from)) + kMoveExtraS;
    steps_.push_back({Kind::Write, writing(kTarget, 0, station)});
    steps_.push_back({Kind::Write, writing(kControl, 0, kStartMove)});
    steps_.push_back({Kind::AwaitTaken, reading(kStatus), kTakenS});
    // Without the falling edge the next set-point would be ignored.
    steps_.push_back({Kind::Write, writing(kControl, 0, kEnable)});
    steps_.push_back({Kind::AwaitReached, reading(kStatus), limit_s});
    longest_s += limit_s;
    from = station;
  }
  steps_.push_back({Kind::ReadPosition, reading(kPosition)});
  move_deadline_ = clock_.now() + durationOf(longest_s);
  phase_ = Phase::Moving;
  ended_ = clock_.now();
}

Status EposUnit::moveTo(double angle_rad) {
  if (!ready_) return fail("the tilt is not ready to move", name_, "prepare it first");
  if (Status status = checkAngle(angle_rad); !status) return status;
  target_ = drive_.countsOf(angle_rad);
  attempts_ = 0;
  only_reading_ = false;
  irregular_ = false;
  steady_known_ = false;
  if (phase_ == Phase::Still) {
    plan();
  } else {
    // After a stop: what is on the wire ends first, and then it is seen where that was.
    steps_.erase(steps_.begin() + (link_.busy() && !steps_.empty() ? 1 : 0), steps_.end());
    if (!steps_.empty()) steps_.front().kind = Step::Kind::Write;
    waiting_until_.reset();
    steps_.push_back({Step::Kind::ReadPosition, reading(kPosition)});
    phase_ = Phase::Reading;
  }
  return poll().map([](const auto&) {});
}

// What the status word says about the motion. True: the step is through.
Result<bool> EposUnit::watched(const Step& step, std::uint32_t status) {
  if (faulty(status)) {
    fault_ = "the tilt controller has switched its motor off";
    steps_ = {{Step::Kind::ReadError, reading(kErrorCode)}};
    waiting_until_.reset();
    return false;
  }
  if (!enabled(status))
    return fail(lost({"the tilt controller has been switched off and on, or disabled, and no longer knows "
                      "its position (status " +
                          hexWord(status) + ")",
                      name_, "check its supply and Enable; going on with the capture searches home again"})
                    .error());
  const bool taken = (status & kTaken) != 0;
  if (step.kind == Step::Kind::AwaitTaken ? taken : !taken && (status & kReached)) return true;
  if (!waiting_until_) waiting_until_ = clock_.now() + durationOf(step.limit_s);
  if (clock_.now() > *waiting_until_)
    return fail(
        lost({step.kind == Step::Kind::AwaitTaken ? "the tilt controller does not take a new position"
                                                  : "the tilt does not come to rest",
              name_, "see whether something blocks it; going on with the capture searches home again"})
            .error());
  look_again_ = clock_.now() + durationOf(kLookS);
  if (phase_ == Phase::Gliding && step.kind == Step::Kind::AwaitReached)
    steps_.push_front({Step::Kind::ReadOnTheWay, reading(kPosition)});
  return false;
}

Result<bool> EposUnit::completed(const Step& step, const EposAnswer& answer) {
  const std::uint32_t value = answer.value.value_or(0);
  switch (step.kind) {
    case Step::Kind::Write:
      return true;
    case Step::Kind::Begin:
      if (steady_) steady_->start = link_.sentAt();
      return true;
    case Step::Kind::ReadOnTheWay:
      on_the_way_.push_back({link_.sentAt(), static_cast<std::int32_t>(value)});
      return true;
    case Step::Kind::AwaitTaken:
    case Step::Kind::AwaitReached:
      return watched(step, value);
    case Step::Kind::ReadPosition:
      position_ = static_cast<std::int32_t>(value);
      return true;
    case Step::Kind::ReadError:
      return fail(lost({*fault_ + ": " + errorText(value), name_,
                        "see that nothing blocks the tilt and that its supply is strong enough; going on "
                        "with the capture clears the error and searches home again"})
                      .error());
  }
  return true;
}

// True when all steps are through; false while something is waited for.
Result<bool> EposUnit::advance() {
  while (!steps_.empty()) {
    if (!link_.busy()) {
      if (clock_.now() < look_again_) return false;
      link_.begin(steps_.front().request);
    }
    const auto answer = link_.poll();
    if (link_.takeIrregular()) irregular_ = true;
    if (!answer) return fail(lost(answer.error().what.empty() ? silent() : answer.error()).error());
    if (!*answer) return false;
    const Step step = steps_.front();
    if ((*answer)->error != 0) return fail(troubled(step.request, (*answer)->error).error());
    const auto through = completed(step, **answer);
    if (!through) return fail(through.error());
    if (!*through) continue;
    if (step.kind == Step::Kind::AwaitReached) ended_ = clock_.now();
    if (step.kind != Step::Kind::ReadOnTheWay) waiting_until_.reset();
    if (!steps_.empty()) steps_.pop_front();
  }
  return true;
}

// The position has been read: is it the target?
Status EposUnit::arrivedOrAgain(bool& there) {
  there = false;
  if (phase_ == Phase::Reading && std::exchange(only_reading_, false)) {
    reading_ = {drive_.angleOf(position_), position_, clock_.now() + durationOf(drive_.settle_s)};
    phase_ = Phase::Still;
    there = true;
    return {};
  }
  if (phase_ == Phase::Reading) {
    plan();
    return {};
  }
  const std::int64_t now_at = position_;
  const bool again = phase_ == Phase::Checking;
  const bool same = again && std::abs(now_at - reading_.counts) <= 2;
  const double off = std::abs(drive_.angleOf(now_at) - drive_.angleOf(target_));
  reading_.counts = now_at;
  if (phase_ == Phase::Gliding && !irregular_ && off <= drive_.tolerance_rad) settleSteady();
  if (off <= drive_.tolerance_rad && (!irregular_ || same)) {
    reading_ = {drive_.angleOf(now_at), now_at,
                (irregular_ ? clock_.now() : ended_) + durationOf(drive_.settle_s)};
    phase_ = Phase::Still;
    there = true;
    return {};
  }
  if (off > drive_.tolerance_rad && (same || !irregular_)) {
    // It stands, but elsewhere.
    if (++attempts_ > kAttempts)
      return lost({"the tilt does not reach " + angleText(drive_.angleOf(target_)) + ": it stands at " +
                       angleText(drive_.angleOf(now_at)),
                   name_,
                   "see whether something blocks it and whether the motor has its supply; "
                   "going on with the capture searches home again"});
    irregular_ = true;  // from now on look twice
    plan();
    return {};
  }
  if (again && clock_.now() > move_deadline_ + durationOf(kMoveExtraS))
    return lost({"the tilt does not come to rest", name_,
                 "see whether something blocks it; going on with the capture searches home again"});
  phase_ = Phase::Checking;
  look_again_ = clock_.now() + durationOf(kPauseS);
  steps_.push_back({Step::Kind::ReadPosition, reading(kPosition)});
  return {};
}

Status EposUnit::findWhereItStands() {
  if (!ready_ || phase_ != Phase::Idle) return {};
  irregular_ = false;
  waiting_until_.reset();
  steps_.push_back({Step::Kind::ReadPosition, reading(kPosition)});
  only_reading_ = true;
  phase_ = Phase::Reading;
  return poll().map([](const auto&) {});
}

std::vector<InstrumentFact> EposUnit::facts() const {
  return {{"protocol", eposProtocolName(link_.protocol())},
          {"rate", std::to_string(channel_->line().baud) + " Bd"}};
}

Result<std::optional<TiltReading>> EposUnit::poll() {
  if (phase_ == Phase::Lost)
    return fail("the tilt has to be prepared again", name_, "go on with the capture, which does it");
  while (true) {
    const auto through = advance();
    if (!through) return fail(through.error());
    if (!*through || phase_ == Phase::Idle) return std::nullopt;
    if (phase_ == Phase::Still) return reading_;
    bool there = false;
    if (Status status = arrivedOrAgain(there); !status) return fail(status.error());
    if (!there) continue;
  }
}

void EposUnit::stop() {
  if (phase_ == Phase::Lost || phase_ == Phase::Still || phase_ == Phase::Idle) return;
  phase_ = Phase::Idle;
  waiting_until_.reset();
  const Instant end = clock_.now() + durationOf(kHaltS);
  // What is on the wire ends first; then one word. Without an answer the motor ends its segment.
  steps_.erase(steps_.begin() + (link_.busy() && !steps_.empty() ? 1 : 0), steps_.end());
  if (!steps_.empty()) steps_.front().kind = Step::Kind::Write;
  steps_.push_back({Step::Kind::Write, writing(kControl, 0, kHalt)});
  while (clock_.now() < end) {
    const auto through = advance();
    if (!through || *through) break;
    clock_.sleepFor(durationOf(0.001));
  }
}

Status EposUnit::release() {
  if (!ready_) return {};
  stop();
  steps_.clear();
  link_.reset();
  ready_ = false;
  phase_ = Phase::Idle;
  if (const auto done = ask(writing(kControl, 0, kShutdown), nullptr); !done) return fail(done.error());
  return {};
}

std::vector<std::string> EposUnit::takeWarnings() {
  return std::exchange(warnings_, {});
}

}  // namespace tiltmap
