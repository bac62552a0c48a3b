// What the program remembers about its user between runs.
#pragma once

#include <QByteArray>
#include <QObject>
#include <QSettings>
#include <QStringList>

#include "core/base/parameter.h"
#include "ui/models/units.h"

namespace tiltmap::ui {

// HighContrast: black on white with large controls, for sunlight and gloves.
enum class ThemeChoice { System, Light, Dark, HighContrast };

// The parameters an operation was last started with.
struct LastParameters {
  QString preset;          // empty: never started
  ParameterValues values;  // what differed from the preset
};

class Preferences : public QObject {
  Q_OBJECT

 public:
  explicit Preferences(QObject* parent = nullptr);                       // the user's own file
  explicit Preferences(const QString& file, QObject* parent = nullptr);  // another file, for tests

  QString file() const { return settings_.fileName(); }

  ThemeChoice theme() const;
  void setTheme(ThemeChoice choice);
  LengthUnit lengthUnit() const;
  void setLengthUnit(LengthUnit unit);
  // Threads that operations are started with; 0: all cores.
  int threads() const;
  void setThreads(int threads);

  // Newest first, at most ten; files that have gone are kept (a disk may come back) and shown as gone.
  QStringList recentFiles() const;
  void addRecentFile(const QString& path);
  void removeRecentFile(const QString& path);
  void clearRecentFiles();

  LastParameters lastParameters(const QString& operation) const;
  void setLastParameters(const QString& operation, const LastParameters& last);

  // Window geometry, dock layouts by perspective, folders of file dialogs.
  QByteArray bytes(const QString& key) const;
  void setBytes(const QString& key, const QByteArray& bytes);
  QString text(const QString& key, const QString& otherwise = {}) const;
  void setText(const QString& key, const QString& text);
  // Forgets every dock layout, so that each perspective comes as it was delivered.
  void forgetLayouts();
  void sync() { settings_.sync(); }

 Q_SIGNALS:
  void themeChanged();
  void unitsChanged();
  void recentFilesChanged();

 private:
  QSettings settings_;
};

}  // namespace tiltmap::ui
