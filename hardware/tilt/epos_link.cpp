#include "hardware/tilt/epos_link.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace tiltmap {

namespace {

// A V2 unit forgets nothing, but an answer may be on its way still.
constexpr double kQuietV2S = 0.15;

}  // namespace

void EposLink::setProtocol(EposProtocol protocol) {
  protocol_ = protocol;
  stream_ = EposStreamReader(protocol);
  reset();
}

void EposLink::setPatience(int tries, double answer_s) {
  most_tries_ = tries;
  answer_s_ = answer_s;
}

void EposLink::reset() {
  step_ = Step::Idle;
  stream_.clear();
}

void EposLink::begin(const EposRequest& request) {
  if (busy()) throw std::logic_error("EposLink::begin: another request is under way");
  request_ = request;
  frame_ = encodeEpos(protocol_, eposFrame(protocol_, request));
  tries_ = 0;
  // Sent by the next poll(), so that failing has one place.
  step_ = Step::Quiet;
  deadline_ = std::max(clock_.now(), clear_);
}

Status EposLink::send(std::span<const Byte> bytes, Step next, double limit_s) {
  step_ = next;
  if (next == Step::Taken || next == Step::Answer)
    sent_at_ = clock_.now() + channel_.line().wireTime(bytes.size());
  deadline_ = clock_.now() + channel_.line().wireTime(bytes.size()) + durationOf(limit_s);
  return channel_.write(bytes);
}

Status EposLink::start() {
  if (Status status = channel_.discardInput(); !status) return status;
  stream_.clear();
  ++tries_;
  if (protocol_ == EposProtocol::V1) return send(std::span(frame_).first(1), Step::Ready, answer_s_);
  return send(frame_, Step::Answer, answer_s_ + secondsOf(channel_.line().wireTime(24)));
}

Status EposLink::again() {
  irregular_ = true;
  if (tries_ >= most_tries_) {
    step_ = Step::Idle;
    return fail("", "", "");
  }
  step_ = Step::Quiet;
  deadline_ = clock_.now() + durationOf(protocol_ == EposProtocol::V1 ? 1.1 * epos::kForgetsS : kQuietV2S);
  return {};
}

std::optional<EposAnswer> EposLink::understood(const EposFrame& frame) const {
  auto answer = eposAnswer(frame);
  if (!answer || answer->error == epos::kBadChecksum) return std::nullopt;
  // What was read has a value, unless it was refused; what was written has none.
  if (request_.write ? answer->value.has_value() : !answer->value && answer->error == 0) return std::nullopt;
  return answer;
}

Result<std::optional<EposAnswer>> EposLink::heard(Byte byte) {
  using None = std::optional<EposAnswer>;
  const auto next = [](Status status) -> Result<None> {
    if (!status) return fail(status.error());
    return None{};
  };
  const double body_s = secondsOf(channel_.line().wireTime(12)) + answer_s_;
  switch (step_) {
    case Step::Ready:
      if (byte != epos::kReady) return next(again());
      return next(send(std::span(frame_).subspan(1), Step::Taken, answer_s_));
    case Step::Taken:
      if (byte != epos::kReady) return next(again());
      step_ = Step::Coming;
      deadline_ = clock_.now() + durationOf(answer_s_);
      return None{};
    case Step::Coming: {
      if (byte != epos::kAnswer) return next(again());
      body_.begin(byte);
      const Byte go_on = epos::kReady;
      return next(send({&go_on, 1}, Step::Body, body_s));
    }
    case Step::Body: {
      const auto state = body_.push(byte);
      if (state == EposBodyReader::State::Unfinished) return None{};
      const auto answer = state == EposBodyReader::State::Whole ? understood(body_.frame()) : None{};
      const Byte verdict = answer ? epos::kReady : epos::kRefused;
      if (Status status = channel_.write({&verdict, 1}); !status) return fail(status.error());
      if (!answer) return next(again());
      step_ = Step::Idle;
      return answer;
    }
    case Step::Answer: {
      std::vector<EposStreamReader::Item> items;
      stream_.push({&byte, 1}, items);
      for (const auto& item : items) {
        const auto* frame = std::get_if<EposFrame>(&item);
        if (!frame) return next(again());
        const auto answer = understood(*frame);
        if (!answer) return next(again());
        step_ = Step::Idle;
        return answer;
      }
      return None{};
    }
    case Step::Idle:
    case Step::Quiet:
      break;
  }
  return None{};
}

Result<std::optional<EposAnswer>> EposLink::poll() {
  while (true) {
    if (step_ == Step::Idle) return std::nullopt;
    if (step_ == Step::Quiet) {
      if (clock_.now() < deadline_) return std::nullopt;
      if (Status status = start(); !status) return fail(status.error());
    }
    Byte byte = 0;
    const auto count = channel_.read({&byte, 1}, clock_.now());
    if (!count) return fail(count.error());
    if (*count == 0) {
      if (clock_.now() < deadline_) return std::nullopt;
      if (Status status = again(); !status) return fail(status.error());
      continue;
    }
    auto answer = heard(byte);
    // The answer to an earlier try may still come and must not be taken for the next request's.
    if (answer && *answer && tries_ > 1) clear_ = clock_.now() + durationOf(kQuietV2S);
    if (!answer || *answer) return answer;
  }
}

}  // namespace tiltmap
