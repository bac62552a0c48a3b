#include "core/multiview/overlap_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/parallel.h"

namespace tiltmap {

namespace {

using Cells = std::vector<std::uint64_t>;  // ascending, each once

Cells cellsOf(const SurfaceElements& elements, const Pose& world_from_scan, double cell_m) {
  const Eigen::Matrix3d rotation = world_from_scan.rotation();
  const Eigen::Vector3d shift = world_from_scan.translation();
  const double inverse = 1.0 / cell_m;
  const auto part = [&](double x) {
    return static_cast<std::uint64_t>(
        static_cast<std::int64_t>(std::floor(std::clamp(x * inverse, -1e6, 1e6))) & 0x1fffff);
  };
  Cells cells;
  cells.reserve(elements.size());
  for (const Eigen::Vector3d& p : elements.position) {
    const Eigen::Vector3d world = rotation * p + shift;
    cells.push_back(part(world.x()) << 42 | part(world.y()) << 21 | part(world.z()));
  }
  std::ranges::sort(cells);
  const auto rest = std::ranges::unique(cells);
  cells.erase(rest.begin(), rest.end());
  return cells;
}

struct Entry {
  std::uint64_t cell;
  int scan;
  auto operator<=>(const Entry&) const = default;
};

struct Candidate {
  double share;
  int other;
};

}  // namespace

std::vector<std::pair<int, int>> overlapCandidates(std::span<const PreparedScanPtr> scans,
                                                   std::span<const Pose> world_from_scan,
                                                   const RelaxationSettings& settings, int threads) {
  const std::size_t count = scans.size();
  std::vector<Cells> cells(count);
  parallelFor(count, threads, [&](std::size_t i) {
    cells[i] = cellsOf(scans[i]->elements, world_from_scan[i], settings.cell_m);
  });
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < count; ++i)
    for (const std::uint64_t cell : cells[i]) entries.push_back({cell, static_cast<int>(i)});
  std::ranges::sort(entries);

  std::vector<std::vector<std::pair<int, int>>> wanted(count);
  parallelFor(count, threads, [&](std::size_t i) {
    const int self = static_cast<int>(i);
    std::vector<int> shared(count, 0);
    std::vector<int> touched;
    for (const std::uint64_t cell : cells[i]) {
      auto entry = std::ranges::lower_bound(entries, Entry{cell, -1});
      for (; entry != entries.end() && entry->cell == cell; ++entry)
        if (entry->scan != self && shared[static_cast<std::size_t>(entry->scan)]++ == 0)
          touched.push_back(entry->scan);
    }
    std::vector<Candidate> candidates;
    for (const int other : touched) {
      const auto smaller = std::min(cells[i].size(), cells[static_cast<std::size_t>(other)].size());
      const double share =
          static_cast<double>(shared[static_cast<std::size_t>(other)]) / static_cast<double>(smaller);
      if (share >= settings.min_shared_cells) candidates.push_back({share, other});
      if (other == self + 1) wanted[i].emplace_back(self, other);
    }
    std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
      return a.share != b.share ? a.share > b.share : a.other < b.other;
    });
    if (candidates.size() > static_cast<std::size_t>(settings.max_links_per_scan))
      candidates.resize(static_cast<std::size_t>(settings.max_links_per_scan));
    for (const Candidate& c : candidates)
      wanted[i].emplace_back(std::min(self, c.other), std::max(self, c.other));
  });

  std::vector<std::pair<int, int>> pairs;
  for (const auto& list : wanted) pairs.insert(pairs.end(), list.begin(), list.end());
  std::ranges::sort(pairs);
  const auto rest = std::ranges::unique(pairs);
  pairs.erase(rest.begin(), rest.end());
  return pairs;
}

}  // namespace tiltmap
