// How far apart two scans are in links.
#pragma once

#include <vector>

#include "core/multiview/joint_links.h"

namespace tiltmap {

// How many links lead from one scan to another: those that fit, and every scan to the next.
class LinkCounter {
 public:
  LinkCounter(std::size_t scans, const std::vector<JointLink>& links) : next_(scans) {
    for (const JointLink& link : links)
      if (link.used) join(link.fixed, link.moving);
    for (int i = 1; i < static_cast<int>(scans); ++i) join(i - 1, i);
  }

  void join(int a, int b) {
    next_[static_cast<std::size_t>(a)].push_back(b);
    next_[static_cast<std::size_t>(b)].push_back(a);
  }

  int linksBetween(int from, int to) const {
    std::vector<int> steps(next_.size(), -1);
    std::vector<int> open{from};
    steps[static_cast<std::size_t>(from)] = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (open[k] == to) break;
      for (const int next : next_[static_cast<std::size_t>(open[k])]) {
        if (steps[static_cast<std::size_t>(next)] >= 0) continue;
        steps[static_cast<std::size_t>(next)] = steps[static_cast<std::size_t>(open[k])] + 1;
        open.push_back(next);
      }
    }
    return steps[static_cast<std::size_t>(to)];
  }

 private:
  std::vector<std::vector<int>> next_;
};

}  // namespace tiltmap
