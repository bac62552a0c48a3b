#include "core/registration/registration_trace.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/base/text.h"
#include "support/room_scene.h"

namespace tiltmap {
namespace {

using test_support::almostEmptyScan;
using test_support::roomScene;
using test_support::sceneScan;

const Pose kTruth(rotationExp({0.01, -0.02, 0.06}), {0.20, 0.30, 0.05});

struct Room {
  Scan fixed = sceneScan(roomScene(), Pose(), 0.005, 1);
  Scan moving = sceneScan(roomScene(), kTruth, 0.005, 2);
};
const Room& room() {
  static const Room scans;
  return scans;
}
RegistrationSettings thesis() {
  return registrationParameters().presetSettings("thesis").value();
}
// Every result is doubted, so that cubes and all headings are tried.
RegistrationSettings doubting() {
  RegistrationSettings settings;
  settings.patch_near_m = 0.5;
  settings.retry_agreement = 0.999;
  return settings;
}
RegistrationTrace ended(const RegistrationSettings& settings, const Pose& start = Pose()) {
  auto trace = RegistrationTrace::begin(room().fixed, room().moving, start, settings);
  EXPECT_TRUE(trace.has_value());
  while (!trace->done()) trace->step();
  return std::move(*trace);
}

TEST(RegistrationTrace, StepsAreThoseOfTheRegistrationBitForBit) {
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis()}) {
    const RegistrationTrace trace = ended(settings);
    Registration alone(room().fixed, room().moving, Pose(), settings);
    ASSERT_GT(trace.steps().size(), 4U);
    Pose before;
    for (const TraceStepPtr& step : trace.steps()) {
      ASSERT_EQ(step->attempt, 0U);
      const StepReport report = alone.step();
      EXPECT_EQ(step->before, before);
      EXPECT_EQ(step->report.fixed_from_moving, report.fixed_from_moving);
      EXPECT_EQ(step->report.error_m2, report.error_m2);
      EXPECT_EQ(step->report.rejected, report.rejected);
      EXPECT_EQ(step->report.stop, report.stop);
      ASSERT_EQ(step->pairs.size(), alone.correspondences().size());
      for (std::size_t i = 0; i < step->pairs.size(); ++i) {
        EXPECT_EQ(step->pairs[i].fixed, alone.correspondences()[i].fixed);
        EXPECT_EQ(step->pairs[i].reason, alone.correspondences()[i].reason);
      }
      before = report.fixed_from_moving;
    }
    EXPECT_TRUE(alone.done());
    EXPECT_EQ(trace.result().fixed_from_moving, alone.fixedFromMoving());
  }
}

TEST(RegistrationTrace, EndsWhereRegisterPairDoes) {
  Pose turned = Pose::planar(0.3, -0.2, 0.4);
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis(), doubting()}) {
    for (const Pose& start : {Pose(), turned}) {
      const RegistrationTrace trace = ended(settings, start);
      const auto whole = registerPair(room().fixed, room().moving, start, settings);
      ASSERT_TRUE(whole.has_value());
      const PairResult stepped = trace.result();
      EXPECT_EQ(stepped.fixed_from_moving, whole->fixed_from_moving);
      EXPECT_EQ(stepped.start, whole->start);
      EXPECT_EQ(stepped.information, whole->information);
      EXPECT_EQ(stepped.rms_m, whole->rms_m);
      EXPECT_EQ(stepped.overlap, whole->overlap);
      EXPECT_EQ(stepped.iterations, whole->iterations);
      EXPECT_EQ(stepped.retries, whole->retries);
      EXPECT_EQ(stepped.stop_reason, whole->stop_reason);
      EXPECT_EQ(stepped.warnings, whole->warnings);
      EXPECT_EQ(stepped.steps.size(), whole->steps.size());
      EXPECT_GT(stepped.milliseconds, 0.0);
    }
  }
}

TEST(RegistrationTrace, RetriesAreAttemptsOfTheirOwn) {
  const RegistrationTrace trace = ended(doubting());
  ASSERT_EQ(trace.attempts().size(), 6U);  // given, cubes, four headings
  EXPECT_EQ(trace.attempts()[0].what.kind, AttemptKind::Given);
  EXPECT_EQ(trace.attempts()[1].what.kind, AttemptKind::Cubes);
  EXPECT_NE(trace.attempts()[1].fixed, trace.attempts()[0].fixed);
  const double turns[] = {1, -1, 2, -2};
  for (std::size_t i = 2; i < 6; ++i) {
    const TraceAttempt& attempt = trace.attempts()[i];
    EXPECT_EQ(attempt.what.kind, AttemptKind::OtherHeading);
    EXPECT_NEAR(attempt.what.turned_rad, turns[i - 2] * 10.0 * kDegree, 1e-12);
    ASSERT_LT(attempt.first_step, trace.steps().size());
    const TraceStep& first = *trace.steps()[attempt.first_step];
    EXPECT_EQ(first.attempt, i);
    EXPECT_EQ(first.report.iteration, 1);
    EXPECT_EQ(first.before, attempt.what.start);
    EXPECT_TRUE(trace.steps()[attempt.first_step - 1]->report.stop);
  }
  EXPECT_EQ(trace.result().retries, 4);
  ASSERT_TRUE(trace.chosenAttempt());
  // The result is the last pose of the attempt that was chosen.
  const std::size_t chosen = *trace.chosenAttempt();
  const std::size_t end = chosen + 1 < 6 ? trace.attempts()[chosen + 1].first_step : trace.steps().size();
  EXPECT_EQ(trace.steps()[end - 1]->report.fixed_from_moving, trace.result().fixed_from_moving);
  for (const TraceAttempt& attempt : trace.attempts()) EXPECT_EQ(attemptSentence(attempt.what).back(), '.');
  EXPECT_NE(attemptSentence(trace.attempts()[3].what).find("10 degrees to the right"), std::string::npos);
}

TEST(RegistrationTrace, ACopyGoesOnByItself) {
  auto trace = RegistrationTrace::begin(room().fixed, room().moving, Pose(), RegistrationSettings{});
  ASSERT_TRUE(trace);
  trace->step();
  trace->step();
  RegistrationTrace copy = *trace;
  while (!copy.done()) copy.step();
  EXPECT_EQ(trace->steps().size(), 2U);
  while (!trace->done()) trace->step();
  EXPECT_EQ(trace->result().fixed_from_moving, copy.result().fixed_from_moving);
}

TEST(RegistrationTrace, StoppingEndsItWithoutAResult) {
  auto trace = RegistrationTrace::begin(room().fixed, room().moving, kTruth, RegistrationSettings{});
  trace->step();
  std::stop_source source;
  source.request_stop();
  const TraceStepPtr last = trace->step(source.get_token());
  EXPECT_EQ(last->report.stop, StopReason::Cancelled);
  EXPECT_TRUE(last->pairs.empty());
  EXPECT_TRUE(trace->done());
  EXPECT_TRUE(trace->cancelled());
  EXPECT_THROW(trace->result(), std::logic_error);
  EXPECT_THROW(trace->step(), std::logic_error);
}

TEST(RegistrationTrace, WhatCannotBeUsedIsAnErrorAndNothingIsNoInformation) {
  RegistrationSettings bad;
  bad.motion = MotionMethod::Svd;
  EXPECT_FALSE(RegistrationTrace::begin(room().fixed, room().moving, Pose(), bad));
  const Pose nowhere(Eigen::Quaterniond::Identity(), {std::nan(""), 0.0, 0.0});
  EXPECT_FALSE(RegistrationTrace::begin(room().fixed, room().moving, nowhere, RegistrationSettings{}));
  EXPECT_FALSE(RegistrationTrace::begin(Scan(), room().moving, Pose(), RegistrationSettings{}));
  auto empty = RegistrationTrace::begin(almostEmptyScan(0), room().moving, Pose(), RegistrationSettings{});
  ASSERT_TRUE(empty);
  while (!empty->done()) empty->step();
  EXPECT_EQ(empty->result().stop_reason, StopReason::TooFewPairs);
  const TraceStep& step = *empty->steps().front();
  for (const TracedPair& pair : tracedPairs(empty->attempts()[0], step)) {
    EXPECT_EQ(pair.pair.reason, RejectReason::NoPartner);
    EXPECT_EQ(pair.weight, 0.0);
  }
  EXPECT_EQ(residualHistogram({}).bin_m, 0.0);
}

TEST(TracedPairs, ResidualsAndWeightsAreTheMetrics) {
  for (const RegistrationSettings& settings : {RegistrationSettings{}, thesis()}) {
    const RegistrationTrace trace = ended(settings);
    const TraceAttempt& attempt = trace.attempts()[0];
    const bool patches = settings.reduction == Reduction::Patches;
    // The refinement goes by cells, no pairs.
    std::size_t last = trace.steps().size() - 1;
    while (trace.steps()[last]->report.refining) --last;
    EXPECT_EQ(last + 1 < trace.steps().size(), patches);
    for (const std::size_t k : {std::size_t{0}, last}) {
      const TraceStep& step = *trace.steps()[k];
      const std::vector<TracedPair> pairs = tracedPairs(attempt, step);
      ASSERT_EQ(pairs.size(), step.pairs.size());
      // The step's own error comes out of them again.
      double weights = 0.0, squares = 0.0;
      std::size_t kept = 0;
      for (const TracedPair& pair : pairs) {
        if (!pair.pair.kept()) {
          EXPECT_EQ(pair.weight, 0.0);
          continue;
        }
        ++kept;
        EXPECT_GT(pair.weight, 0.0);
        EXPECT_LE(pair.weight, 1.0);
        const double distance = (step.before * pair.moving_point - pair.fixed_point).norm();
        EXPECT_NEAR(distance, static_cast<double>(pair.pair.distance_m), 1e-4);
        EXPECT_LE(pair.residual_m, distance + 1e-9);
        EXPECT_EQ(pair.deviation_m > 0.0, patches);
        const double scale = step.report.loss.scale_m;
        const double w =
            patches ? pair.weight / (pair.deviation_m * pair.deviation_m + scale * scale) : pair.weight;
        weights += w;
        squares += w * pair.residual_m * pair.residual_m;
      }
      EXPECT_EQ(kept, step.report.pairs);
      EXPECT_NEAR(squares / weights, step.report.error_m2, 1e-9 * step.report.error_m2);
    }
  }
}

TEST(ResidualHistogram, HoldsEveryKeptPairOnce) {
  const RegistrationTrace trace = ended(thesis());
  const std::vector<TracedPair> pairs = tracedPairs(trace.attempts()[0], *trace.steps().front());
  for (const std::size_t bins : {std::size_t{1}, std::size_t{10}, std::size_t{40}}) {
    const ResidualHistogram histogram = residualHistogram(pairs, bins);
    EXPECT_LE(histogram.counts.size(), bins + 1);
    const std::size_t within =
        std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::size_t{0});
    EXPECT_EQ(within + histogram.beyond, trace.steps().front()->report.pairs);
    EXPECT_LE(histogram.beyond, trace.steps().front()->report.pairs / 15);
    const double mantissa = histogram.bin_m / std::pow(10.0, std::floor(std::log10(histogram.bin_m) + 1e-9));
    EXPECT_TRUE(std::abs(mantissa - 1) < 1e-6 || std::abs(mantissa - 2) < 1e-6 ||
                std::abs(mantissa - 5) < 1e-6)
        << histogram.bin_m;
    EXPECT_GT(histogram.median_m, 0.0);
  }
}

TEST(PairSentence, NamesFateNumbersAndWeight) {
  const RegistrationTrace trace = ended(thesis());
  const TraceStep& step = *trace.steps().front();
  bool seen[kRejectReasons] = {};
  for (const TracedPair& pair : tracedPairs(trace.attempts()[0], step)) {
    const std::string sentence = pairSentence(trace.attempts()[0], step, pair);
    EXPECT_EQ(sentence.back(), '.');
    const std::string reason = rejectReasonName(pair.pair.reason);
    if (pair.pair.kept())
      EXPECT_EQ(sentence.find("Kept: "), 0U) << sentence;
    else
      EXPECT_NE(sentence.find(reason), std::string::npos) << sentence;
    seen[static_cast<std::size_t>(pair.pair.reason)] = true;
  }
  EXPECT_TRUE(seen[static_cast<std::size_t>(RejectReason::None)]);
  EXPECT_TRUE(seen[static_cast<std::size_t>(RejectReason::NormalDisagrees)]);

  const RegistrationTrace ours = ended(RegistrationSettings{});
  const TraceStep& last = *ours.steps().back();
  bool weighed = false;
  for (const TracedPair& pair : tracedPairs(ours.attempts()[0], last))
    if (pair.pair.kept())
      weighed |= pairSentence(ours.attempts()[0], last, pair).find("% of its weight") != std::string::npos;
  EXPECT_TRUE(weighed);
}

TEST(LossSentence, EachStepSaysWhatResidualsWereJudgedBy) {
  const auto says = [](const RegistrationTrace& trace, const TraceStep& step, const std::string& words) {
    const std::string sentence = lossSentence(trace.attempts()[0], step.report);
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
  };
  const RegistrationTrace ours = ended(RegistrationSettings{});
  says(ours, *ours.steps().front(), "Loss scale: 2.00 m, on its way down");
  bool own = false;
  for (const auto& step : ours.steps()) {
    if (!step->report.loss.isOwn() || step->report.refining) continue;
    says(ours, *step, "deviations of each pair");
    own = true;
  }
  EXPECT_TRUE(own);
  const TraceStep& last = *ours.steps().back();
  ASSERT_TRUE(last.report.refining);
  EXPECT_GT(last.report.cells, 1000.0);
  says(ours, last, groupedInteger(std::llround(last.report.cells)) + " cells of both scans");

  const RegistrationTrace unweighted = ended(thesis());
  says(unweighted, *unweighted.steps().front(), "none");
}

}  // namespace
}  // namespace tiltmap
