#include "core/registration/sampling.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/base/random.h"

namespace tiltmap {

namespace {

// The first `count` of a shuffle (Fisher and Yates).
void shuffleFront(std::vector<std::uint32_t>& indices, std::size_t count, RandomStream& random) {
  for (std::size_t i = 0; i < count; ++i)
    std::swap(indices[i], indices[i + static_cast<std::size_t>(random.below(indices.size() - i))]);
}

// Normals in 6 faces of a cube with 4 x 4 cells each; one element of each cell in turn until there are
// enough.
std::vector<std::uint32_t> spreadOverNormals(const SurfaceElements& elements, std::size_t wanted,
                                             RandomStream& random) {
  constexpr int kCells = 4;
  std::vector<std::vector<std::uint32_t>> buckets(6 * kCells * kCells);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Eigen::Vector3d& n = elements.normal[i];
    if (n.isZero()) continue;
    int axis = 0;
    const double largest = n.cwiseAbs().maxCoeff(&axis);
    const auto cell = [&](double x) {
      return std::clamp(static_cast<int>((x / largest + 1.0) * 0.5 * kCells), 0, kCells - 1);
    };
    const int face = 2 * axis + (n[axis] < 0.0 ? 1 : 0);
    const int bucket = (face * kCells + cell(n[(axis + 1) % 3])) * kCells + cell(n[(axis + 2) % 3]);
    buckets[static_cast<std::size_t>(bucket)].push_back(static_cast<std::uint32_t>(i));
  }
  for (auto& bucket : buckets) shuffleFront(bucket, bucket.size(), random);
  std::vector<std::uint32_t> chosen;
  for (std::size_t turn = 0; chosen.size() < wanted; ++turn) {
    const std::size_t before = chosen.size();
    for (const auto& bucket : buckets)
      if (turn < bucket.size() && chosen.size() < wanted) chosen.push_back(bucket[turn]);
    if (chosen.size() == before) break;  // no element is left
  }
  return chosen;
}

}  // namespace

std::vector<std::uint32_t> sampledElements(const SurfaceElements& elements,
                                           const RegistrationSettings& settings) {
  if (settings.sampling_step < 1) throw std::invalid_argument("sampledElements: the step must be at least 1");
  const std::size_t size = elements.size();
  const auto step = static_cast<std::size_t>(settings.sampling_step);
  const std::size_t wanted = (size + step - 1) / step;
  RandomStream random(static_cast<std::uint64_t>(settings.seed));
  std::vector<std::uint32_t> chosen;
  switch (settings.sampling) {
    case Sampling::All:
      chosen.resize(size);
      std::iota(chosen.begin(), chosen.end(), 0U);
      break;
    case Sampling::Uniform:
      for (std::size_t i = 0; i < size; i += step) chosen.push_back(static_cast<std::uint32_t>(i));
      break;
    case Sampling::Random:
      chosen.resize(size);
      std::iota(chosen.begin(), chosen.end(), 0U);
      shuffleFront(chosen, wanted, random);
      chosen.resize(wanted);
      break;
    case Sampling::NormalSpace:
      chosen = spreadOverNormals(elements, wanted, random);
      break;
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace tiltmap
