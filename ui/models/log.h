// The program's log: one rotating file, and the same lines for the Log panel.
#pragma once

#include <QDateTime>
#include <QString>
#include <functional>

namespace tiltmap::ui {

enum class LogLevel { Debug, Info, Warning, Error };

QString logLevelName(LogLevel level);  // "debug", "info", "warning", "error"

struct LogLine {
  QDateTime time;
  LogLevel level = LogLevel::Info;
  QString text;
};

// Opens the file (three of 2 MB at most are kept); returns why not where that fails, and the log then lives
// in the panel alone.
QString openLogFile(const QString& path);
void closeLogFile();
QString logFilePath();          // empty while none is open
QString standardLogFilePath();  // in the user's data folder

// Any thread. In the file when it returns.
void logLine(LogLevel level, const QString& text);

// Called for every line, on the thread that logs; one listener.
void setLogListener(std::function<void(const LogLine&)> listener);

}  // namespace tiltmap::ui
