// Tree, history and localisation, as any view would read them.
#include <QAbstractItemModelTester>
#include <QFont>
#include <QMimeData>
#include <memory>

#include "tests/ui/models/model_samples.h"
#include "ui/models/history_model.h"
#include "ui/models/localisation_model.h"
#include "ui/models/project_tree_model.h"

namespace tiltmap::test {

using namespace ui;

class ItemModelsTest : public WorkspaceTest {
 protected:
  static QString cell(const QAbstractItemModel& model, int row, int column, const QModelIndex& parent = {}) {
    return model.index(row, column, parent).data().toString();
  }
};

TEST_F(ItemModelsTest, TreeHoldsScansLinksAndStages) {
  ProjectTreeModel tree(workspace);
  const QAbstractItemModelTester tester(&tree, QAbstractItemModelTester::FailureReportingMode::Fatal);
  EXPECT_EQ(tree.rowCount(), 0);
  makeProject(3);
  must(workspace.session().apply(sampleRegister(workspace.snapshot())));
  const QModelIndex scans = tree.groupIndex(TreeItem::Kind::ScansGroup);
  const QModelIndex links = tree.groupIndex(TreeItem::Kind::LinksGroup);
  const QModelIndex stages = tree.groupIndex(TreeItem::Kind::StagesGroup);
  EXPECT_EQ(tree.rowCount(scans), 3);
  EXPECT_EQ(tree.rowCount(links), 2);
  EXPECT_EQ(tree.rowCount(stages), 2);
  EXPECT_EQ(cell(tree, 1, 0, scans), "1  stop 2");
  EXPECT_TRUE(cell(tree, 0, 1, links).contains("12.3 mm, 61 % overlap"));
  EXPECT_EQ(cell(tree, 1, 0, stages), "Pairwise");
  EXPECT_TRUE(cell(tree, 1, 1, stages).contains("shown"));
  EXPECT_EQ(tree.itemAt(tree.indexOfScan(id(2)))->scan, id(2));
  EXPECT_EQ(tree.itemAt(tree.indexOfLink(snapshot().links()[1].id))->link, snapshot().links()[1].id);
}

TEST_F(ItemModelsTest, TheCheckBoxHidesAScan) {
  makeProject(2);
  ProjectTreeModel tree(workspace);
  const QModelIndex scan = tree.indexOfScan(id(0));
  EXPECT_EQ(scan.data(Qt::CheckStateRole), Qt::Checked);
  EXPECT_TRUE(tree.setData(scan, Qt::Unchecked, Qt::CheckStateRole));
  EXPECT_FALSE(workspace.display().isVisible(id(0)));
  EXPECT_EQ(scan.data(Qt::CheckStateRole), Qt::Unchecked);
}

TEST_F(ItemModelsTest, RenamingInTheTreeIsAnEdit) {
  makeProject(2);
  ProjectTreeModel tree(workspace);
  EXPECT_TRUE(tree.setData(tree.indexOfScan(id(1)), "  north gate ", Qt::EditRole));
  EXPECT_EQ(nameOf(1), "north gate");
  EXPECT_FALSE(tree.setData(tree.indexOfScan(id(1)), "   ", Qt::EditRole)) << "a name is not empty";
  must(workspace.session().undo());
  EXPECT_EQ(nameOf(1), "stop 2");
}

TEST_F(ItemModelsTest, DroppingAScanReorders) {
  makeProject(4);
  ProjectTreeModel tree(workspace);
  const auto before = scanIds(snapshot());
  const std::unique_ptr<QMimeData> dragged(tree.mimeData({tree.indexOfScan(before[3])}));
  tree.dropMimeData(dragged.get(), Qt::MoveAction, 1, 0, tree.groupIndex(TreeItem::Kind::ScansGroup));
  EXPECT_EQ(scanIds(snapshot()), (std::vector<ScanId>{before[0], before[3], before[1], before[2]}));
  must(workspace.session().undo());
  EXPECT_EQ(scanIds(snapshot()), before);
  EXPECT_FALSE(
      tree.canDropMimeData(dragged.get(), Qt::MoveAction, 0, 0, tree.groupIndex(TreeItem::Kind::LinksGroup)));
}

TEST_F(ItemModelsTest, AReadOnlyProjectIsNotEdited) {
  makeProject(1);
  Preferences other_preferences(qt(folder / "other.ini"));
  Workspace other(other_preferences);
  must(other.session().open(workspace.session().path()));
  ProjectTreeModel tree(other);
  const QModelIndex scan = tree.indexOfScan(other.snapshot()->scans()[0].id);
  EXPECT_FALSE(tree.flags(scan) & Qt::ItemIsEditable);
  EXPECT_TRUE(tree.flags(scan) & Qt::ItemIsUserCheckable) << "hiding changes no project";
}

TEST_F(ItemModelsTest, HistoryShowsWhereTheProjectStands) {
  makeProject(1);
  HistoryModel history(workspace.session());
  const QAbstractItemModelTester tester(&history, QAbstractItemModelTester::FailureReportingMode::Fatal);
  must(workspace.session().apply(renameEdit(id(0), "a")));
  EXPECT_EQ(history.rowCount(), 3);
  EXPECT_EQ(history.currentRow(), 2);
  must(workspace.session().undo());
  EXPECT_EQ(history.currentRow(), 1);
  EXPECT_EQ(cell(history, 2, HistoryModel::State), "undone");
  EXPECT_EQ(cell(history, 1, HistoryModel::State), "here");
  EXPECT_TRUE(history.index(2, 0).data(Qt::FontRole).value<QFont>().italic());
}

TEST_F(ItemModelsTest, LocalisationShowsTheStageInTheUsersUnit) {
  makeProject(0);
  auto scans = sampleScans(2);
  scans[1].odometry = Pose::planar(1.5, -2.25, 0.0);
  must(workspace.session().apply(importEdit(scans)));
  LocalisationModel table(workspace);
  const QAbstractItemModelTester tester(&table, QAbstractItemModelTester::FailureReportingMode::Fatal);
  EXPECT_EQ(table.rowCount(), 2);
  EXPECT_EQ(cell(table, 1, LocalisationModel::X), "1.500");
  EXPECT_EQ(cell(table, 1, LocalisationModel::HeadingY), "1.0000");
  EXPECT_EQ(table.headerData(LocalisationModel::X, Qt::Horizontal, Qt::DisplayRole), "x (m)");
  preferences.setLengthUnit(LengthUnit::Millimetre);
  EXPECT_EQ(cell(table, 1, LocalisationModel::Y), "-2250");
  EXPECT_EQ(table.headerData(LocalisationModel::Y, Qt::Horizontal, Qt::DisplayRole), "y (mm)");
  EXPECT_TRUE(table.asCsv().contains("1,1.500000,-2.250000")) << "files keep metres";
  EXPECT_EQ(table.columnCount(), LocalisationModel::kColumns);
}

TEST_F(ItemModelsTest, LocalisationShowsErrorsWhereTheTruthIsKnown) {
  makeProject(2);
  LocalisationModel table(workspace);
  EXPECT_EQ(table.summary(), "");
  std::vector<std::pair<ScanId, Pose>> truth;
  for (const ScanEntry& scan : snapshot().scans()) truth.emplace_back(scan.id, scan.odometry());
  // The second stop is 3 cm further ahead than the odometry says, in the frame of the first.
  truth[1].second =
      truth[0].second * Pose::planar(0.0, 0.03, 0.0) * (truth[0].second.inverse() * truth[1].second);
  must(workspace.session().apply(posesEdit(Stage::Truth, truth)));
  ASSERT_EQ(table.columnCount(), LocalisationModel::Angle + 1);
  EXPECT_EQ(cell(table, 1, LocalisationModel::Distance), "30.0");
  EXPECT_EQ(table.summary(), "RMSE 30.0 mm, 0.000° against the truth");
}

TEST_F(ItemModelsTest, LocalisationNamesTheStopsWhoseOdometryTheScansContradict) {
  makeProject(3);
  LocalisationModel table(workspace);
  std::vector<std::pair<ScanId, Pose>> poses;
  for (const ScanEntry& scan : snapshot().scans()) poses.emplace_back(scan.id, scan.odometry());
  must(workspace.session().apply(posesEdit(Stage::Pairwise, poses)));
  EXPECT_EQ(table.summary(), "");
  poses[1].second = poses[1].second * Pose::planar(1.4, 0.0, 0.0);
  must(workspace.session().apply(posesEdit(Stage::Pairwise, poses)));
  EXPECT_EQ(table.summary(), "odometry overruled at stop 1");
  EXPECT_EQ(cell(table, 1, LocalisationModel::Stop), "1 !");
  EXPECT_EQ(cell(table, 2, LocalisationModel::Stop), "2");
  EXPECT_TRUE(
      table.data(table.index(1, 0), Qt::ToolTipRole).toString().contains("odometry of scan 1 was overruled"));
  EXPECT_FALSE(table.data(table.index(2, 0), Qt::ToolTipRole).toString().contains("overruled"));
}

}  // namespace tiltmap::test
