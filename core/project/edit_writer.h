// The steps of an edit, as changes to the tables.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/project/database.h"
#include "core/project/project_edit.h"

namespace tiltmap {

// Used inside one transaction, which the caller rolls back when a step throws StoreFailure.
class EditWriter {
 public:
  explicit EditWriter(const Database& database) : database_(database) {}
  void write(const ProjectEdit& edit);

 private:
  void apply(const AddScan& step);
  void apply(const DeleteScans& step);
  void apply(const RenameScan& step);
  void apply(const SetNote& step);
  void apply(const SetColour& step);
  void apply(const ReorderScans& step);
  void apply(const SetGeometry& step);
  void apply(const SetBodyMask& step);
  void apply(const AddPhotograph& step);
  void apply(const RemovePhotograph& step);
  void apply(const AddLinks& step);
  void apply(const DeleteLinks& step);
  void apply(const SetLinkState& step);
  void apply(const SetLinkJudgements& step);
  void apply(const SetPoses& step);
  void apply(const ClearPoses& step);
  void apply(const SetSurvey& step);
  void apply(const SetPins& step);
  void apply(const SetSitePicture& step);
  void setSurveyEntry(const char* key, const std::string& value);  // empty: takes it out
  void addJob(const JobRecord& job);
  void addPhotograph(ScanId scan, const NewPhotograph& photograph);
  void setPose(ScanId scan, Stage stage, const Pose& pose);

  // With what it rests on now; nothing where there is no judgement.
  std::optional<std::string> judgementText(const PairJudgement* judgement, ScanId fixed, ScanId moving,
                                           const Pose& fixed_from_moving) const;

  // The scan's id, placeholders resolved; throws where the project has no such scan.
  ScanId resolved(ScanId scan) const;
  void requireLink(LinkId link) const;

  const Database& database_;
  std::vector<ScanId> added_;
};

}  // namespace tiltmap
