#include "hardware/tilt/manual_unit.h"

#include <mutex>
#include <stdexcept>

#include "core/base/text.h"
#include "core/geometry/pose.h"

namespace tiltmap {

namespace {

// What a hand leaves swinging.
constexpr double kSettleS = 1.0;
// How far a typed angle may be from the wanted one: more is a slip of the pen.
constexpr double kPlausibleRad = 5.0 * kDegree;

}  // namespace

struct ManualTiltUnit::Question {
  std::mutex mutex;
  std::optional<Result<std::string>> answer;
};

ManualTiltUnit::ManualTiltUnit(Clock& clock, AskOperator ask, double minimum_rad, double maximum_rad)
    : clock_(clock), ask_(std::move(ask)), minimum_rad_(minimum_rad), maximum_rad_(maximum_rad) {
  if (!ask_) throw std::invalid_argument("ManualTiltUnit: there is nobody to ask");
}

ManualTiltUnit::~ManualTiltUnit() {
  dismiss();
}

void ManualTiltUnit::dismiss() {
  asker_.request_stop();
  if (asker_.joinable()) asker_.join();
  question_.reset();
}

Status ManualTiltUnit::prepare(const JobControl&) {
  dismiss();
  reading_.reset();
  return {};
}

Status ManualTiltUnit::checkAngle(double angle_rad) const {
  return withinLimits(angle_rad, minimum_rad_, maximum_rad_, name_, "behind manual:");
}

Status ManualTiltUnit::moveTo(double angle_rad) {
  if (Status status = checkAngle(angle_rad); !status) return status;
  dismiss();
  reading_.reset();
  target_rad_ = angle_rad;
  auto question = std::make_shared<Question>();
  question_ = question;
  const std::string text =
      "set the tilt to " + angleText(angle_rad) + " and press Enter (or type the angle where it stands)";
  asker_ = std::jthread([question, text, ask = ask_](const std::stop_token& stop) {
    auto answer = ask(text, stop);
    const std::lock_guard lock(question->mutex);
    question->answer.emplace(std::move(answer));
  });
  return {};
}

Result<std::optional<TiltReading>> ManualTiltUnit::poll() {
  if (reading_) return reading_;
  if (!question_) return std::nullopt;
  Result<std::string> answer;
  {
    const std::lock_guard lock(question_->mutex);
    if (!question_->answer) return std::nullopt;
    answer = std::move(*question_->answer);
  }
  dismiss();
  if (!answer) return fail(answer.error());
  double angle = target_rad_;
  if (const std::string_view typed = trimmed(*answer); !typed.empty()) {
    const auto number = parseReal(typed);
    if (!number || !(std::abs(*number * kDegree - target_rad_) <= kPlausibleRad)) {
      // Asked again rather than stored wrong.
      if (Status status = moveTo(target_rad_); !status) return fail(status.error());
      return std::nullopt;
    }
    angle = *number * kDegree;
  }
  reading_ = TiltReading{angle, 0, clock_.now() + durationOf(kSettleS)};
  return reading_;
}

void ManualTiltUnit::stop() {
  dismiss();
}

}  // namespace tiltmap
