// A workspace on a small project, without a window.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/wait_until.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::test {

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
