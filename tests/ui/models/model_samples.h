// A workspace on a small project, without a window.
#pragma once

#include <QCoreApplication>
#include <QElapsedTimer>

#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::test {

// What takes longer has come to nothing; no measure. Sanitizers slow a relaxation down by ten times and more.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr qint64 kPatienceMs = 300'000;
#else
inline constexpr qint64 kPatienceMs = 20'000;
#endif

// Runs the event loop until the condition holds; false when it does not within kPatienceMs.
template <class Condition>
bool waitUntil(const Condition& condition) {
  QElapsedTimer clock;
  clock.start();
  while (!condition()) {
    if (clock.elapsed() > kPatienceMs) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents, 10);
  }
  return true;
}

class WorkspaceTest : public ::testing::Test {
 protected:
  WorkspaceTest() : preferences(ui::qt(folder / "settings.ini")), workspace(preferences) {
    QObject::connect(&workspace.messages(), &ui::Messages::shown,
                     [this](const ui::Message& message) { shown.push_back(message); });
  }
  // A new project with so many scans.
  void makeProject(int scans, const std::string& name = "survey.tiltmap") {
    must(workspace.session().create(ui::qt(folder / name)));
    if (scans > 0) must(workspace.session().apply(importEdit(sampleScans(scans))));
  }
  const ProjectSnapshot& snapshot() { return *workspace.snapshot(); }
  ScanId id(std::size_t index) { return snapshot().scans()[index].id; }
  std::string nameOf(std::size_t index) { return snapshot().scans()[index].name; }

  TemporaryFolder folder;
  ui::Preferences preferences;
  ui::Workspace workspace;
  std::vector<ui::Message> shown;
};

}  // namespace tiltmap::test
