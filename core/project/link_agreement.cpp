#include "core/project/link_agreement.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/multiview/pose_covariance.h"
#include "core/project/link_system.h"
#include "core/project/link_what_if.h"
#include "core/project/operations/relax_operation.h"
#include "core/registration/pair_judgement.h"

namespace tiltmap {

namespace {

constexpr double kDamping = 1e-3;  // nothing beside what links tell: holds what nothing determines
constexpr int kMostRounds = 40;    // of setting links aside
constexpr double kAsMuch = 0.97;   // of the largest contradiction: as large

// Covariance in the moving scan's frame: what the link says of itself, and what the model of a rigid,
// undistorted scan is good for.
Matrix6d rigCovariance(const Link& link, const JudgementSettings& settings) {
  Matrix6d covariance;
  if (link.judgement)
    covariance = link.judgement->strength.covariance;
  else
    covariance = strengthOf(link.information.value_or(informationByHand()), link.fixed_from_moving,
                            link.information ? settings.covariance_cells : 1.0)
                     .covariance;
  covariance.diagonal().head<3>().array() += settings.others_floor_rad * settings.others_floor_rad;
  covariance.diagonal().tail<3>().array() += settings.others_floor_m * settings.others_floor_m;
  return covariance;
}

Matrix6d fixedInformation(const Link& link, const Matrix6d& rig_covariance) {
  const Matrix6d to_rig = rigFromFixed(link.fixed_from_moving);
  const Matrix6d information =
      to_rig.transpose() * rig_covariance.ldlt().solve(Matrix6d::Identity()) * to_rig;
  return 0.5 * (information + information.transpose());
}

struct Asked {
  LinkTie tie;         // with the information of the link
  bool speaks = true;  // for or against others
  LinkAgreement result;
  double square = 0.0;  // normalised, of 6 degrees of freedom
};

// Of the graph whose edges are the speaking ties.
class Graph {
 public:
  Graph(const std::vector<Asked>& asked, std::size_t count) : asked_(asked), at_(count) {
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (!asked[k].speaks) continue;
      at_[index(asked[k].tie.fixed)].push_back(k);
      at_[index(asked[k].tie.moving)].push_back(k);
    }
    findComponentsAndBridges();
  }

  int component(int scan) const { return component_[index(scan)]; }
  bool isBridge(std::size_t k) const { return bridge_[k] != 0; }
  const std::vector<std::size_t>& at(int scan) const { return at_[index(scan)]; }
  int otherEnd(std::size_t k, int scan) const {
    return asked_[k].tie.fixed == scan ? asked_[k].tie.moving : asked_[k].tie.fixed;
  }
  // Where each scan is if the first of its component stays and each tie is taken at its word along the
  // shortest ways from there.
  std::vector<Pose> chained(std::vector<Pose> poses) const {
    for (const auto& [k, from] : tree_) {
      const LinkTie& tie = asked_[k].tie;
      const Pose& measured = tie.link->fixed_from_moving;
      const int to = otherEnd(k, from);
      poses[index(to)] = poses[index(from)] * (tie.fixed == from ? measured : measured.inverse());
    }
    return poses;
  }
  std::vector<char> roots() const { return root_; }

  // The ties of the shortest way between the scans of tie k without it; empty where there is none.
  std::vector<std::size_t> wayAround(std::size_t k) const {
    const int from = asked_[k].tie.fixed, to = asked_[k].tie.moving;
    if (component(from) != component(to) || (asked_[k].speaks && isBridge(k))) return {};
    std::vector<std::size_t> came(at_.size(), kNone);
    std::vector<char> seen(at_.size(), 0);
    std::deque<int> open = {from};
    seen[index(from)] = 1;
    while (!open.empty() && !seen[index(to)]) {
      const int scan = open.front();
      open.pop_front();
      for (const std::size_t next : at(scan)) {
        const int other = otherEnd(next, scan);
        if (next == k || seen[index(other)]) continue;
        seen[index(other)] = 1;
        came[index(other)] = next;
        open.push_back(other);
      }
    }
    std::vector<std::size_t> way;
    for (int scan = to; seen[index(to)] && scan != from; scan = otherEnd(came[index(scan)], scan))
      way.push_back(came[index(scan)]);
    std::ranges::reverse(way);
    return way;
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  // Depth first without recursion (Tarjan 1974): a tie is a bridge where nothing below it reaches above it.
  void findComponentsAndBridges() {
    const std::size_t count = at_.size();
    component_.assign(count, -1);
    root_.assign(count, 0);
    bridge_.assign(asked_.size(), 0);
    std::vector<int> entered(count, -1), lowest(count, 0);
    std::vector<std::size_t> next(count, 0), by(count, kNone);
    int clock = 0;
    for (std::size_t root = 0; root < count; ++root) {
      if (entered[root] >= 0) continue;
      root_[root] = 1;
      std::vector<int> stack = {static_cast<int>(root)};
      entered[root] = lowest[root] = clock++;
      while (!stack.empty()) {
        const int scan = stack.back();
        const std::size_t s = index(scan);
        component_[s] = static_cast<int>(root);
        if (next[s] < at_[s].size()) {
          const std::size_t k = at_[s][next[s]++];
          if (k == by[s]) continue;
          const int other = otherEnd(k, scan);
          const std::size_t o = index(other);
          if (entered[o] >= 0) {
            lowest[s] = std::min(lowest[s], entered[o]);
            continue;
          }
          by[o] = k;
          entered[o] = lowest[o] = clock++;
          stack.push_back(other);
          continue;
        }
        stack.pop_back();
        if (stack.empty()) continue;
        const std::size_t parent = index(stack.back());
        lowest[parent] = std::min(lowest[parent], lowest[s]);
        if (lowest[s] > entered[parent]) bridge_[by[s]] = 1;
      }
    }
    growTree();
  }

  // Breadth first, so that what is taken at its word adds up over few ties.
  void growTree() {
    std::vector<char> seen(at_.size(), 0);
    for (std::size_t root = 0; root < at_.size(); ++root) {
      if (!root_[root]) continue;
      std::deque<int> open = {static_cast<int>(root)};
      seen[root] = 1;
      while (!open.empty()) {
        const int scan = open.front();
        open.pop_front();
        for (const std::size_t k : at(scan)) {
          const int other = otherEnd(k, scan);
          if (seen[index(other)]) continue;
          seen[index(other)] = 1;
          tree_.emplace_back(k, scan);
          open.push_back(other);
        }
      }
    }
  }

  const std::vector<Asked>& asked_;
  std::vector<std::vector<std::size_t>> at_;
  std::vector<int> component_;
  std::vector<char> root_, bridge_;
  std::vector<std::pair<std::size_t, int>> tree_;  // the tie, and the end it grew from
};

std::vector<Asked> askedLinks(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                              const JudgementSettings& settings) {
  std::vector<Asked> asked;
  for (const Link& link : links) {
    const auto fixed = snapshot.indexOf(link.fixed), moving = snapshot.indexOf(link.moving);
    if (!fixed || !moving || !link.succeeded) continue;
    Asked one;
    one.tie = {&link, static_cast<int>(*fixed), static_cast<int>(*moving),
               fixedInformation(link, rigCovariance(link, settings))};
    one.speaks = link.usable() && link.stop_reason != kFoundByRelaxation &&
                 !(link.judgement && link.judgement->verdict == Verdict::Bad);
    one.result.link = link.id;
    asked.push_back(std::move(one));
  }
  return asked;
}

// All leave-one-out figures from one solution. For a tie of information w at the residual r, with c the
// covariance that all leave its two scans: what the others say is (1 - c w)^-1 r away, and r^T w of that is
// its normalised square. For one that does not speak c is the others' already.
Status askAll(std::vector<Asked>& asked, const Graph& graph, std::size_t count,
              const std::vector<Pose>& start) {
  std::vector<LinkTie> speaking, all;
  for (const Asked& one : asked) {
    all.push_back(one.tie);
    if (one.speaks)
      speaking.push_back(one.tie);
    else
      all.back().information.setZero();
  }
  const std::vector<char> held = graph.roots();
  const auto solved = solveTies(speaking, graph.chained(start), held);
  if (!solved) return fail(solved.error());
  const auto terms = termsOf(all, solved->world_from_scan);
  const auto covariances = termCovariances(count, held, terms, kDamping);
  if (!covariances) return fail(covariances.error());
  for (std::size_t k = 0; k < asked.size(); ++k) {
    Asked& one = asked[k];
    const Matrix6d& w = one.tie.information;
    const Matrix6d& c = (*covariances)[k];
    one.square = 0.0;
    const bool same = graph.component(one.tie.fixed) == graph.component(one.tie.moving);
    one.result.supported = same && !(one.speaks && graph.isBridge(k));
    one.result.off = {};
    one.result.deviations = 0.0;
    if (!one.result.supported) continue;
    // From where the poses put the moving scan to where the link does.
    const Pose off = one.tie.link->fixed_from_moving * terms[k].fixed_from_moving.inverse();
    Vector6d r, away;
    r << rotationLog(off.quaternion()), off.translation();
    if (one.speaks) {
      away = (Matrix6d::Identity() - c * w).partialPivLu().solve(r);
      one.square = r.dot(w * away);
    } else {
      away = r;
      one.square = r.dot((c + w.ldlt().solve(Matrix6d::Identity())).ldlt().solve(r));
    }
    if (!away.allFinite() || !std::isfinite(one.square)) {
      one.result.supported = false;
      one.square = 0.0;
      continue;
    }
    const Pose others = one.tie.link->fixed_from_moving.moved(-away);
    one.result.off = difference(others, one.tie.link->fixed_from_moving);
    one.result.deviations = std::sqrt(std::max(0.0, one.square) / 6.0);
  }
  return {};
}

bool contradicts(const Asked& one, const JudgementSettings& settings) {
  return one.result.supported && one.result.deviations > settings.others_good &&
         (one.result.off.translation_m > settings.others_least_m ||
          one.result.off.rotation_rad > settings.others_least_rad);
}

// Those that contradict more than every other at their scans: they no longer speak. False where there are
// none.
bool setAside(std::vector<Asked>& asked, const Graph& graph, const JudgementSettings& settings) {
  std::vector<std::size_t> worst;
  std::vector<char> own;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    if (!asked[k].speaks || !contradicts(asked[k], settings)) continue;
    bool most = true, alone = true;
    for (const int scan : {asked[k].tie.fixed, asked[k].tie.moving})
      for (const std::size_t other : graph.at(scan)) {
        if (other == k) continue;
        most = most && kAsMuch * asked[other].square <= asked[k].square;
        alone = alone && asked[other].square < kAsMuch * asked[k].square;
      }
    if (!most) continue;
    worst.push_back(k);
    own.push_back(alone ? 1 : 0);
  }
  for (std::size_t i = 0; i < worst.size(); ++i) {
    asked[worst[i]].speaks = false;
    asked[worst[i]].result.own = own[i] != 0;
  }
  return !worst.empty();
}

void closeLoops(std::vector<Asked>& asked, const Graph& graph) {
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const std::vector<std::size_t> way = graph.wayAround(k);
    if (way.empty()) continue;
    Pose around;
    int scan = asked[k].tie.fixed;
    for (const std::size_t next : way) {
      const Pose& measured = asked[next].tie.link->fixed_from_moving;
      around = around * (asked[next].tie.fixed == scan ? measured : measured.inverse());
      scan = graph.otherEnd(next, scan);
    }
    asked[k].result.misclosure = difference(around, asked[k].tie.link->fixed_from_moving);
    asked[k].result.loop = static_cast<int>(way.size()) + 1;
  }
}

}  // namespace

std::vector<LinkAgreement> linkAgreements(const ProjectSnapshot& snapshot,
                                          const JudgementSettings& settings) {
  return linkAgreements(snapshot, snapshot.links(), settings);
}

std::vector<LinkAgreement> linkAgreements(const ProjectSnapshot& snapshot, const std::vector<Link>& links,
                                          const JudgementSettings& settings) {
  std::vector<Asked> asked = askedLinks(snapshot, links, settings);
  const std::size_t count = snapshot.scans().size();
  if (asked.empty()) return {};
  const std::vector<Pose> start = snapshot.filledPoses(Stage::Odometry);
  closeLoops(asked, Graph(asked, count));
  // What a tie set aside with others contradicted by: without them nothing may be left that speaks about it.
  std::vector<LinkAgreement> at_last(asked.size());
  for (int round = 0; round < kMostRounds; ++round) {
    const Graph graph(asked, count);
    if (!askAll(asked, graph, count, start)) return {};
    for (std::size_t k = 0; k < asked.size(); ++k) {
      if (!asked[k].speaks && !asked[k].result.own) continue;
      if (asked[k].result.supported || !at_last[k].supported) at_last[k] = asked[k].result;
    }
    if (!setAside(asked, graph, settings)) break;
    for (std::size_t k = 0; k < asked.size(); ++k) at_last[k].own = asked[k].result.own;
  }
  std::vector<LinkAgreement> agreements;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    LinkAgreement told = at_last[k];
    told.link = asked[k].result.link;
    told.misclosure = asked[k].result.misclosure;
    told.loop = asked[k].result.loop;
    agreements.push_back(told);
  }
  return agreements;
}

}  // namespace tiltmap
