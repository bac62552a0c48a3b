// What the project remembers of a computation: enough to repeat it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/parameter.h"

namespace tiltmap {

enum class JobState { Running, Waiting, Failed, Cancelled, Accepted, Discarded };

const std::string& jobStateName(JobState state);  // "running", "waiting", ...
Result<JobState> parseJobState(const std::string& name);

struct JobRecord {
  std::int64_t id = 0;     // given by the project; 0 before
  std::string operation;   // Operation::id()
  std::string preset;      // the preset the values were set on top of
  ParameterValues values;  // every parameter, defaults included: defaults of later versions may differ
  std::string program_version;
  std::string started;  // UTC, ISO 8601 with milliseconds
  std::string finished;
  JobState state = JobState::Running;
  std::vector<std::string> warnings;
};

// "2031-04-05T06:07:08.901Z"
std::string utcNow();

// Values as a JSON object and back (keys sorted; integers, reals, booleans and texts keep their kind).
std::string parametersToJson(const ParameterValues& values);
Result<ParameterValues> parametersFromJson(const std::string& json);

}  // namespace tiltmap
