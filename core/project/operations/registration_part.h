// A part of a survey's registration as a file: made on one machine, put together with the others on another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/project/operations/register_pairs.h"

namespace tiltmap {

// Part k of n, from 1.
struct Shard {
  int k = 1;
  int n = 1;

  bool operator==(const Shard&) const = default;
};
// "2/8". Refuses what is not K/N with 1 <= K <= N <= 100000.
Result<Shard> parseShard(const std::string& text);
std::string shardName(const Shard& shard);  // "2/8"

// The pairs of one part: neighbours in the list stay together, so that few scans are prepared twice. Every
// pair is in exactly one part; with more parts than pairs some are empty.
std::vector<IndexPair> pairsOfShard(const std::vector<IndexPair>& pairs, const Shard& shard);

// What a pair's registration reads of each scan: its identity, measurements, geometry and odometry, by index.
// Equal prints, equal results.
std::vector<std::string> scanPrints(const ProjectSnapshot& snapshot);

struct RegistrationPart {
  std::string program_version;
  std::string project_id;
  Shard shard;
  std::string preset;
  ParameterValues values;          // of the operation `register`, complete
  std::vector<std::string> scans;  // scanPrints
  std::string started;             // UTC, as utcNow()
  std::string finished;
  double milliseconds = 0.0;
  std::vector<RegisteredPair> pairs;
};

// A text file with a checksum; numbers come back with the same bits. Readers never meet half of it. Error:
// the folder cannot be written, or something that is no part lies at `path`.
Status writeRegistrationPart(const RegistrationPart& part, const std::filesystem::path& path);
// Error: it cannot be read, is no part, is damaged, or was written by a newer program.
Result<RegistrationPart> readRegistrationPart(const std::filesystem::path& path);
// By its first line.
bool isRegistrationPart(const std::filesystem::path& path);

}  // namespace tiltmap
