// File dialogs that block nothing: the answer comes by a call.
#pragma once

#include <QString>
#include <QStringList>
#include <functional>

class QFileDialog;
class QWidget;

namespace tiltmap::ui {

class Preferences;

enum class FileQuestion { OpenOne, OpenMany, Save };

struct FileAsked {
  FileQuestion question = FileQuestion::OpenOne;
  QString title;
  QString filter;  // "Projects (*.tiltmap)"
  QString suffix;  // added to a name without one, when saving
  QString key;     // each key remembers its folder
  QString name;    // proposed, when saving
};

// Nothing is called when the user changes their mind. Files that exist are not asked about here: what would
// replace one says so itself.
QFileDialog* askForFiles(QWidget* parent, Preferences& preferences, const FileAsked& asked,
                         std::function<void(const QStringList&)> answer);

inline constexpr const char* kProjectFilter = "Tiltmap projects (*.tiltmap);;All files (*)";
inline constexpr const char* kScanFilter =
    "Scans (*.pcd *.ply *.ptx *.xyz *.csv *.txt *.vtk *.3d);;All files (*)";

}  // namespace tiltmap::ui
