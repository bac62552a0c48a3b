// A project of three scans with links, poses and a photograph, for tests of what edits do to it.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/project/project.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap::test {

class EditedProject : public ::testing::Test {
 protected:
  void SetUp() override {
    project_ = must(Project::create(path_));
    must(project_->apply(importEdit(sampleScans(3))));
    must(project_->apply(sampleRegister(project_->snapshot())));
    NewPhotograph photograph;
    photograph.caption = "view north";
    photograph.media_type = "image/jpeg";
    photograph.bytes = {1, 2, 3, 0, 255};
    ProjectEdit edit{"photograph", {AddPhotograph{id(0), photograph}}, nullptr, {}, {}};
    must(project_->apply(edit));
  }
  ScanId id(std::size_t index) const { return project_->snapshot()->scans().at(index).id; }
  std::string state() const { return visibleState(*project_->snapshot()); }
  void reopen() {
    project_.reset();
    project_ = must(Project::open(path_, Access::ReadWrite));
  }
  static ProjectEdit single(EditStep step) { return ProjectEdit{"test", {std::move(step)}, nullptr, {}, {}}; }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "p.tiltmap";
  std::unique_ptr<Project> project_;
};

}  // namespace tiltmap::test
