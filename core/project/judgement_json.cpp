#include "core/project/judgement_json.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace tiltmap {

namespace {

using nlohmann::json;

std::array<double, 7> numbersOf(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond& q = pose.quaternion();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Pose poseOf(const json& from) {
  const auto n = from.get<std::array<double, 7>>();
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
  const auto lower = from.get<std::array<double, 21>>();
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

}  // namespace

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

std::string storedJudgement(const PairJudgement& judgement, const JudgedOf& of) {
  json stored = judgementJson(judgement);
  stored["of"] = ofJson(of);
  stored["pull_rad"] = judgement.pull_rad;  // degrees and back are not the same number
  requireFinite(stored);
  return stored.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::shared_ptr<const PairJudgement> restoredJudgement(const std::string& stored, const JudgedOf& of) {
  try {
    const json from = json::parse(stored);
    if (from.at("of") != ofJson(of)) return nullptr;
    auto j = std::make_shared<PairJudgement>();
    j->verdict = verdictOf(from.at("verdict").get<std::string>());
    from.at("reason").get_to(j->reason);
    from.at("badness").get_to(j->badness);
    from.at("overlap_fixed").get_to(j->overlap_fixed);
    from.at("overlap_moving").get_to(j->overlap_moving);
    from.at("fit").get_to(j->fit);
    from.at("through").get_to(j->through);
    from.at("seen").get_to(j->seen);
    from.at("residual_m").get_to(j->residual_m);
    from.at("expected_m").get_to(j->expected_m);
    from.at("excess_m").get_to(j->excess_m);
    from.at("pull_m").get_to(j->pull_m);
    from.at("pull_rad").get_to(j->pull_rad);
    j->start = poseOf(from.at("start"));
    j->moved = difference(j->start, of.fixed_from_moving);
    j->strength = strengthOfCovariance(covarianceOf(from.at("covariance")));
    from.at("strength").get_to(j->strength_sentence);
    return j;
  } catch (const std::exception&) {  // of nlohmann, or no verdict
    return nullptr;
  }
}

}  // namespace tiltmap
