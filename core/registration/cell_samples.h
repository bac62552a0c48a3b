// The points of a range matrix that surfaces are held against in the end, one by one or a few at once.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace tiltmap {

// Scan frame, metres; each the mean of `count` cells. Side by side, so that many are moved at once.
struct CellSamples {
  std::vector<float> x, y, z, count;

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  void add(const Eigen::Vector3d& p, double cells) {
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
    count.push_back(static_cast<float>(cells));
  }
  void clear() {
    for (std::vector<float>* axis : {&x, &y, &z, &count}) axis->clear();
  }
  void append(const CellSamples& other) {
    x.insert(x.end(), other.x.begin(), other.x.end());
    y.insert(y.end(), other.y.begin(), other.y.end());
    z.insert(z.end(), other.z.begin(), other.z.end());
    count.insert(count.end(), other.count.begin(), other.count.end());
  }
  void reserve(std::size_t n) {
    for (std::vector<float>* axis : {&x, &y, &z, &count}) axis->reserve(n);
  }
};

}  // namespace tiltmap
