#include "app/cli/console.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <signal.h>
#include <unistd.h>

namespace tiltmap::cli {

Console::Console(OutputFlags flags)
    : flags_(flags),
      terminal_(isatty(STDERR_FILENO) != 0),
      colour_(terminal_ && std::getenv("NO_COLOR") == nullptr),
      started_(std::chrono::steady_clock::now()) {}

Console::~Console() {
  endProgress();
}

void Console::print(const std::string& text) {
  endProgress();
  if (!flags_.json) std::cout << text << (text.ends_with('\n') ? "" : "\n") << std::flush;
}

void Console::printJson(const nlohmann::json& object) {
  endProgress();
  // File names need not be UTF-8; what is not becomes a replacement character instead of an exception.
  if (flags_.json)
    std::cout << object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n" << std::flush;
}

void Console::note(const std::string& text) {
  endProgress();
  if (!flags_.quiet) std::cerr << text << "\n";
}

void Console::detail(const std::string& text) {
  if (flags_.verbose) note(text);
}

void Console::warn(const std::string& text) {
  endProgress();
  if (!flags_.quiet) std::cerr << (colour_ ? "\033[33mWarning:\033[0m " : "Warning: ") << text << "\n";
}

int Console::failed(const Error& error) {
  return report(error, kFailed);
}
int Console::wrongUsage(const Error& error) {
  return report(error, kWrongUsage);
}

int Console::report(const Error& error, int code) {
  endProgress();
  std::cerr << (colour_ ? "\033[31mError:\033[0m " : "Error: ") << error.what << "\n";
  if (!error.where.empty()) std::cerr << "  where:      " << error.where << "\n";
  if (!error.remedy.empty()) std::cerr << "  what to do: " << error.remedy << "\n";
  printJson({{"error", {{"what", error.what}, {"where", error.where}, {"remedy", error.remedy}}}});
  return code;
}

JobControl Console::job(std::stop_token stop) {
  JobControl control;
  control.stop = std::move(stop);
  if (terminal_ && !flags_.quiet)
    control.report = [this](const Progress& progress) { showProgress(progress); };
  return control;
}

void Console::showProgress(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (line_open_ && now - shown_ < std::chrono::milliseconds(80)) return;
  shown_ = now;
  std::array<char, 64> bar{};
  if (progress.fraction >= 0.0) {
    constexpr int kWidth = 24;
    const int filled = static_cast<int>(std::lround(std::min(1.0, progress.fraction) * kWidth));
    std::snprintf(bar.data(), bar.size(), "[%.*s%.*s] %3d%%  ", filled, "########################",
                  kWidth - filled, "........................",
                  static_cast<int>(std::lround(100.0 * std::min(1.0, progress.fraction))));
  }
  std::fprintf(stderr, "\r\033[K%s%s", bar.data(), progress.message.c_str());
  std::fflush(stderr);
  line_open_ = true;
}

void Console::endProgress() {
  const std::lock_guard lock(mutex_);
  if (line_open_) std::fprintf(stderr, "\r\033[K");
  line_open_ = false;
}

nlohmann::json warningsJson(const std::vector<std::string>& warnings) {
  nlohmann::json list = nlohmann::json::array();
  for (const std::string& warning : warnings) list.push_back(warning);
  return list;
}

StopOnSignal::StopOnSignal() {
  // Blocked in every thread (this runs before any other is made), so that only the listener receives them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  listener_ = std::thread([signals, source = source_, quit = quit_.get_token()]() mutable {
    const timespec wait{0, 50'000'000};
    while (!quit.stop_requested()) {
      if (sigtimedwait(&signals, nullptr, &wait) < 0) continue;
      if (source.stop_requested()) _exit(kFailed);
      source.request_stop();
    }
  });
}

StopOnSignal::~StopOnSignal() {
  quit_.request_stop();
  listener_.join();
}

}  // namespace tiltmap::cli
