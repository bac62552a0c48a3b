#include "ui/models/preferences.h"

#include <QDir>
#include <algorithm>

#include "core/project/job_record.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr int kRecentFiles = 10;
constexpr const char* kRecent = "files/recent";
const QStringList kThemeNames = {"system", "light", "dark", "high-contrast"};
const QStringList kUnitNames = {"m", "mm", "ft"};

}  // namespace

Preferences::Preferences(QObject* parent)
    : QObject(parent), settings_(QSettings::IniFormat, QSettings::UserScope, "tiltmap", "tiltmap") {}

Preferences::Preferences(const QString& file, QObject* parent)
    : QObject(parent), settings_(file, QSettings::IniFormat) {}

ThemeChoice Preferences::theme() const {
  const auto place = kThemeNames.indexOf(settings_.value("look/theme").toString());
  return place < 0 ? ThemeChoice::System : static_cast<ThemeChoice>(place);
}

void Preferences::setTheme(ThemeChoice choice) {
  if (choice == theme()) return;
  settings_.setValue("look/theme", kThemeNames[static_cast<int>(choice)]);
  Q_EMIT themeChanged();
}

LengthUnit Preferences::lengthUnit() const {
  const auto place = kUnitNames.indexOf(settings_.value("look/length-unit").toString());
  return place < 0 ? LengthUnit::Metre : static_cast<LengthUnit>(place);
}

void Preferences::setLengthUnit(LengthUnit unit) {
  if (unit == lengthUnit()) return;
  settings_.setValue("look/length-unit", kUnitNames[static_cast<int>(unit)]);
  Q_EMIT unitsChanged();
}

int Preferences::threads() const {
  return std::clamp(settings_.value("work/threads", 0).toInt(), 0, 256);
}

void Preferences::setThreads(int threads) {
  settings_.setValue("work/threads", threads);
}

QStringList Preferences::recentFiles() const {
  return settings_.value(kRecent).toStringList();
}

void Preferences::addRecentFile(const QString& path) {
  const QString full = QDir::cleanPath(QDir::current().absoluteFilePath(path));
  QStringList files = recentFiles();
  files.removeAll(full);
  files.prepend(full);
  while (files.size() > kRecentFiles) files.removeLast();
  settings_.setValue(kRecent, files);
  Q_EMIT recentFilesChanged();
}

void Preferences::removeRecentFile(const QString& path) {
  QStringList files = recentFiles();
  files.removeAll(path);
  settings_.setValue(kRecent, files);
  Q_EMIT recentFilesChanged();
}

void Preferences::clearRecentFiles() {
  settings_.remove(kRecent);
  Q_EMIT recentFilesChanged();
}

LastParameters Preferences::lastParameters(const QString& operation) const {
  LastParameters last;
  last.preset = settings_.value("operations/" + operation + "/preset").toString();
  const QString json = settings_.value("operations/" + operation + "/values").toString();
  // A file of another version, or edited by hand: what cannot be read is as if never stored.
  if (auto values = parametersFromJson(utf8(json))) last.values = std::move(*values);
  return last;
}

void Preferences::setLastParameters(const QString& operation, const LastParameters& last) {
  settings_.setValue("operations/" + operation + "/preset", last.preset);
  settings_.setValue("operations/" + operation + "/values", qt(parametersToJson(last.values)));
}

QByteArray Preferences::bytes(const QString& key) const {
  return settings_.value(key).toByteArray();
}

void Preferences::setBytes(const QString& key, const QByteArray& bytes) {
  settings_.setValue(key, bytes);
}

QString Preferences::text(const QString& key, const QString& otherwise) const {
  return settings_.value(key, otherwise).toString();
}

void Preferences::setText(const QString& key, const QString& text) {
  settings_.setValue(key, text);
}

void Preferences::forgetLayouts() {
  settings_.remove("layout");
}

}  // namespace tiltmap::ui
