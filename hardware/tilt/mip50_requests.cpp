// One request at a time: what is sent to a MIP 50, what it answers, and what is done when it does not.
#include <algorithm>
#include <array>
#include <utility>

#include "core/base/text.h"
#include "hardware/tilt/mip50_unit.h"

namespace tiltmap {

namespace {

// How long a controller that is still busy, or a line that is out of step, is left alone.
constexpr double kPause = 0.05;
constexpr double kQuiet = 0.15;
// Refusals by their numbers (mip50_table.h): the sender's fault on a bad line, and "not yet".
constexpr std::array<int, 4> kGarbled{171, 172, 173, 174};
constexpr std::array<int, 2> kNotYet{177, 178};

bool among(std::span<const int> numbers, int number) {
  return std::ranges::find(numbers, number) != numbers.end();
}

}  // namespace

Mip50Unit::Request Mip50Unit::request(Mip50Verb verb, double value) const {
  return {{verb, axis_, value, 0}, table_.answer_s, -1};
}
Mip50Unit::Request Mip50Unit::positionRequest() const {
  return {{Mip50Verb::ReadPosition, axis_, 0.0, 0}, table_.answer_s, table_.position_number};
}
Mip50Unit::Request Mip50Unit::moveRequest(std::int64_t from, std::int64_t to) const {
  const double duration = drive_.moveDuration(static_cast<double>(to - from));
  return {{Mip50Verb::MoveAbsolute, axis_, static_cast<double>(to), 0},
          table_.move_factor * duration + table_.move_extra_s,
          -1};
}

std::string Mip50Unit::troubleOf(int number, const std::map<int, std::string>& texts) const {
  const auto found = texts.find(number);
  return found == texts.end() ? "number " + std::to_string(number)
                              : found->second + " (number " + std::to_string(number) + ")";
}

Error Mip50Unit::silent() const {
  return {"the tilt controller does not answer", name_,
          "check its power, the cable (one crossing of wires 2 and 3) and its rate (" +
              std::to_string(channel_->line().baud) +
              " Bd now; 19200 as delivered); then go on with the capture"};
}

Status Mip50Unit::lost(Error error) {
  phase_ = Phase::Lost;
  ready_ = false;
  sent_ = false;
  script_.clear();
  return fail(std::move(error));
}

Status Mip50Unit::send() {
  std::string text = encodeCommand(table_, script_.front().command);
  if (text.empty())
    return lost({"the table of the tilt controller lacks a command that is needed", name_,
                 "complete the table; tiltmap's own has all of them"});
  // In the text menu a carriage return is an emergency stop.
  if (mode_known_) text += table_.command_end;
  value_.reset();
  answers_.clear();
  sent_ = true;
  deadline_ = clock_.now() + channel_->line().wireTime(text.size()) + durationOf(script_.front().limit_s);
  if (Status status = channel_->write({reinterpret_cast<const Byte*>(text.data()), text.size()}); !status)
    return lost(status.error());
  noteSent(text);
  return {};
}

Status Mip50Unit::take() {
  std::array<Byte, 256> buffer;
  while (true) {
    const auto count = channel_->read(buffer, clock_.now());
    if (!count) return lost(count.error());
    if (*count == 0) return {};
    std::vector<Mip50Answer> found;
    reader_.take({reinterpret_cast<const char*>(buffer.data()), *count}, found);
    for (Mip50Answer& answer : found) {
      // Whatever it was in the middle of: a controller that starts anew does not know where it stands.
      if (const auto* banner = std::get_if<Mip50Banner>(&answer); banner && ready_)
        return lost({banner->entered
                         ? "the tilt controller has been switched off and on and no longer knows its position"
                         : "the tilt controller has left its command mode",
                     name_, "check its supply; going on with the capture searches home again"});
      answers_.push_back(std::move(answer));
    }
  }
}

void Mip50Unit::next() {
  if (script_.front().command.verb == Mip50Verb::MoveAbsolute) ended_ = clock_.now();
  if (value_) last_value_ = *value_;
  if (tries_ > 0) {
    // An answer to an earlier try may still come and must not be taken for the next one's.
    irregular_ = true;
    quiet_until_ = clock_.now() + durationOf(kQuiet);
  }
  tries_ = 0;
  sent_ = false;
  script_.pop_front();
}

Status Mip50Unit::refused(const Mip50Refusal& refusal) {
  sent_ = false;
  irregular_ = true;
  if (among(kNotYet, refusal.number) && clock_.now() < move_deadline_) {
    quiet_until_ = clock_.now() + durationOf(kPause);
    return {};
  }
  const std::string trouble = troubleOf(refusal.number, table_.refusals);
  if (among(kGarbled, refusal.number) && ++tries_ <= table_.repeats) {
    quiet_until_ = clock_.now() + durationOf(kPause);
    return {};
  }
  if (among(kGarbled, refusal.number))
    return lost({"the tilt controller does not understand what it is sent: " + trouble, name_,
                 "check the cable and the controller's table of commands"});
  return lost({"the tilt controller refuses to move: " + trouble, name_,
               "see that Enable is on, nothing presses a limit switch or STOP and nothing blocks the tilt; "
               "going on with the capture clears the error and searches home again"});
}

Result<bool> Mip50Unit::answered(const Mip50Answer& answer) {
  const Request& current = script_.front();
  if (std::holds_alternative<Mip50Done>(answer)) {
    const bool complete = current.value_number != table_.position_number || value_;
    if (!complete) irregular_ = true;  // of an earlier request
    return complete;
  }
  if (const auto* value = std::get_if<Mip50Value>(&answer)) {
    if (value->number == current.value_number && value->values.size() >= 2 && value->values.front() == axis_)
      value_ = value->values.back();
    return false;
  }
  if (const auto* refusal = std::get_if<Mip50Refusal>(&answer)) {
    if (Status status = refused(*refusal); !status) return fail(status.error());
    return false;
  }
  if (std::holds_alternative<Mip50Noise>(answer)) irregular_ = true;
  return false;
}

// A move whose acknowledge did not come may well have been made: the position that is read next tells.
Status Mip50Unit::overdue() {
  irregular_ = true;
  if (script_.front().command.verb == Mip50Verb::MoveAbsolute) {
    next();
    return {};
  }
  if (++tries_ > table_.repeats) return lost(silent());
  sent_ = false;
  quiet_until_ = clock_.now() + durationOf(kPause);
  return {};
}

// True when the script is through; false while it waits.
Result<bool> Mip50Unit::advance() {
  while (true) {
    if (Status status = take(); !status) return fail(status.error());
    if (clock_.now() < quiet_until_) {
      answers_.clear();
      return false;
    }
    if (script_.empty()) return true;
    if (!sent_) {
      if (Status status = send(); !status) return fail(status.error());
    }
    if (answers_.empty()) {
      if (clock_.now() < deadline_) return false;
      if (Status status = overdue(); !status) return fail(status.error());
      continue;
    }
    const Mip50Answer answer = std::move(answers_.front());
    answers_.pop_front();
    const auto done = answered(answer);
    if (!done) return fail(done.error());
    if (*done) next();
  }
}

Status Mip50Unit::runScript(const JobControl* job) {
  while (true) {
    const auto through = advance();
    if (!through) return fail(through.error());
    if (*through) return {};
    if (job && job->stopRequested()) {
      // What has been sent is still going to be answered; prepare() begins with a clean slate.
      script_.clear();
      sent_ = false;
      return fail(kCancelled, name_, "start it again");
    }
    clock_.sleepFor(durationOf(0.002));
  }
}

}  // namespace tiltmap
