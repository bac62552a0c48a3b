#include "ui/actions/demo_project.h"

#include <QDir>
#include <QFileInfo>
#include <QStandardPaths>

#include "ui/models/workspace.h"

namespace tiltmap::ui {

QString demoProjectPath() {
  return QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation) + "/tiltmap/demo.tiltmap";
}

void openDemo(Workspace& workspace) {
  const QString path = demoProjectPath();
  QDir().mkpath(QFileInfo(path).absolutePath());
  ProjectSession& session = workspace.session();
  if (QFileInfo::exists(path)) {
    if (!session.open(path)) return;
  } else if (!session.create(path)) {
    return;
  }
  // Also where making it was cancelled the last time.
  if (!session.isWritable() || !session.snapshot()->scans().empty()) return;
  SurveyInfo survey;
  survey.site = "Tiltmap demo";
  if (!session.apply(surveyEdit(survey))) return;
  JobRequest simulate, registering;
  simulate.operation = operations().find("simulate");
  simulate.values = {{"experiment", std::string("exp2fixed")}, {"seed", 1LL}};
  registering.operation = operations().find("register");
  workspace.startAll({simulate, registering});
}

}  // namespace tiltmap::ui
