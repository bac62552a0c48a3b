// How an EPOS is found, switched on and sent home; what can be asked of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/base/text.h"
#include "hardware/tilt/cia402.h"
#include "hardware/tilt/epos_unit.h"

namespace tiltmap {

namespace cia402 {

std::string hexWord(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "%04X", static_cast<unsigned>(value));
  return text;
}

// Error codes of CiA 402 (object 603F) that a tilt meets.
std::string errorText(std::uint32_t code) {
  const auto named = [&]() -> const char* {
    switch (code) {
      case 0x2310:
        return "over-current";
      case 0x3210:
        return "over-voltage";
      case 0x3220:
        return "under-voltage";
      case 0x4210:
        return "over-temperature";
      case 0x7320:
        return "position sensor";
      case 0x8611:
        return "following error: the motor cannot do what it is told";
      case 0x8A80:
        return "negative limit switch";
      case 0x8A81:
        return "positive limit switch";
      case 0x8A82:
        return "software position limit";
      default:
        return nullptr;
    }
  }();
  return named ? std::string(named) + " (" + hexWord(code) + ")" : "error " + hexWord(code);
}

}  // namespace cia402

using namespace cia402;

namespace {

constexpr double kEnableS = 2.0;  // until the power stage is on, or an error cleared
constexpr double kPauseS = 0.05;

}  // namespace

Status EposUnit::set(std::uint16_t index, Byte sub, std::int64_t value, const JobControl& job) {
  return ask(writing(index, sub, value), &job).map([](auto) {});
}

// At which rate, in which protocol? A question in the wrong one is not understood and soon forgotten.
Status EposUnit::find(const JobControl& job) {
  std::vector<EposProtocol> protocols{EposProtocol::V1, EposProtocol::V2, EposProtocol::V2Usb};
  if (settings_.protocol) protocols = {*settings_.protocol};
  for (int round = 0; round < 2; ++round) {
    for (const int baud : settings_.bauds) {
      if (Status status = channel_->setLine({baud, Parity::None}); !status) return status;
      for (const EposProtocol protocol : protocols) {
        link_.setProtocol(protocol);
        link_.setPatience(round == 0 ? 1 : 2, 0.25);
        const auto answer = ask(reading(kStatus), &job);
        link_.setPatience(4, 0.3);
        if (answer) return {};
        if (answer.error().what == kCancelled || channel_->state() != ChannelState::Open)
          return fail(answer.error());
        // What was begun in the wrong way is forgotten before the next try.
        clock_.sleepFor(durationOf(1.1 * epos::kForgetsS));
      }
    }
  }
  std::vector<std::string> tried;
  for (const int baud : settings_.bauds) tried.push_back(std::to_string(baud));
  return fail("the tilt controller does not answer", name_,
              "tried " + joined(tried, ", ") + " Bd" +
                  (settings_.protocol ? " with protocol " + eposProtocolName(*settings_.protocol) : "") +
                  ": check its power, the cable (one crossing of wires 2 and 3) and its node (" +
                  std::to_string(settings_.node) + "); then go on with the capture");
}

Status EposUnit::clearFault(const JobControl& job) {
  auto status = ask(reading(kStatus), &job);
  if (!status) return fail(status.error());
  if (!faulty(*status)) return {};
  const auto code = ask(reading(kErrorCode), &job);
  if (!code) return fail(code.error());
  warnings_.push_back("the tilt controller had stored an error: " + errorText(*code) +
                      "; it has been cleared");
  // The reset is a rising edge.
  for (const std::uint32_t word : {0U, kReset, 0U})
    if (Status written = set(kControl, 0, word, job); !written) return written;
  const Instant end = clock_.now() + durationOf(kEnableS);
  while (clock_.now() < end) {
    status = ask(reading(kStatus), &job);
    if (!status) return fail(status.error());
    if (!faulty(*status)) return {};
    clock_.sleepFor(durationOf(kPauseS));
  }
  return fail("the tilt controller keeps its error: " + errorText(*code), name_,
              "see that nothing blocks the tilt and that motor, encoder and supply are connected");
}

Status EposUnit::enable(const JobControl& job) {
  for (const std::uint32_t word : {kShutdown, kSwitchOn, kEnable})
    if (Status written = set(kControl, 0, word, job); !written) return written;
  const Instant end = clock_.now() + durationOf(kEnableS);
  std::uint32_t seen = 0;
  while (clock_.now() < end) {
    const auto status = ask(reading(kStatus), &job);
    if (!status) return fail(status.error());
    if (enabled(*status)) return {};
    seen = *status;
    clock_.sleepFor(durationOf(kPauseS));
  }
  return fail("the tilt controller does not switch its motor on (status " + hexWord(seen) + ")", name_,
              "see that its Enable input and its supply are on");
}

Status EposUnit::home(const JobControl& job) {
  job.tell(-1.0, "the tilt searches its home position");
  const double search = rpm(settings_.home_speed);
  const auto acceleration = static_cast<std::int64_t>(rpm(drive_.acceleration * 1000.0));
  for (const auto& [index, sub, value] : std::initializer_list<std::tuple<std::uint16_t, int, std::int64_t>>{
           {kMode, 0, 6},
           {kHomeMethod, 0, settings_.home_method},
           {kHomeOffset, 0, 0},
           {kHomeSpeeds, 1, static_cast<std::int64_t>(search)},
           {kHomeSpeeds, 2, std::max<std::int64_t>(1, static_cast<std::int64_t>(0.1 * search))},
           {kHomeRamp, 0, acceleration},
           {kControl, 0, kEnable},
           {kControl, 0, kStartHoming}})
    if (Status written = set(index, static_cast<Byte>(sub), value, job); !written) return written;
  const Instant end = clock_.now() + durationOf(settings_.home_limit_s);
  while (true) {
    const auto status = ask(reading(kStatus), &job);
    if (!status) {
      // Nothing may go on moving while nobody looks.
      if (status.error().what == kCancelled) (void)ask(writing(kControl, 0, kHalt), nullptr);
      return fail(status.error());
    }
    if (faulty(*status) || (*status & kFollowing) || !enabled(*status))
      return fail("the search for home failed (status " + hexWord(*status) + ")", name_,
                  "check the home switch, the homing method (" + std::to_string(settings_.home_method) +
                      ") and that nothing blocks the tilt");
    if ((*status & kTaken) && (*status & kReached)) break;
    if (clock_.now() > end)
      return fail(
          "the search for home does not end", name_,
          "check the home switch and the homing method (" + std::to_string(settings_.home_method) + ")");
    clock_.sleepFor(durationOf(0.02));
  }
  for (const auto& [index, value] : {std::pair{kControl, kEnable}, std::pair{kMode, std::uint32_t{1}}})
    if (Status written = set(index, 0, value, job); !written) return written;
  return {};
}

Status EposUnit::setProfile(const JobControl& job) {
  const auto acceleration = static_cast<std::int64_t>(rpm(drive_.acceleration * 1000.0));
  speed_told_ = rpm(drive_.speed);
  for (const auto& [index, value] :
       {std::pair{kSpeed, static_cast<std::int64_t>(rpm(drive_.speed))}, std::pair{kSpeedUp, acceleration},
        std::pair{kSlowDown, acceleration}, std::pair{kProfileType, std::int64_t{0}}})
    if (Status written = set(index, 0, value, job); !written) return written;
  const auto mode = ask(reading(kModeShown), &job);
  if (!mode) return fail(mode.error());
  if ((*mode & 0xFF) != 1)
    return fail("the tilt controller does not go to profile positions", name_,
                "its mode is " + std::to_string(*mode & 0xFF) + "; see whether another master uses it");
  return {};
}

Status EposUnit::prepare(const JobControl& job) {
  if (ready_) return {};
  const auto run = [&]() -> Status {
    steps_.clear();
    waiting_until_.reset();
    fault_.reset();
    link_.reset();
    job.tell(-1.0, "looking for the tilt controller");
    if (Status status = find(job); !status) return status;
    name_ = "EPOS (" + eposProtocolName(link_.protocol()) + ") at " + channel_->name();
    if (Status status = clearFault(job); !status) return status;
    if (Status status = enable(job); !status) return status;
    if (Status status = home(job); !status) return status;
    if (Status status = setProfile(job); !status) return status;
    const auto position = ask(reading(kPosition), &job);
    if (!position) return fail(position.error());
    position_ = static_cast<std::int32_t>(*position);
    return {};
  };
  if (Status status = run(); !status) return lost(status.error());
  if (std::abs(drive_.angleOf(position_) - drive_.angleOf(0)) > drive_.tolerance_rad)
    return lost({"the search for home ended at count " + std::to_string(position_) + " instead of 0", name_,
                 "check the homing method and the controller's home position"});
  (void)link_.takeIrregular();
  irregular_ = false;
  attempts_ = 0;
  steady_known_ = false;
  phase_ = Phase::Still;
  ready_ = true;
  reading_ = {drive_.angleOf(position_), position_, clock_.now() + durationOf(drive_.settle_s)};
  return {};
}

Result<EposUnit::Identity> EposUnit::identify(const JobControl& job) {
  if (Status status = find(job); !status) return fail(status.error());
  Identity identity{link_.protocol(), channel_->line().baud, 0, 0, 0};
  const auto status = ask(reading(kStatus), &job);
  if (!status) return fail(status.error());
  identity.status = *status;
  const auto error = ask(reading(kErrorCode), &job);
  if (!error) return fail(error.error());
  identity.error = *error;
  const auto position = ask(reading(kPosition), &job);
  if (!position) return fail(position.error());
  identity.position = static_cast<std::int32_t>(*position);
  return identity;
}

}  // namespace tiltmap
