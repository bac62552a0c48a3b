// Core speaks UTF-8 std::string, Qt speaks QString; this is the one border.
#pragma once

#include <QString>
#include <filesystem>
#include <string>

namespace tiltmap::ui {

inline QString qt(const std::string& text) {
  return QString::fromUtf8(text.data(), static_cast<int>(text.size()));
}
inline std::string utf8(const QString& text) {
  return text.toStdString();
}
inline std::filesystem::path pathOf(const QString& text) {
  return std::filesystem::u8path(utf8(text));
}
inline QString qt(const std::filesystem::path& path) {
  return qt(path.u8string().empty() ? std::string() : path.string());
}

}  // namespace tiltmap::ui
