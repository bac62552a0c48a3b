#include "core/registration/registration_trace.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"

namespace tiltmap {

namespace {

bool usesPatches(const RegistrationSettings& settings) {
  return settings.reduction == Reduction::Patches;
}

// The smallest of 1, 2, 5 times a power of ten that is not below.
double roundUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power * (1.0 + 1e-12)) return step * power;
  return 10.0 * power;
}

// A length with so many digits that it can be told from another.
std::string lengthWords(double metres) {
  if (metres < 0.0005) return fixedReal(1e3 * metres, 2) + " mm";
  if (metres < 0.1) return fixedReal(1e3 * metres, 1) + " mm";
  return fixedReal(metres, 2) + " m";
}

std::string angleWords(double cos_angle) {
  return fixedReal(std::acos(std::clamp(cos_angle, -1.0, 1.0)) / kDegree, 1) + " degrees";
}

std::string keptSentence(const TraceAttempt& attempt, const TracedPair& pair) {
  const Metric metric = metricOf(attempt.settings.motion, usesPatches(attempt.settings));
  std::string text = "Kept: ";
  text += metric == Metric::PointToPoint
              ? "the two points are " + lengthWords(pair.residual_m) + " apart"
              : "the two surfaces are " + lengthWords(pair.residual_m) + " apart across, their centres " +
                    lengthWords(static_cast<double>(pair.pair.distance_m));
  if (pair.pair.has_normals)
    text += ", the normals differ by " + angleWords(static_cast<double>(pair.pair.cos_angle));
  text += ".";
  if (pair.deviation_m > 0.0) text += " Its patches explain " + lengthWords(pair.deviation_m) + ".";
  if (attempt.settings.loss != Loss::None) {
    text += " The loss leaves it " + fixedReal(100.0 * pair.weight, 0) + " % of its weight";
    text += pair.weight < 0.1 ? ": it hardly counts." : ".";
  }
  return text;
}

}  // namespace

RegistrationTrace::RegistrationTrace(PairRegistration registration, TraceAttempt first)
    : registration_(std::move(registration)), attempts_{std::move(first)} {
  milliseconds_ = attempts_.front().fixed->milliseconds + attempts_.front().moving->milliseconds;
}

Result<RegistrationTrace> RegistrationTrace::begin(const Scan& fixed, const Scan& moving,
                                                   const Pose& start_fixed_from_moving,
                                                   const RegistrationSettings& settings) {
  if (const Status status = checkSettings(settings); !status) return fail(status.error());
  for (const Scan* scan : {&fixed, &moving})
    if (!scan->image)
      return fail("a scan has no range matrix", scan->name, "choose a scan that was imported or captured");
  return begin(prepare(fixed, settings), prepare(moving, settings), start_fixed_from_moving, settings);
}

Result<RegistrationTrace> RegistrationTrace::begin(const PreparedScanPtr& fixed,
                                                   const PreparedScanPtr& moving,
                                                   const Pose& start_fixed_from_moving,
                                                   const RegistrationSettings& settings) {
  if (const Status status = checkSettings(settings); !status) return fail(status.error());
  if (!start_fixed_from_moving.isFinite())
    return fail("the start pose is not finite", "register",
                "give the pair an odometry or a start of numbers");
  TraceAttempt first{{AttemptKind::Given, start_fixed_from_moving, 0.0}, fixed, moving, settings, 0};
  return RegistrationTrace(PairRegistration(fixed, moving, start_fixed_from_moving, settings),
                           std::move(first));
}

TraceStepPtr RegistrationTrace::step(const std::stop_token& stop) {
  const std::size_t begun = registration_.attempts();
  auto made = std::make_shared<TraceStep>();
  made->report = registration_.step(stop);
  const Registration& registration = registration_.registration();
  const bool first = registration_.attempts() > begun;
  if (first && begun > 0) {
    attempts_.push_back({registration_.attempt(), registration.fixed(), registration.moving(),
                         registration.settings(), steps_.size()});
    if (attempts_.back().what.kind == AttemptKind::Cubes)
      milliseconds_ += attempts_.back().fixed->milliseconds + attempts_.back().moving->milliseconds;
  }
  made->attempt = registration_.attempts() - 1;
  made->before = first ? registration_.attempt().start : steps_.back()->report.fixed_from_moving;
  if (made->report.stop != StopReason::Cancelled) made->pairs = registration.correspondences();
  milliseconds_ += made->report.milliseconds;
  steps_.push_back(made);
  return made;
}

PairResult RegistrationTrace::result() const {
  PairResult result = registration_.result();
  result.milliseconds = milliseconds_;
  return result;
}

std::vector<TracedPair> tracedPairs(const TraceAttempt& attempt, const TraceStep& step) {
  const SurfaceElements& fixed = attempt.fixed->elements;
  const SurfaceElements& moving = attempt.moving->elements;
  const Metric metric = metricOf(attempt.settings.motion, usesPatches(attempt.settings));
  LinearSystem system;
  Residuals residuals;
  linearise(metric, fixed, moving, Pose(), step.before, step.pairs, attempt.settings, step.report.loss,
            system, &residuals);
  std::vector<TracedPair> traced;
  traced.reserve(step.pairs.size());
  std::size_t kept = 0;
  for (const Correspondence& pair : step.pairs) {
    TracedPair one;
    one.pair = pair;
    const bool partner = pair.reason != RejectReason::NoPartner;
    if (partner || pair.from_fixed) one.fixed_point = fixed.position[pair.fixed];
    if (partner || !pair.from_fixed) one.moving_point = moving.position[pair.moving];
    if (pair.kept()) {
      const double scale = step.report.loss.scale_m;
      one.residual_m = residuals.size_m[kept];
      const double variance =
          residuals.variance_m2.empty() ? 0.0 : residuals.variance_m2[kept] + scale * scale;
      if (!residuals.variance_m2.empty()) one.deviation_m = std::sqrt(residuals.variance_m2[kept]);
      one.weight =
          gemanMcClureWeight(one.residual_m * one.residual_m, squaredLossScale(step.report.loss, variance));
      ++kept;
    } else {
      one.weight = 0.0;
    }
    traced.push_back(one);
  }
  return traced;
}

ResidualHistogram residualHistogram(const std::vector<TracedPair>& pairs, std::size_t bins) {
  std::vector<double> sizes;
  for (const TracedPair& pair : pairs)
    if (pair.pair.kept()) sizes.push_back(pair.residual_m);
  ResidualHistogram histogram;
  if (sizes.empty() || bins == 0) return histogram;
  std::ranges::sort(sizes);
  histogram.median_m = sizes[sizes.size() / 2];
  const double most = std::max(sizes[sizes.size() * 19 / 20], 1e-9);
  histogram.bin_m = roundUp(most / static_cast<double>(bins));
  const auto count = static_cast<std::size_t>(most / histogram.bin_m) + 1;
  histogram.counts.assign(count, 0);
  histogram.weighted.assign(count, 0.0);
  for (const TracedPair& pair : pairs) {
    if (!pair.pair.kept()) continue;
    const double place = pair.residual_m / histogram.bin_m;
    if (place >= static_cast<double>(count)) {
      ++histogram.beyond;
      continue;
    }
    ++histogram.counts[static_cast<std::size_t>(place)];
    histogram.weighted[static_cast<std::size_t>(place)] += pair.weight;
  }
  return histogram;
}

std::string attemptSentence(const PairAttempt& attempt) {
  switch (attempt.kind) {
    case AttemptKind::Given:
      return "From the given start.";
    case AttemptKind::Cubes:
      return "Again from the given start with the scans cut into cubes instead of blocks: the first result "
             "failed, agreed too little or left a direction in doubt.";
    case AttemptKind::OtherHeading:
      return "Again with the moving scan turned " + fixedReal(std::abs(attempt.turned_rad) / kDegree, 0) +
             " degrees to the " + (attempt.turned_rad > 0.0 ? "left" : "right") +
             ": too few pairs agreed before.";
  }
  throw std::invalid_argument("attemptSentence: no such kind");
}

std::string pairSentence(const TraceAttempt& attempt, const TraceStep& step, const TracedPair& pair) {
  const std::string distance = lengthWords(static_cast<double>(pair.pair.distance_m));
  switch (pair.pair.reason) {
    case RejectReason::None:
      return keptSentence(attempt, pair);
    case RejectReason::NoPartner:
      return std::string("No partner: the ") + (pair.pair.from_fixed ? "moving" : "fixed") +
             " scan has nothing in that direction.";
    case RejectReason::NoNormal:
      return "Rejected, no normal: one of the two has no surface normal, and the method needs both. They "
             "are " +
             distance + " apart.";
    case RejectReason::TooFar:
      return "Rejected, too far: " + distance + " apart, more than the bound of this step.";
    case RejectReason::NormalDisagrees:
      return "Rejected, normal disagrees: the normals differ by " +
             angleWords(static_cast<double>(pair.pair.cos_angle)) + ", more than the " +
             fixedReal(attempt.settings.max_angle_rad / kDegree, 0) + " allowed. They are " + distance +
             " apart.";
    case RejectReason::Statistics:
      return "Rejected, statistics: " + distance + " apart, beyond the " +
             lengthWords(step.report.distance_bound_m) +
             " that mean and deviation of all distances allow in this step.";
  }
  throw std::invalid_argument("pairSentence: no such reason");
}

std::string lossSentence(const TraceAttempt& attempt, const StepReport& report) {
  const LossScale& loss = report.loss;
  if (report.refining)
    return "Refinement: " + groupedInteger(std::llround(report.cells)) +
           " cells of both scans held against the other's plane patches, all on one patch as one "
           "measurement; "
           "loss scale " +
           fixedReal(attempt.settings.refine_deviations, 1) + " deviations.";
  const std::string scale = "Loss scale: ";
  if (attempt.settings.loss == Loss::None) return scale + "none, every kept pair counts the same.";
  if (loss.isOwn())
    return scale + fixedReal(loss.deviations, 1) + " deviations of each pair, " + lengthWords(loss.scale_m) +
           " added to what its patches explain.";
  return scale + lengthWords(loss.scale_m) +
         (attempt.settings.loss == Loss::Annealed ? ", on its way down." : ", the same in every step.");
}

}  // namespace tiltmap
