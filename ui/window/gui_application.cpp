#include "ui/window/gui_application.h"

#include <QApplication>
#include <QFileInfo>
#include <QSurfaceFormat>
#include <QTimer>
#include <QVTKOpenGLNativeWidget.h>
#include <cstdlib>
#include <string_view>
#include <xcb/xcb.h>

#include "core/base/version.h"
#include "ui/look/icons.h"
#include "ui/look/theme.h"
#include "ui/models/log.h"
#include "ui/models/log_model.h"
#include "ui/models/strings.h"
#include "ui/window/main_window.h"

namespace tiltmap::ui {

namespace {

void logFromQt(QtMsgType type, const QMessageLogContext&, const QString& text) {
  const LogLevel level = type == QtDebugMsg     ? LogLevel::Debug
                         : type == QtInfoMsg    ? LogLevel::Info
                         : type == QtWarningMsg ? LogLevel::Warning
                                                : LogLevel::Error;
  logLine(level, "Qt: " + text);
}

void closeEverything() {
  for (QWidget* widget : QApplication::topLevelWidgets())
    if (auto* window = qobject_cast<MainWindow*>(widget)) window->closeNow();
  QApplication::quit();
}

}  // namespace

Status displayThere() {
  const char* platform = std::getenv("QT_QPA_PLATFORM");
  const std::string_view named = platform ? platform : "";
  if (!named.empty() && !named.starts_with("xcb")) return {};  // offscreen, wayland: as the user says
  if (std::getenv("WAYLAND_DISPLAY")) return {};
  const char* display = std::getenv("DISPLAY");
  if (!display || !*display)
    return fail("there is no display to open a window on", "DISPLAY",
                "work at a desktop, or use the commands, which need none: `tiltmap --help`");
  xcb_connection_t* connection = xcb_connect(nullptr, nullptr);
  const bool broken = xcb_connection_has_error(connection) != 0;
  xcb_disconnect(connection);
  if (broken)
    return fail("the display cannot be reached", std::string("DISPLAY=") + display,
                "check that it is running and that you may use it; the commands need none: `tiltmap --help`");
  return {};
}

void prepareApplication() {
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
  QApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);  // slow where software draws, and points gain nothing
  QSurfaceFormat::setDefaultFormat(format);
}

void nameApplication() {
  QApplication::setApplicationName("tiltmap");
  QApplication::setApplicationDisplayName({});
  QApplication::setApplicationVersion(qt(programVersion()));
  QApplication::setDesktopFileName("tiltmap");
}

int runWindow(int& argc, char** argv, const std::string& project, const std::stop_token& stop) {
  prepareApplication();
  QApplication application(argc, argv);
  nameApplication();

  const QString trouble = openLogFile(standardLogFilePath());
  sharedLogModel();
  qInstallMessageHandler(logFromQt);
  logLine(LogLevel::Info, "Tiltmap " + qt(programVersion()) + " started");
  if (!trouble.isEmpty()) logLine(LogLevel::Warning, "no log file: " + trouble);

  Preferences preferences;
  Theme theme(preferences);
  QApplication::setWindowIcon(icon("tiltmap"));
  auto* window = new MainWindow(preferences, theme);
  window->show();
  if (!project.empty())
    QTimer::singleShot(0, window,
                       [window, project] { (void)window->workspace().session().open(qt(project)); });
  // Called on the thread that waits for signals.
  const std::stop_callback on_stop(stop, [&application] {
    QMetaObject::invokeMethod(&application, closeEverything, Qt::QueuedConnection);
  });
  const int code = QApplication::exec();
  QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);  // windows go before what they look at
  logLine(LogLevel::Info, "closed");
  qInstallMessageHandler(nullptr);
  closeLogFile();
  return code;
}

}  // namespace tiltmap::ui
