#include "core/multiview/pose_graph.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/multiview/pose_system.h"

namespace tiltmap {

namespace {

// Thirty metres and radians, beside what links tell: what they leave free stays, and is known to be free.
constexpr double kDamping = 1e-3;
constexpr double kAtRest_m = 1e-6;
constexpr double kAtRest_rad = 1e-7;
constexpr int kMostSteps = 20;

Matrix6d excessInformation(const PoseGraphSettings& settings) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(1.0 / (settings.excess_rad * settings.excess_rad)),
      Eigen::Vector3d::Constant(1.0 / (settings.excess_m * settings.excess_m));
  return d.asDiagonal();
}

// (H^-1 + D^-1)^-1 = D - D (H + D)^-1 D: both deviations together, also where H lacks rank.
Matrix6d widened(const Matrix6d& h, const Matrix6d& d) {
  const Matrix6d wide = d - d * Matrix6d(h + d).ldlt().solve(d);
  return 0.5 * (wide + wide.transpose());
}

class Graph {
 public:
  Graph(const std::vector<Pose>& starts, const std::vector<char>& held, const std::vector<GraphLink>& links,
        const PoseGraphSettings& settings)
      : poses_(starts), held_(held), links_(links), settings_(settings), used_(links.size()) {
    const Matrix6d excess = excessInformation(settings);
    for (std::size_t k = 0; k < links.size(); ++k) {
      information_.push_back(widened(links[k].information, excess));
      used_[k] = links[k].doubted ? 0 : 1;
    }
  }

  Result<PoseGraphResult> solve() {
    PoseGraphResult result;
    result.misclosure.assign(links_.size(), 0.0);
    if (Status status = settle(); !status) return fail(status.error());
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      if (!links_[k].doubted) continue;
      const auto miss = misclosure(k);
      if (!miss) return fail(miss.error());
      order.emplace_back(*miss, k);
    }
    std::ranges::sort(order);
    for (const auto& [at_first, k] : order) {
      const auto miss = misclosure(k);
      if (!miss) return fail(miss.error());
      result.misclosure[k] = *miss;
      if (*miss > settings_.false_beyond) {
        result.rejected.push_back(static_cast<int>(k));
        continue;
      }
      used_[k] = 1;
      if (Status status = settle(); !status) return fail(status.error());
    }
    std::ranges::sort(result.rejected);
    result.poses = poses_;
    return result;
  }

 private:
  Pose now(const GraphLink& link) const {
    return poses_[static_cast<std::size_t>(link.fixed)].inverse() *
           poses_[static_cast<std::size_t>(link.moving)];
  }

  std::vector<PairTerm> terms() const {
    std::vector<PairTerm> list;
    for (std::size_t k = 0; k < links_.size(); ++k)
      if (used_[k])
        list.push_back(measuredPoseTerm(links_[k].fixed, links_[k].moving, now(links_[k]),
                                        links_[k].fixed_from_moving, information_[k]));
    return list;
  }

  // Gauss-Newton steps until nothing moves any more.
  Status settle() {
    for (int i = 0; i < kMostSteps; ++i) {
      const std::vector<PairTerm> ties = terms();
      std::vector<char> held = held_;
      const std::vector<char> tied = tiedToHeld(poses_.size(), held_, ties);
      for (std::size_t p = 0; p < held.size(); ++p)
        if (!tied[p]) held[p] = 1;
      const auto motions = solvePoses(poses_.size(), held, ties, kDamping);
      if (!motions) return fail(motions.error());
      double moved_m = 0.0, moved_rad = 0.0;
      for (std::size_t p = 0; p < poses_.size(); ++p) {
        if (held[p]) continue;
        poses_[p] = poses_[p] * Pose().moved((*motions)[p]);
        moved_rad = std::max(moved_rad, (*motions)[p].head<3>().norm());
        moved_m = std::max(moved_m, (*motions)[p].tail<3>().norm());
      }
      if (moved_m < kAtRest_m && moved_rad < kAtRest_rad) break;
    }
    return {};
  }

  // The square of the deviations by which a link misses the graph, with the covariances of both. The graph's
  // covariance of the motion J xi between the two poses is J H^-1 J^T, one column a solution with J^T e as
  // the right side.
  Result<double> misclosure(std::size_t k) const {
    const GraphLink& link = links_[k];
    const Pose between = now(link);
    const Matrix6d ad = adjoint(between);
    std::vector<PairTerm> ties = terms();
    for (PairTerm& term : ties) term.b.setZero();
    ties.push_back({link.fixed, link.moving, between, Matrix6d::Zero(), Vector6d::Zero()});
    Matrix6d covariance;
    for (int column = 0; column < 6; ++column) {
      ties.back().b = Vector6d::Unit(column);
      const auto motions = solvePoses(poses_.size(), held_, ties, kDamping);
      if (!motions) return fail(motions.error());
      covariance.col(column) = (*motions)[static_cast<std::size_t>(link.fixed)] -
                               ad * (*motions)[static_cast<std::size_t>(link.moving)];
    }
    const Pose motion = between * link.fixed_from_moving.inverse();
    Vector6d off;
    off << rotationLog(motion.quaternion()), motion.translation();
    // (C + W^-1)^-1 = W - W (C^-1 + W)^-1 W = (I + W C)^-1 W: W may lack rank.
    const Matrix6d both =
        (Matrix6d::Identity() + information_[k] * covariance).partialPivLu().solve(information_[k]);
    return std::max(0.0, off.dot(both * off));
  }

  std::vector<Pose> poses_;
  const std::vector<char>& held_;
  const std::vector<GraphLink>& links_;
  const PoseGraphSettings& settings_;
  std::vector<Matrix6d> information_;
  std::vector<char> used_;
};

}  // namespace

Result<PoseGraphResult> solvePoseGraph(const std::vector<Pose>& starts, const std::vector<char>& held,
                                       const std::vector<GraphLink>& links,
                                       const PoseGraphSettings& settings) {
  if (held.size() != starts.size()) throw std::invalid_argument("solvePoseGraph: not as many of both");
  const int count = static_cast<int>(starts.size());
  for (const GraphLink& link : links)
    if (link.fixed < 0 || link.fixed >= count || link.moving < 0 || link.moving >= count ||
        link.fixed == link.moving)
      throw std::invalid_argument("solvePoseGraph: a link joins no two of the poses");
  return Graph(starts, held, links, settings).solve();
}

}  // namespace tiltmap
