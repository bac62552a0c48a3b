// main() of tests that need an application: settings and data of the person at the machine stay out of it.
//
// Unless told otherwise windows are kept off screen, where several test programs at once cannot take the
// focus from each other; with a display (tests/run gives one) 3D is drawn all the same.
#include <QApplication>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

int main(int argc, char** argv) {
  const tiltmap::test::TemporaryFolder home;
  for (const char* name : {"HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_RUNTIME_DIR"})
    ::setenv(name, home.path().c_str(), 1);
  std::filesystem::permissions(home.path(), std::filesystem::perms::owner_all);
  if (!std::getenv("QT_QPA_PLATFORM")) ::setenv("QT_QPA_PLATFORM", "offscreen", 1);
  ::testing::InitGoogleTest(&argc, argv);
  QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
  QApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  const QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
