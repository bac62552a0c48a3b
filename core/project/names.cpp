// The words that files, flags and tables use for the project's enumerations.
#include <array>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/project/job_record.h"
#include "core/project/link.h"
#include "core/project/stage.h"

namespace tiltmap {

namespace {

// Position in the table is the enumerator's value.
template <std::size_t N>
using Names = std::array<std::string, N>;

template <class Enum, std::size_t N>
Result<Enum> parsed(const Names<N>& names, const std::string& name, const std::string& kind) {
  for (std::size_t i = 0; i < N; ++i)
    if (names[i] == name) return static_cast<Enum>(i);
  const std::vector<std::string> all(names.begin(), names.end());
  const auto nearest = nearestName(name, all);
  return fail(
      "there is no " + kind + " \"" + name + "\"", "",
      (nearest ? "did you mean " + *nearest + "? " : std::string()) + "choose one of: " + joined(all, ", "));
}

const Names<4>& stages() {
  static const Names<4> names = {"truth", "odometry", "pairwise", "relaxed"};
  return names;
}
const Names<3>& origins() {
  static const Names<3> names = {"odometry", "automatic", "by-hand"};
  return names;
}
const Names<2>& states() {
  static const Names<2> names = {"active", "disabled"};
  return names;
}
const Names<6>& jobStates() {
  static const Names<6> names = {"running", "waiting", "failed", "cancelled", "accepted", "discarded"};
  return names;
}

}  // namespace

const std::string& stageName(Stage stage) {
  return stages().at(static_cast<std::size_t>(stage));
}
Result<Stage> parseStage(const std::string& name) {
  return parsed<Stage>(stages(), name, "stage");
}
const std::string& linkOriginName(LinkOrigin origin) {
  return origins().at(static_cast<std::size_t>(origin));
}
Result<LinkOrigin> parseLinkOrigin(const std::string& name) {
  return parsed<LinkOrigin>(origins(), name, "link origin");
}
const std::string& linkStateName(LinkState state) {
  return states().at(static_cast<std::size_t>(state));
}
Result<LinkState> parseLinkState(const std::string& name) {
  return parsed<LinkState>(states(), name, "link state");
}
const std::string& jobStateName(JobState state) {
  return jobStates().at(static_cast<std::size_t>(state));
}
Result<JobState> parseJobState(const std::string& name) {
  return parsed<JobState>(jobStates(), name, "job state");
}

}  // namespace tiltmap
