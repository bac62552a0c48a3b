#include "ui/models/log.h"

#include <QDir>
#include <QFileInfo>
#include <QStandardPaths>
#include <mutex>

#include <spdlog/logger.h>
#include <spdlog/sinks/rotating_file_sink.h>
#include <spdlog/spdlog.h>

#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr std::size_t kBytesPerFile = 2 * 1000 * 1000;
constexpr std::size_t kFiles = 3;

struct LogState {
  std::mutex mutex;
  std::shared_ptr<spdlog::logger> file;
  QString path;
  std::function<void(const LogLine&)> listener;
};

LogState& state() {
  static LogState instance;
  return instance;
}

spdlog::level::level_enum spdlogLevel(LogLevel level) {
  switch (level) {
    case LogLevel::Debug:
      return spdlog::level::debug;
    case LogLevel::Info:
      return spdlog::level::info;
    case LogLevel::Warning:
      return spdlog::level::warn;
    case LogLevel::Error:
      return spdlog::level::err;
  }
  return spdlog::level::info;
}

}  // namespace

QString logLevelName(LogLevel level) {
  switch (level) {
    case LogLevel::Debug:
      return "debug";
    case LogLevel::Info:
      return "info";
    case LogLevel::Warning:
      return "warning";
    case LogLevel::Error:
      return "error";
  }
  return {};
}

QString standardLogFilePath() {
  return QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation) + "/tiltmap/tiltmap.log";
}

QString openLogFile(const QString& path) {
  QDir().mkpath(QFileInfo(path).absolutePath());
  const std::lock_guard lock(state().mutex);
  try {
    auto sink = std::make_shared<spdlog::sinks::rotating_file_sink_mt>(utf8(path), kBytesPerFile, kFiles - 1);
    auto logger = std::make_shared<spdlog::logger>("tiltmap", std::move(sink));
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
    state().file = std::move(logger);
    state().path = path;
  } catch (const spdlog::spdlog_ex& error) {
    return qt(std::string(error.what()));
  }
  return {};
}

void closeLogFile() {
  const std::lock_guard lock(state().mutex);
  if (state().file) state().file->flush();
  state().file.reset();
  state().path.clear();
}

QString logFilePath() {
  const std::lock_guard lock(state().mutex);
  return state().path;
}

void logLine(LogLevel level, const QString& text) {
  std::function<void(const LogLine&)> listener;
  {
    const std::lock_guard lock(state().mutex);
    if (state().file) {
      // As an argument: the text may hold braces.
      state().file->log(spdlogLevel(level), "{}", utf8(text));
      state().file->flush();
    }
    listener = state().listener;
  }
  if (listener) listener({QDateTime::currentDateTime(), level, text});
}

void setLogListener(std::function<void(const LogLine&)> listener) {
  const std::lock_guard lock(state().mutex);
  state().listener = std::move(listener);
}

}  // namespace tiltmap::ui
