#include "tests/ui/models/model_samples.h"

namespace tiltmap::test {

using namespace ui;

class SessionTest : public WorkspaceTest {};

TEST_F(SessionTest, TellsWhatAnEditChanged) {
  makeProject(2);
  std::vector<Change> changes;
  QObject::connect(&workspace.session(), &ProjectSession::changed,
                   [&](const Change& c) { changes.push_back(c); });
  must(workspace.session().apply(renameEdit(id(1), "yard")));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].scans_changed, std::vector<ScanId>{id(1)});
  EXPECT_EQ(nameOf(1), "yard");
}

TEST_F(SessionTest, UndoesRedoesAndGoesToAnyState) {
  makeProject(2);
  for (const char* name : {"a", "b", "c"}) must(workspace.session().apply(renameEdit(id(0), name)));
  EXPECT_NE(workspace.session().undoTitle(), "");
  must(workspace.session().undo());
  EXPECT_EQ(nameOf(0), "b");
  EXPECT_TRUE(workspace.session().canRedo());
  must(workspace.session().redo());
  EXPECT_EQ(nameOf(0), "c");
  EXPECT_EQ(workspace.session().redoTitle(), "");
  must(workspace.session().goTo(2));  // import and the first rename
  EXPECT_EQ(nameOf(0), "a");
  must(workspace.session().goTo(4));
  EXPECT_EQ(nameOf(0), "c");
}

TEST_F(SessionTest, OpensForReadingWhatAnotherOneWrites) {
  makeProject(1);
  ProjectSession other;
  must(other.open(workspace.session().path()));
  EXPECT_TRUE(other.isOpen());
  EXPECT_FALSE(other.isWritable());
  EXPECT_FALSE(other.apply(renameEdit(id(0), "mine")));
  must(workspace.session().apply(renameEdit(id(0), "theirs")));
  EXPECT_NE(other.snapshot()->scans()[0].name, "theirs");
  must(other.refresh());
  EXPECT_EQ(other.snapshot()->scans()[0].name, "theirs");
}

TEST_F(SessionTest, SaysWhyAFileCannotBeOpenedAndKeepsTheOldProject) {
  makeProject(1);
  const QString before = workspace.session().path();
  EXPECT_FALSE(workspace.session().open(qt(folder.write("words.tiltmap", "not a project"))));
  EXPECT_EQ(workspace.session().path(), before);
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(shown.back().kind, MessageKind::Error);
  EXPECT_FALSE(shown.back().remedy.isEmpty());
}

TEST_F(SessionTest, GoesOnInTheCopy) {
  makeProject(1);
  must(workspace.session().saveAs(qt(folder / "copy.tiltmap")));
  EXPECT_EQ(workspace.session().name(), "copy");
  must(workspace.session().apply(renameEdit(id(0), "only here")));
  ProjectSession original;
  must(original.open(qt(folder / "survey.tiltmap")));
  EXPECT_NE(original.snapshot()->scans()[0].name, "only here");
}

TEST_F(SessionTest, ClosingLeavesNothingToUse) {
  makeProject(1);
  workspace.session().close();
  EXPECT_FALSE(workspace.session().isOpen());
  EXPECT_EQ(workspace.snapshot(), nullptr);
  EXPECT_FALSE(workspace.session().undo());
  EXPECT_FALSE(workspace.session().canUndo());
  EXPECT_EQ(workspace.session().name(), "");
}

TEST_F(SessionTest, RemembersWhatWasOpened) {
  makeProject(0, "first.tiltmap");
  makeProject(0, "second.tiltmap");
  ASSERT_EQ(preferences.recentFiles().size(), 2);
  EXPECT_TRUE(preferences.recentFiles()[0].endsWith("second.tiltmap"));
}

}  // namespace tiltmap::test
