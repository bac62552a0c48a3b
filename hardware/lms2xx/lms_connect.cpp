// How the driver finds an LMS 2xx and sets it up.
#include <algorithm>
#include <stdexcept>

#include "core/base/text.h"
#include "hardware/lms2xx/lms_scanner.h"

namespace tiltmap {

using namespace lms2xx;
using namespace std::chrono_literals;

namespace {

constexpr int kRounds = 2;
// Both sides change over; working drivers wait a quarter to half a second.
constexpr Duration kRateChange = 250ms;

std::vector<int> searchOrder(int last, int wished) {
  std::vector<int> order;
  for (const int baud : {last, wished, 38400, 9600, 19200, 500000})
    if (baud > 0 && std::ranges::find(order, baud) == order.end()) order.push_back(baud);
  return order;
}

}  // namespace

Result<bool> LmsScanner::answersAt(int baud, const std::stop_token& stop) {
  if (const auto set = channel_->setLine({baud}); !set) {
    // An adapter that cannot do 500000 Bd is no reason to give up the other rates.
    if (channel_->state() == ChannelState::Open) return false;
    return lost(set.error());
  }
  // A unit that streams already shows itself without being asked. Its telegram takes its time.
  const auto heard = engine_->listen(60ms + (channel_->line().wireTime(16)), stop);
  if (!heard) return lost(heard.error());
  for (int i = 0; i < 2; ++i) {
    if (const auto sent = channel_->write(request::onRequest().encoded()); !sent) return lost(sent.error());
    clock_.sleepFor(channel_->line().wireTime(8) + 30ms);
  }
  if (const auto drained = engine_->drain(100ms, 1500ms, stop); !drained) return lost(drained.error());
  const auto reply = engine_->ask(request::status(), {1s, *heard ? 4 : 2}, stop);
  if (reply.outcome == Engine::Outcome::ChannelFailed) return failed(reply);
  if (reply.outcome == Engine::Outcome::Stopped) return failed(reply);
  return reply.answered();
}

Result<int> LmsScanner::search(const std::stop_token& stop) {
  const auto order = searchOrder(last_baud_, settings_.baud);
  for (int round = 0; round < kRounds; ++round)
    for (const int baud : order) {
      const auto found = answersAt(baud, stop);
      if (!found) return fail(found.error());
      if (*found) return baud;
    }
  std::vector<std::string> tried;
  for (const int baud : order) tried.push_back(std::to_string(baud));
  return fail(
      "no LMS 2xx answers; tried " + joined(tried, ", ") + " Bd, " + std::to_string(kRounds) + " times each",
      channel_->name(),
      "look at its power (it takes up to a minute to start); exactly one pair of wires may be crossed, so "
      "leave out a null-modem adapter behind the original cable; a unit set to RS-422 (500000 Bd) answers "
      "through an RS-422 adapter only, and there swap the two wires of a pair");
}

Result<LmsReport> LmsScanner::connect(const std::stop_token& stop) {
  disconnect();
  auto opened = opener_();
  if (!opened) return fail(opened.error());
  channel_ = std::move(*opened);
  engine_ = std::make_unique<Engine>(*channel_, clock_);
  report_ = {};
  report_.port = channel_->name();
  const auto found = search(stop);
  if (!found) {
    const Error error = found.error();
    disconnect();
    return fail(error);
  }
  report_.found_at_baud = report_.baud = last_baud_ = *found;
  state_ = LmsState::Ready;
  auto done = setUp(stop);
  if (!done) {
    const Error error = done.error();
    disconnect();
    return fail(error);
  }
  return done;
}

Result<LmsReport> LmsScanner::setUp(const std::stop_token& stop) {
  if (const auto quiet = monitoring(stop); !quiet) return fail(quiet.error());
  const auto type = ask(request::type(), {}, stop);
  if (!type) return fail(type.error());
  report_.type = parseType(type->telegram.data());
  if (!report_.type.model.starts_with("LMS2"))
    report_.warnings.push_back("it calls itself `" + report_.type.text +
                               "`, which is no LMS 2xx we know; going on");
  if (!settings_.as_found && settings_.baud != report_.baud)
    if (const auto changed = setBaud(settings_.baud, stop); !changed) {
      if (state_ == LmsState::Lost) return fail(changed.error());
      report_.warnings.push_back(changed.error().what + "; staying at " + std::to_string(report_.baud) +
                                 " Bd");
    }
  auto now = status(stop);
  if (!now) return fail(now.error());
  report_.status = *now;
  auto configuration = readConfiguration(stop);
  if (!configuration) return fail(configuration.error());
  report_.configuration = *configuration;
  if (settings_.as_found) return report_;
  if (const auto applied = applyConfiguration(stop); !applied) return fail(applied.error());
  const Variant wished = report_.type.sendsReflectivity() ? Variant{90, 50} : settings_.variant;
  if (report_.status.variant != wished)
    if (const auto set = setVariant(wished, stop); !set) return fail(set.error());
  if (report_.status.defective) {
    const auto errors = storedErrors(stop);
    report_.warnings.push_back("the scanner calls itself defective" +
                               (errors ? ", with " + std::to_string(errors->size()) + " stored errors" : ""));
  }
  return report_;
}

Status LmsScanner::applyConfiguration(const std::stop_token& stop) {
  if (!settings_.unit && !settings_.indices && !settings_.measuring_mode) return {};
  const auto written = configure(
      [this](Configuration& configuration) {
        if (settings_.unit) configuration.setUnit(*settings_.unit);
        if (settings_.indices) configuration.setSendsIndices(*settings_.indices);
        if (settings_.measuring_mode) configuration.setMeasuringMode(*settings_.measuring_mode);
      },
      stop);
  if (!written) return fail(written.error());
  if (*written)
    report_.warnings.emplace_back("the scanner's configuration was changed and stored in it, as asked");
  return {};
}

Result<LmsReport> LmsScanner::recover(double patience_s, const std::stop_token& stop) {
  const Instant end = clock_.now() + durationOf(patience_s);
  Duration pause = 1s;
  for (;;) {
    auto connected = connect(stop);
    if (connected || stop.stop_requested() || clock_.now() + pause > end) return connected;
    // Not at once and not for ever the same: a unit that boots is not helped by a flood of requests.
    for (const Instant wake = clock_.now() + pause; clock_.now() < wake && !stop.stop_requested();)
      clock_.sleepUntil(std::min(wake, clock_.now() + Duration(50ms)));
    pause = std::min<Duration>(pause * 2, 10s);
  }
}

void LmsScanner::disconnect() {
  if (engine_ && channel_->state() == ChannelState::Open && state_ == LmsState::Streaming)
    (void)channel_->write(request::onRequest().encoded());  // a courtesy; it may be gone
  if (engine_) past_ = statistics();
  engine_.reset();
  if (channel_) channel_->close();
  channel_.reset();
  state_ = LmsState::Disconnected;
}

Status LmsScanner::setBaud(int baud, const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return quiet;
  const int before = report_.baud;
  if (baud == before) return {};
  if (std::ranges::find(kRates, baud) == kRates.end())
    return fail("an LMS 2xx knows no rate of " + std::to_string(baud) + " Bd", channel_->name(),
                "give 9600, 19200, 38400 or 500000");
  // Can this side do it? Asked before the scanner is out of reach.
  if (const auto possible = channel_->setLine({baud}); !possible) {
    if (channel_->state() != ChannelState::Open) return lost(possible.error());
    (void)channel_->setLine({before});
    return possible;
  }
  if (const auto back = channel_->setLine({before}); !back) return lost(back.error());
  if (const auto told = mode(request::setRate(baud), "the rate", stop); !told) return told;
  if (const auto set = channel_->setLine({baud}); !set) return lost(set.error());
  clock_.sleepFor(kRateChange);
  const auto reply = engine_->ask(request::status(), {1s, 3}, stop);
  if (reply.answered()) {
    report_.baud = last_baud_ = baud;
    return {};
  }
  if (reply.outcome == Engine::Outcome::ChannelFailed || reply.outcome == Engine::Outcome::Stopped)
    return failed(reply);
  // It heard us and left, but does not come through there: it is asked back, blindly and then by searching.
  (void)channel_->write(request::setRate(before).encoded());
  clock_.sleepFor(kRateChange);
  const auto found = search(stop);
  if (!found) return lost(found.error());
  report_.baud = last_baud_ = *found;
  return fail("the scanner does not come through at " + std::to_string(baud) + " Bd", channel_->name(),
              baud == 500000 ? "500000 Bd needs an RS-422 adapter that can do it; use 38400"
                             : "use a lower rate or a shorter cable");
}

Status LmsScanner::setVariant(const Variant& variant, const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return quiet;
  const auto reply = ask(request::setVariant(variant), {4s, 3}, stop);
  if (!reply) return fail(reply.error());
  const auto answer = parseVariantAnswer(reply->telegram);
  if (!answer) return fail(answer.error());
  report_.status.variant = answer->in_force;
  if (answer->accepted && answer->in_force == variant) return {};
  const auto text = [](const Variant& v) {
    return std::to_string(v.angle_deg) + " degrees by " + fixedReal(v.resolution_cdeg / 100.0, 2);
  };
  return fail("the scanner refuses " + text(variant) + " and stays at " + text(answer->in_force),
              channel_->name(),
              "there are 180 by 0.5 and 1, and 100 by 0.25, 0.5 and 1; types S14 know 90 by 0.5 only");
}

Result<bool> LmsScanner::configure(const std::function<void(Configuration&)>& change,
                                   const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return fail(quiet.error());
  auto before = readConfiguration(stop);
  if (!before) return fail(before.error());
  Configuration wished = *before;
  change(wished);
  if (wished.block().size() != before->block().size())
    throw std::logic_error("LmsScanner::configure: the length of the configuration was changed");
  report_.configuration = *before;
  if (wished == *before) return false;
  if (const auto in = mode(request::installationMode(settings_.password), "the installation mode", stop); !in)
    return fail(in.error());
  // Asked once: it may have been written although the answer was lost.
  const auto reply = engine_->ask(request::writeConfiguration(wished.block()), {15s, 1}, stop);
  if (reply.outcome == Engine::Outcome::ChannelFailed || reply.outcome == Engine::Outcome::Restarted)
    return failed(reply);
  // Back to measuring, whatever the answer was.
  if (const auto out = monitoring(stop); !out) return fail(out.error());
  auto now = readConfiguration(stop);
  if (!now) return fail(now.error());
  report_.configuration = *now;
  if (*now == wished) return true;
  bool refused = reply.outcome == Engine::Outcome::Refused;
  if (reply.answered()) {
    const auto answer = parseWriteAnswer(reply.arrival.telegram);
    refused = answer && !answer->accepted;
  }
  return fail(
      refused ? "the scanner refuses the configuration and keeps its own"
              : "the scanner's configuration is not what was written",
      channel_->name(),
      "measure with the configuration that it has, or set it with the maker's own program; nothing else was "
      "changed");
}

Status LmsScanner::setPermanentRate(bool keep_this, const std::stop_token& stop) {
  if (const auto quiet = ready(stop); !quiet) return quiet;
  if (const auto in = mode(request::installationMode(settings_.password), "the installation mode", stop); !in)
    return in;
  const auto reply = engine_->ask(request::permanentRate(keep_this), {4s, 1}, stop);
  if (reply.outcome == Engine::Outcome::ChannelFailed) return failed(reply);
  if (const auto out = monitoring(stop); !out) return out;
  // One or two bytes of data, by firmware; the first is the result.
  const auto data = reply.arrival.telegram.data();
  if (reply.answered() && !data.empty() && data[0] == 1) return {};
  return fail("the scanner does not take the rate at power-on", channel_->name(),
              "it is found by searching anyway");
}

}  // namespace tiltmap
