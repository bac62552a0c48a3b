// Selection, display, preferences, units, log.
#include <QFile>

#include "tests/ui/models/model_samples.h"
#include "ui/models/log_model.h"

namespace tiltmap::test {

using namespace ui;

class SharedStateTest : public WorkspaceTest {};

TEST_F(SharedStateTest, SelectionForgetsWhatIsDeleted) {
  makeProject(3);
  Selection& selection = workspace.selection();
  selection.setScans({id(0), id(2)}, id(2));
  selection.setPicked(CellPlace{id(2), 1, 1});
  must(workspace.session().apply(deleteEdit(snapshot(), {id(2)})));
  EXPECT_EQ(selection.scans(), std::vector<ScanId>{id(0)});
  EXPECT_EQ(selection.currentScan(), id(0));
  EXPECT_FALSE(selection.picked());
}

TEST_F(SharedStateTest, SettingTheSameSaysNothing) {
  Selection selection;
  int said = 0;
  for (auto signal : {&Selection::scansChanged, &Selection::hoveredChanged})
    QObject::connect(&selection, signal, [&] { ++said; });
  selection.setScans({1, 2}, 1);
  selection.setHovered(CellPlace{1, 2, 3});
  EXPECT_EQ(said, 2);
  selection.setScans({1, 2}, 1);
  selection.setHovered(CellPlace{1, 2, 3});
  EXPECT_EQ(said, 2);
  selection.setScans({1, 2}, 2);
  EXPECT_EQ(said, 3);
}

TEST_F(SharedStateTest, ShowsOnlyWhatIsAskedFor) {
  makeProject(3);
  ScanDisplay& display = workspace.display();
  display.showOnly({id(1)});
  EXPECT_FALSE(display.isVisible(id(0)));
  EXPECT_TRUE(display.isVisible(id(1)));
  display.setVisible({id(0)}, true);
  EXPECT_TRUE(display.isVisible(id(0)));
  display.showAll();
  EXPECT_TRUE(display.isVisible(id(2)));
  EXPECT_NE(display.colour(id(0)), display.colour(id(1)));
}

TEST_F(SharedStateTest, FollowsTheLatestStageUnlessOneIsChosen) {
  makeProject(3);
  ScanDisplay& display = workspace.display();
  EXPECT_EQ(display.stage(), Stage::Odometry);
  must(workspace.session().apply(sampleRegister(workspace.snapshot())));
  EXPECT_EQ(display.stage(), Stage::Pairwise);
  display.setStage(Stage::Odometry);
  EXPECT_EQ(display.stage(), Stage::Odometry);
  display.setStage(Stage::Relaxed);
  EXPECT_EQ(display.stage(), Stage::Pairwise) << "a stage that is not there shows the latest";
}

TEST(Preferences, LastFromOneRunToTheNext) {
  const TemporaryFolder folder;
  const QString file = qt(folder / "settings.ini");
  {
    Preferences preferences(file);
    preferences.setTheme(ThemeChoice::Dark);
    preferences.setLengthUnit(LengthUnit::Foot);
    preferences.setThreads(3);
    preferences.setLastParameters("register",
                                  {"thesis", {{"max-angle", 12.5}, {"pairs", std::string("1:2")}}});
    preferences.setBytes("layout/inspect", QByteArray("\0\1\2", 3));
    for (int i = 0; i < 14; ++i) preferences.addRecentFile(QString("/surveys/%1.tiltmap").arg(i));
    preferences.addRecentFile("/surveys/9.tiltmap");
  }
  Preferences preferences(file);
  EXPECT_EQ(preferences.theme(), ThemeChoice::Dark);
  EXPECT_EQ(preferences.lengthUnit(), LengthUnit::Foot);
  EXPECT_EQ(preferences.threads(), 3);
  const LastParameters last = preferences.lastParameters("register");
  EXPECT_EQ(last.preset, "thesis");
  EXPECT_EQ(std::get<double>(last.values.at("max-angle")), 12.5);
  EXPECT_EQ(preferences.bytes("layout/inspect").size(), 3);
  EXPECT_EQ(preferences.recentFiles().size(), 10);
  EXPECT_EQ(preferences.recentFiles().front(), "/surveys/9.tiltmap");
  EXPECT_EQ(preferences.recentFiles().count("/surveys/9.tiltmap"), 1);
  preferences.forgetLayouts();
  EXPECT_TRUE(preferences.bytes("layout/inspect").isEmpty());
}

TEST(Preferences, NonsenseInTheFileIsAsIfNotThere) {
  const TemporaryFolder folder;
  Preferences preferences(qt(folder.write(
      "settings.ini", "[look]\ntheme=plaid\n[work]\nthreads=-7\n[operations]\nregister\\values={{{\n")));
  EXPECT_EQ(preferences.theme(), ThemeChoice::System);
  EXPECT_EQ(preferences.threads(), 0);
  EXPECT_TRUE(preferences.lastParameters("register").values.empty());
}

TEST(Units, ShowLengthsAsTheUserReadsThem) {
  EXPECT_EQ(lengthText(1.2345, LengthUnit::Metre), "1.234 m");
  EXPECT_EQ(lengthText(1.2346, LengthUnit::Millimetre), "1235 mm");
  EXPECT_EQ(lengthText(0.3048, LengthUnit::Foot), "1.000 ft");
  EXPECT_EQ(smallLengthText(0.0123, LengthUnit::Metre), "12.3 mm");
  EXPECT_EQ(smallLengthText(2.5, LengthUnit::Metre), "2.500 m");
  EXPECT_EQ(durationText(3.2), "4 s");
  EXPECT_EQ(durationText(130), "2 min 10 s");
  EXPECT_EQ(groupedNumber(350000), "350,000");
}

TEST(Log, GoesToTheFileAndTheModel) {
  const TemporaryFolder folder;
  const QString path = qt(folder / "logs/tiltmap.log");
  ASSERT_EQ(openLogFile(path), "");
  LogModel model;
  logLine(LogLevel::Warning, "braces {} and 100 % are text");
  ASSERT_EQ(model.rowCount(), 1);
  EXPECT_EQ(model.data(model.index(0, LogModel::Level), Qt::DisplayRole), "warning");
  EXPECT_EQ(model.line(0).text, "braces {} and 100 % are text");
  EXPECT_EQ(logFilePath(), path);
  closeLogFile();
  EXPECT_NE(bytesOf(folder / "logs/tiltmap.log").find("warning braces {} and 100 % are text"),
            std::string::npos);
}

TEST(Log, SaysWhyThereIsNoFile) {
  const TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_NE(openLogFile(qt(folder / "file/tiltmap.log")), "");
}

}  // namespace tiltmap::test
