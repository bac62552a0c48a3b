// How commands talk: results to standard output, everything else to standard error, one JSON object on
// request.
#pragma once

#include <chrono>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace tiltmap::cli {

enum ExitCode { kDone = 0, kFailed = 1, kWrongUsage = 2 };

// The flags that every command takes.
struct OutputFlags {
  bool json = false;
  bool quiet = false;
  bool verbose = false;
};

class Console {
 public:
  explicit Console(OutputFlags flags);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  bool json() const { return flags_.json; }
  bool verbose() const { return flags_.verbose; }

  // The command's result. Text is for people and left out with --json; the object is printed only with it.
  void print(const std::string& text);
  void printJson(const nlohmann::json& object);
  // A remark on standard error, left out with --quiet; `detail` only with --verbose.
  void note(const std::string& text);
  void detail(const std::string& text);
  void warn(const std::string& text);
  // what, where, remedy on standard error; with --json the error object on standard output as well.
  int failed(const Error& error);
  int wrongUsage(const Error& error);

  // Progress goes to standard error where that is a terminal; stop follows Ctrl-C.
  JobControl job(std::stop_token stop);
  void endProgress();

 private:
  void showProgress(const Progress& progress);
  int report(const Error& error, int code);

  OutputFlags flags_;
  bool terminal_ = false;
  bool colour_ = false;
  bool line_open_ = false;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point started_;
  std::chrono::steady_clock::time_point shown_;
};

// Warnings as they stand in a JSON result: always an array.
nlohmann::json warningsJson(const std::vector<std::string>& warnings);

// Collects SIGINT and SIGTERM on a thread of its own and turns them into a stop request; a second one ends
// the program at once (what the project file had accepted is on disk by then).
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::stop_source quit_;
  std::thread listener_;
};

}  // namespace tiltmap::cli
