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
  // The first `n` of them.
  void append(const CellSamples& other, std::size_t n) {
    const auto add = [n](std::vector<float>& to, const std::vector<float>& from) {
      to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(n));
    };
    add(x, other.x), add(y, other.y), add(z, other.z), add(count, other.count);
  }
  void resize(std::size_t n) {
    for (std::vector<float>* axis : {&x, &y, &z, &count}) axis->resize(n);
  }
  void reserve(std::size_t n) {
    for (std::vector<float>* axis : {&x, &y, &z, &count}) axis->reserve(n);
  }
};

}  // namespace tiltmap
