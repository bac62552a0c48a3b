#include "core/project/judgement_json.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/base/text.h"

namespace tiltmap {

namespace {

using nlohmann::json;

std::array<double, 7> numbersOf(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

template <std::size_t N>
std::array<double, N> numbersOf(const json& from) {
  if (!from.is_array() || from.size() != N) throw std::invalid_argument("not as many numbers");
  std::array<double, N> numbers;
  for (std::size_t i = 0; i < N; ++i) numbers[i] = exactNumberOf(from[i]);
  return numbers;
}

Pose poseOf(const json& from) {
  const auto n = numbersOf<7>(from);
  return Pose::restored(Eigen::Quaterniond(n[6], n[3], n[4], n[5]), {n[0], n[1], n[2]});
}

json scanJson(const JudgedOf::Scan& scan) {
  return {scan.matrix, scan.geometry, scan.lines};
}

json ofJson(const JudgedOf& of) {
  return {{"fixed", scanJson(of.fixed)},
          {"moving", scanJson(of.moving)},
          {"fixed_from_moving", numbersOf(of.fixed_from_moving)}};
}

Matrix6d covarianceOf(const json& from) {
  const auto lower = numbersOf<21>(from);
  Matrix6d covariance;
  std::size_t next = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) covariance(r, c) = covariance(c, r) = lower[next++];
  return covariance;
}

Verdict verdictOf(const std::string& name) {
  for (const Verdict verdict : {Verdict::Good, Verdict::Doubtful, Verdict::Bad})
    if (verdictName(verdict) == name) return verdict;
  throw std::invalid_argument("no verdict: " + name);
}

// A number that is not finite becomes null in JSON, silently.
void requireFinite(const json& figures) {
  if (figures.is_number_float() && !std::isfinite(figures.get<double>()))
    throw std::invalid_argument("a figure of the judgement is not finite");
  if (!figures.is_structured()) return;
  for (const auto& inner : figures) requireFinite(inner);
}

json exact(const json& value) {
  if (value.is_number_float()) return exactNumber(value.get<double>());
  json copy = value;
  if (value.is_structured())
    for (auto& inner : copy) inner = exact(inner);
  return copy;
}

}  // namespace

json exactNumber(double value) {
  return std::isfinite(value) ? json(value) : json(shortestReal(value));
}

double exactNumberOf(const json& value) {
  if (!value.is_string()) return value.get<double>();
  const auto number = parseReal(value.get<std::string>());
  if (!number) throw std::invalid_argument("no number");
  return *number;
}

json judgementJson(const PairJudgement& j) {
  json covariance = json::array();
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c <= r; ++c) covariance.push_back(j.strength.covariance(r, c));
  return {{"verdict", verdictName(j.verdict)},
          {"reason", j.reason},
          {"badness", j.badness},
          {"overlap_fixed", j.overlap_fixed},
          {"overlap_moving", j.overlap_moving},
          {"fit", j.fit},
          {"through", j.through},
          {"seen", j.seen},
          {"residual_m", j.residual_m},
          {"expected_m", j.expected_m},
          {"excess_m", j.excess_m},
          {"pull_m", j.pull_m},
          {"pull_deg", j.pull_rad / kDegree},
          {"start", numbersOf(j.start)},
          {"moved_m", j.moved.translation_m},
          {"moved_deg", j.moved.rotation_rad / kDegree},
          {"deviation_m", {j.strength.right_m, j.strength.forward_m, j.strength.up_m}},
          {"deviation_deg",
           {j.strength.pitch_rad / kDegree, j.strength.roll_rad / kDegree, j.strength.heading_rad / kDegree}},
          {"covariance", std::move(covariance)},
          {"strength", j.strength_sentence}};
}

json linkJson(const ProjectSnapshot& snapshot, const Link& link, const LinkJudgement& judgement) {
  const LinkAgreement& others = judgement.others;
  const auto place = [&](ScanId scan) {
    const auto index = snapshot.indexOf(scan);
    return index ? json(*index) : json();
  };
  json by_others = {{"supported", others.supported}};
  if (others.supported)
    by_others.update({{"off_m", others.off.translation_m},
                      {"off_deg", others.off.rotation_rad / kDegree},
                      {"deviations", others.deviations},
                      {"own", others.own}});
  json loop = {{"links", others.loop}};
  if (others.loop > 0)
    loop.update({{"misclosure_m", others.misclosure.translation_m},
                 {"misclosure_deg", others.misclosure.rotation_rad / kDegree}});
  return {{"id", link.id},
          {"fixed", place(link.fixed)},
          {"moving", place(link.moving)},
          {"verdict", linkQualityName(judgement.quality)},
          {"reason", judgement.reason},
          {"badness", judgement.badness},
          {"by_scans", judgement.by_scans ? judgementJson(*judgement.by_scans) : json()},
          {"others", std::move(by_others)},
          {"loop", std::move(loop)},
          {"off_m", judgement.off.translation_m},
          {"off_deg", judgement.off.rotation_rad / kDegree},
          {"rms_m", link.rms_m},
          {"state", linkStateName(link.state)},
          {"origin", linkOriginName(link.origin)},
          {"succeeded", link.succeeded},
          {"stop_reason", link.stop_reason}};
}

json wholeJudgement(const PairJudgement& judgement) {
  json whole = exact(judgementJson(judgement));
  whole["pull_rad"] = exactNumber(judgement.pull_rad);  // degrees and back are not the same number
  return whole;
}

PairJudgement judgementOf(const json& whole, const Pose& fixed_from_moving) {
  PairJudgement j;
  const auto number = [&whole](const char* key, double& value) { value = exactNumberOf(whole.at(key)); };
  j.verdict = verdictOf(whole.at("verdict").get<std::string>());
  whole.at("reason").get_to(j.reason);
  number("badness", j.badness);
  number("overlap_fixed", j.overlap_fixed);
  number("overlap_moving", j.overlap_moving);
  number("fit", j.fit);
  number("through", j.through);
  whole.at("seen").get_to(j.seen);
  number("residual_m", j.residual_m);
  number("expected_m", j.expected_m);
  number("excess_m", j.excess_m);
  number("pull_m", j.pull_m);
  number("pull_rad", j.pull_rad);
  j.start = poseOf(whole.at("start"));
  j.moved = difference(j.start, fixed_from_moving);
  j.strength = strengthOfCovariance(covarianceOf(whole.at("covariance")));
  whole.at("strength").get_to(j.strength_sentence);
  return j;
}

std::string storedJudgement(const PairJudgement& judgement, const JudgedOf& of) {
  requireFinite(judgementJson(judgement));
  json stored = wholeJudgement(judgement);
  stored["of"] = ofJson(of);
  return stored.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::shared_ptr<const PairJudgement> restoredJudgement(const std::string& stored, const JudgedOf& of) {
  try {
    const json from = json::parse(stored);
    if (from.at("of") != ofJson(of)) return nullptr;
    return std::make_shared<const PairJudgement>(judgementOf(from, of.fixed_from_moving));
  } catch (const std::exception&) {  // of nlohmann, or no verdict
    return nullptr;
  }
}

}  // namespace tiltmap
