// One sweep under way: what its steps share. For sweep.cpp and sweep_steady.cpp alone.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>

#include "hardware/capture/sweep.h"

namespace tiltmap {

using SteadyTime = std::chrono::steady_clock::time_point;

// How often the instruments are looked at. What they say waits no longer than this.
inline constexpr double kLookS = 0.0005;
// Lines on their way to the disk; more than these and the sweep waits for the disk.
inline constexpr std::size_t kUnstored = 16;
// A line that comes to nothing so often in a row is a broken wire, not noise.
inline constexpr int kSpoiledInARow = 12;

inline constexpr const char* kResume = "`tiltmap capture PROJECT --resume` goes on with the next line";

// One sweep under way.
struct Sweep::Run {
  const ScannerGeometry& geometry;
  const Store& store;
  const JobControl& job;
  const SweepEvents& events;
  std::vector<bool> taken;
  SweepReport report{};
  int left = 0;

  int aim = -1;                           // the row the tilt stands at or is on its way to; -1: none yet
  std::optional<TiltReading> standing{};  // there
  // The line on its way: its row and where the tilt stood. The tilt may be off to the next one already.
  struct Coming {
    int row;
    TiltReading reading;
  };
  std::optional<Coming> coming{};

  std::optional<Instant> trouble_since{};  // no line has come since an instrument failed
  Instant last_event{};
  std::optional<Instant> begun{};  // a steady sweep's: the tilt is back from the stop before
  Instant finished{};              // the last byte of the last line
  bool disk_failed = false;
  int spoiled_in_a_row = 0;
  double pause_s = 0.0;

  // Upwards from the row after the last one; from the lowest again where there is none.
  int next() const {
    const auto free = [this](int row) {
      return !taken[static_cast<std::size_t>(row)] && !(coming && coming->row == row);
    };
    for (int row = aim + 1; row < geometry.rows; ++row)
      if (free(row)) return row;
    for (int row = 0; row <= std::min(aim, geometry.rows - 1); ++row)
      if (free(row)) return row;
    return -1;
  }

  // Lines handed over and not yet known to be durable.
  struct Unstored {
    int row;
    SteadyTime since;
    std::future<Status> stored;
  };
  std::deque<Unstored> unstored{};

  // Looks after what has been stored; waits until at most `most` are open.
  Status settleStored(std::size_t most) {
    while (!unstored.empty()) {
      Unstored& first = unstored.front();
      if (unstored.size() <= most &&
          first.stored.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return {};
      // A slow disk must not keep the tilt from being stopped; at the end all of them are waited for.
      while (most > 0 && first.stored.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
        if (job.stopRequested()) return {};
      const Status status = first.stored.get();
      report.slowest_store_s =
          std::max(report.slowest_store_s,
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - first.since).count());
      const int row = first.row;
      unstored.pop_front();
      if (!status) {
        taken[static_cast<std::size_t>(row)] = false;
        return fail(status.error().what, status.error().where,
                    std::string("make room, or mend what keeps the project from being written; the lines "
                                "before are kept, and ") +
                        kResume);
      }
      ++report.taken;
    }
    return {};
  }

  // Steady passes.
  std::optional<Instant> line_end{};  // of the line that came last: when it had been measured
  int empty_passes = 0;

  void handOver(int row, ScanLine line) {
    taken[static_cast<std::size_t>(row)] = true;
    --left;
    spoiled_in_a_row = 0;
    pause_s = 0.0;
    trouble_since.reset();
    if (events.line) events.line(row, geometry.tiltOfRow(row), line);
    unstored.push_back({row, std::chrono::steady_clock::now(), store(row, std::move(line))});
  }

  void tell() const {
    const int have = geometry.rows - left;
    job.tell(static_cast<double>(have) / geometry.rows,
             "line " + std::to_string(have) + " of " + std::to_string(geometry.rows));
  }
};

}  // namespace tiltmap
