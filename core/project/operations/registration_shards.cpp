#include "core/project/operations/registration_shards.h"

#include <algorithm>
#include <chrono>

#include "core/base/text.h"
#include "core/base/version.h"

namespace tiltmap {

namespace {

struct ReadPart {
  std::filesystem::path file;
  RegistrationPart part;
};

std::string scansWords(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " scan" : " scans");
}

// The number of threads changes nothing of what is computed.
ParameterValues telling(ParameterValues values) {
  values.erase("threads");
  return values;
}

Status fitsProject(const ProjectSnapshot& snapshot, const std::vector<std::string>& prints,
                   const ReadPart& read) {
  const RegistrationPart& part = read.part;
  if (part.project_id != snapshot.projectId())
    return fail("this part is of another project", read.file.string(),
                "name the parts that were made of " + snapshot.path().filename().string());
  if (part.program_version != programVersion())
    return fail("this part was made by Tiltmap " + part.program_version +
                    ", which may compute other bits than " + programVersion(),
                read.file.string(), "make the parts again, with the same version on all machines");
  if (part.scans.size() != prints.size())
    return fail("this part knows " + scansWords(part.scans.size()) + ", the project has " +
                    std::to_string(prints.size()) + " now",
                read.file.string(), "make the parts again from the project as it is");
  const auto differs = std::ranges::mismatch(part.scans, prints).in1;
  if (differs != part.scans.end())
    return fail("scan " + std::to_string(differs - part.scans.begin()) +
                    " has other measurements, another geometry or another odometry since this part was made",
                read.file.string(), "make the parts again from the project as it is");
  return {};
}

Status fitsOthers(const ReadPart& first, const ReadPart& read) {
  if (read.part.shard.n != first.part.shard.n)
    return fail("this is part " + shardName(read.part.shard) + ", but " + first.file.string() + " is part " +
                    shardName(first.part.shard) + ": they are not of one whole",
                read.file.string(), "name the parts of one and the same splitting");
  const ParameterValues ours = telling(read.part.values), theirs = telling(first.part.values);
  for (const auto& [name, value] : ours)
    if (const auto other = theirs.find(name); other == theirs.end() || other->second != value)
      return fail("this part was made with " + name + " " + parameterText(value) + ", " +
                      first.file.string() + " with " +
                      (other == theirs.end() ? "none" : parameterText(other->second)),
                  read.file.string(), "make all parts with the same parameters");
  if (ours.size() != theirs.size())
    return fail("this part was made with other parameters than " + first.file.string(), read.file.string(),
                "make all parts with the same parameters");
  return {};
}

// Sorted by their number; each there, once.
Status complete(const std::vector<ReadPart>& parts) {
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (parts[i].part.shard == parts[i - 1].part.shard)
      return fail(
          "part " + shardName(parts[i].part.shard) + " is there twice: also in " + parts[i - 1].file.string(),
          parts[i].file.string(), "name each part once");
  const int count = parts.front().part.shard.n;
  std::vector<std::string> missing;
  for (int k = 1; k <= count; ++k)
    if (std::ranges::find(parts, k, [](const ReadPart& read) { return read.part.shard.k; }) == parts.end())
      missing.push_back(shardName({k, count}));
  if (missing.empty()) return {};
  const std::string first = missing.front();
  const bool one = missing.size() == 1;
  if (missing.size() > 8) missing.resize(8), missing.emplace_back("...");
  return fail((one ? "part " : "parts ") + joined(missing, ", ") + (one ? " is missing" : " are missing"),
              "the parts named",
              "name " + std::string(one ? "it" : "them") + " too; `tiltmap register --shard " + first +
                  " --out FILE` makes " + (one ? "it" : "the first of them"));
}

Status holdsItsPairs(const std::vector<IndexPair>& pairs, const ReadPart& read) {
  const auto expected = pairsOfShard(pairs, read.part.shard);
  const bool same = std::ranges::equal(expected, read.part.pairs, [](const IndexPair& a, const auto& b) {
    return a.first == b.fixed && a.second == b.moving;
  });
  if (same) return {};
  return fail("this part does not hold the pairs that part " + shardName(read.part.shard) + " is made of",
              read.file.string(), "make this part again with `tiltmap register --shard`");
}

Result<std::vector<ReadPart>> readParts(const ProjectSnapshot& snapshot,
                                        const std::vector<std::filesystem::path>& files) {
  const std::vector<std::string> prints = scanPrints(snapshot);
  std::vector<ReadPart> parts;
  for (const std::filesystem::path& file : files) {
    auto part = readRegistrationPart(file);
    if (!part) return fail(part.error());
    parts.push_back({file, std::move(*part)});
    if (Status status = fitsProject(snapshot, prints, parts.back()); !status) return fail(status.error());
    if (Status status = fitsOthers(parts.front(), parts.back()); !status) return fail(status.error());
  }
  std::ranges::stable_sort(parts, {}, [](const ReadPart& read) { return read.part.shard.k; });
  if (Status status = complete(parts); !status) return fail(status.error());
  return parts;
}

JobRecord recordOf(const std::vector<ReadPart>& parts, const std::vector<std::string>& warnings) {
  JobRecord record;
  record.operation = registerParameters().operation();
  record.preset = parts.front().part.preset;
  record.values = parts.front().part.values;
  record.program_version = programVersion();
  record.started =
      std::ranges::min(parts, {}, [](const ReadPart& read) { return read.part.started; }).part.started;
  record.finished =
      std::ranges::max(parts, {}, [](const ReadPart& read) { return read.part.finished; }).part.finished;
  record.state = JobState::Accepted;
  record.warnings = warnings;
  return record;
}

}  // namespace

Result<RegistrationPart> registerShard(const SnapshotPtr& snapshot, const std::string& preset,
                                       const ParameterValues& values, const Shard& shard,
                                       const JobControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  const Operation& operation = *operations().find(registerParameters().operation());
  auto complete = operation.completed(preset, values);
  if (!complete) return fail(complete.error());
  if (Status status = operation.check(*snapshot, *complete); !status) return fail(status.error());
  RegisterSettings settings;
  if (Status status = registerParameters().apply(*complete, settings); !status) return fail(status.error());
  auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot->scans().size()));
  if (!pairs) return fail(pairs.error());

  RegistrationPart part;
  part.program_version = programVersion();
  part.project_id = snapshot->projectId();
  part.shard = shard;
  part.preset = preset;
  part.values = std::move(*complete);
  part.scans = scanPrints(*snapshot);
  part.started = utcNow();
  auto found = registerPairs(*snapshot, pairsOfShard(*pairs, shard), settings, control);
  if (!found) return fail(found.error());
  part.pairs = std::move(*found);
  part.finished = utcNow();
  part.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return part;
}

Result<OperationResult> mergeRegistrationParts(const SnapshotPtr& snapshot,
                                               const std::vector<std::filesystem::path>& files) {
  if (files.empty())
    return fail("no part is named", "merge", "name the files that the parts were written to");
  auto parts = readParts(*snapshot, files);
  if (!parts) return fail(parts.error());
  RegisterSettings settings;
  if (Status status = registerParameters().apply(parts->front().part.values, settings); !status)
    return fail(status.error());
  auto pairs = parsePairList(settings.pairs, static_cast<int>(snapshot->scans().size()));
  if (!pairs) return fail(pairs.error());
  std::vector<RegisteredPair> found;
  double milliseconds = 0.0;
  for (ReadPart& read : *parts) {
    if (Status status = holdsItsPairs(*pairs, read); !status) return fail(status.error());
    milliseconds += read.part.milliseconds;
    std::ranges::move(read.part.pairs, std::back_inserter(found));
  }
  OperationResult outcome = registeredOutcome(snapshot, found, milliseconds);
  outcome.edit.jobs.push_back(recordOf(*parts, outcome.warnings));
  return outcome;
}

}  // namespace tiltmap
