// The site map and the link table, without a widget.
#include <cmath>

#include "core/products/png.h"
#include "core/registration/pair_judgement.h"
#include "tests/ui/models/model_samples.h"
#include "ui/models/link_table_model.h"
#include "ui/models/site_map_model.h"

namespace tiltmap::test {

using namespace ui;

class SiteModelsTest : public WorkspaceTest {
 protected:
  // A square of 10 m, driven round; links that fit it, but for one.
  void SetUp() override {
    auto scans = sampleScans(4);
    const double places[4][2] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    for (std::size_t i = 0; i < 4; ++i)
      scans[i].odometry = Pose::planar(places[i][0], places[i][1], 0.5 * static_cast<double>(i));
    must(workspace.session().create(qt(folder / "survey.tiltmap")));
    must(workspace.session().apply(importEdit(std::move(scans))));
    std::vector<Link> links = {fitting(0, 1), fitting(1, 2), fitting(2, 3), fitting(0, 3), fitting(0, 2)};
    links[4].fixed_from_moving = Pose::planar(0.5, 0.2, 0.0) * links[4].fixed_from_moving;
    ProjectEdit edit{"links", {AddLinks{links, true}}, nullptr, {}, {}};
    must(workspace.session().apply(edit));
  }
  Link fitting(std::size_t a, std::size_t b) {
    const auto poses = snapshot().filledPoses(Stage::Odometry);
    Link link = sampleLink(id(a), id(b));
    link.fixed_from_moving = poses[a].inverse() * poses[b];
    link.information = Matrix6d::Identity() * 1e6;
    PairJudgement judged;
    judged.verdict = Verdict::Good;
    judged.badness = 0.5;
    judged.reason = "fits";
    judged.overlap_moving = 0.42, judged.fit = 0.93;
    judged.residual_m = 0.0051;
    judged.strength = strengthOf(*link.information, link.fixed_from_moving);
    link.judgement = std::make_shared<const PairJudgement>(judged);
    return link;
  }
  LinkId link(std::size_t k) { return snapshot().links()[k].id; }
};

TEST_F(SiteModelsTest, TheMapHasStopsHeadingsAndLinks) {
  SiteMapModel map(workspace);
  ASSERT_EQ(map.stops().size(), 4U);
  EXPECT_EQ(map.stops()[2].place_m, QPointF(10, 10));
  EXPECT_NEAR(map.stops()[0].heading.y(), 1.0, 1e-9);
  EXPECT_LT(map.stops()[1].heading.x(), 0.0) << "turned to the left";
  EXPECT_TRUE(map.stops()[0].pinned) << "scan 0 never moves";
  ASSERT_EQ(map.links().size(), 5U);
  EXPECT_EQ(map.links()[0].quality, LinkQuality::Good);
  EXPECT_EQ(map.links()[4].quality, LinkQuality::Bad);
  EXPECT_EQ(map.bounds(), QRectF(QPointF(0, 0), QPointF(10, 10)));
  EXPECT_EQ(map.stopAt({9.8, 0.1}, 0.5), id(1));
  EXPECT_FALSE(map.stopAt({5, 5}, 0.5));
  EXPECT_EQ(map.linkAt({5, 0.1}, 0.3), link(0));
  EXPECT_EQ(map.linkAt({4, 4.1}, 0.3), link(4));
  EXPECT_FALSE(map.linkAt({5, 2}, 0.3));
}

TEST_F(SiteModelsTest, TheMapFollowsSelectionVisibilityAndProposals) {
  SiteMapModel map(workspace);
  int changes = 0, places = 0;
  QObject::connect(&map, &SiteMapModel::changed, [&] { ++changes; });
  QObject::connect(&map, &SiteMapModel::placesChanged, [&] { ++places; });
  workspace.selection().setCurrentScan(id(3));
  EXPECT_TRUE(map.stops()[3].selected);
  workspace.selection().setLinks({link(1)});
  EXPECT_TRUE(map.links()[1].selected);
  workspace.display().setVisible({id(2)}, false);
  EXPECT_FALSE(map.stops()[2].visible);
  workspace.display().setRoles({{id(1), RelaxationRole::Aligning}});
  EXPECT_EQ(map.stops()[1].role, RelaxationRole::Aligning);
  workspace.display().propose({{id(2), Pose::planar(12, 11, 0)}});
  EXPECT_EQ(map.stops()[2].place_m, QPointF(12, 11));
  workspace.display().withdraw();
  EXPECT_EQ(map.stops()[2].place_m, QPointF(10, 10));
  EXPECT_GE(changes, 6);
  EXPECT_EQ(places, 0) << "the same stops: the view need not fit anew";
  must(workspace.session().apply(deleteEdit(snapshot(), {id(1)})));
  EXPECT_EQ(places, 1);
  EXPECT_EQ(map.stops().size(), 3U);
  workspace.session().close();
  EXPECT_TRUE(map.stops().empty());
  EXPECT_TRUE(map.links().empty());
}

TEST_F(SiteModelsTest, TheWindowOfTheMapZoomsAtThePointer) {
  MapWindow window{{0, 0}, 10.0, {200, 100}};
  EXPECT_EQ(window.pixelOf({0, 0}), QPointF(100, 50));
  EXPECT_EQ(window.pixelOf({1, 1}), QPointF(110, 40)) << "ahead is up";
  const QPointF at(30, 80), world = window.worldOf(at);
  window.zoomAt(at, 3.0);
  EXPECT_NEAR(window.px_per_m, 30.0, 1e-9);
  EXPECT_LT(std::hypot(window.worldOf(at).x() - world.x(), window.worldOf(at).y() - world.y()), 1e-9);
  window.panBy({15, -7});
  EXPECT_LT(std::hypot(window.pixelOf(world).x() - 45, window.pixelOf(world).y() - 73), 1e-9);
  window.fit(QRectF(QPointF(-5, -5), QPointF(5, 5)));
  EXPECT_NEAR(window.pixelOf({5, 5}).y(), 36.0, 1e-6);
  EXPECT_NEAR(roundLength(7.3), 5.0, 1e-12);
  EXPECT_NEAR(roundLength(0.024), 0.02, 1e-12);
  EXPECT_NEAR(roundLength(130.0), 100.0, 1e-12);
  EXPECT_EQ(roundLength(-1.0), 0.0);
}

TEST_F(SiteModelsTest, APictureIsPlacedShownAndUndone) {
  const auto file = folder / "aerial.png";
  must(writePng(file, RgbImage(60, 40, Rgb{20, 90, 30})));
  SiteMapModel map(workspace);
  EXPECT_FALSE(map.addPicture(qt(folder / "nothing.png")));
  EXPECT_FALSE(map.sitePicture());
  must(map.addPicture(qt(file)));
  ASSERT_TRUE(map.placement());
  EXPECT_EQ(map.picture().size(), QSize(60, 40));
  for (const MapStop& stop : map.stops()) {
    const Eigen::Vector2d px = map.placement()->pictureOf({stop.place_m.x(), stop.place_m.y()});
    EXPECT_TRUE(px.x() >= 0 && px.x() <= 60 && px.y() >= 0 && px.y() <= 40) << "it covers the stops";
  }
  EXPECT_GT(map.bounds(true).width(), map.bounds().width());
  must(map.placePicture({{{{0, 40}, {0, 0}}, {{60, 40}, {30, 0}}}}));
  EXPECT_NEAR(map.placement()->metresPerPixel(), 0.5, 1e-12);
  EXPECT_FALSE(map.placePicture({{{{0, 40}, {0, 0}}, {{0, 40}, {30, 0}}}}));
  must(workspace.session().undo());
  EXPECT_NE(map.placement()->metresPerPixel(), 0.5);
  must(map.removePicture());
  EXPECT_FALSE(map.placement());
  EXPECT_TRUE(map.picture().isNull());
  must(workspace.session().undo());
  EXPECT_EQ(map.picture().size(), QSize(60, 40));
  must(workspace.session().undo());
  EXPECT_FALSE(map.placement());
}

TEST_F(SiteModelsTest, TheLinkTableKnowsTheWorstLink) {
  LinkTableModel table(workspace);
  ASSERT_EQ(table.rowCount(), 5);
  EXPECT_EQ(table.summary(), "5 links: 4 good, 1 bad");
  const auto badness = [&](int row) {
    return table.index(row, LinkTableModel::Quality).data(LinkTableModel::kSortRole).toDouble();
  };
  for (int row = 0; row < 4; ++row) EXPECT_LT(badness(4), badness(row)) << "ascending, the worst comes first";
  EXPECT_EQ(table.index(0, LinkTableModel::Pair).data().toString(), "0 – 1");
  EXPECT_EQ(table.index(4, LinkTableModel::Quality).data().toString(), "bad");
  EXPECT_NEAR(table.index(4, LinkTableModel::Off).data().toDouble(), 538.5, 0.1);
  const QString tip = table.index(4, LinkTableModel::Pair).data(Qt::ToolTipRole).toString();
  EXPECT_TRUE(tip.contains("is bad: the other links put it 54 cm")) << tip.toStdString();
  EXPECT_TRUE(tip.contains("Overlap: 42 %")) << tip.toStdString();
  const auto cell = [&](LinkTableModel::Column column) { return table.index(0, column).data().toString(); };
  EXPECT_EQ(cell(LinkTableModel::Overlap), "42");
  EXPECT_EQ(cell(LinkTableModel::Fit), "93");
  EXPECT_EQ(cell(LinkTableModel::Residual), "5.1");
  EXPECT_EQ(cell(LinkTableModel::Correspondences), QString::number(snapshot().links()[0].correspondences));
  EXPECT_NEAR(table.index(4, LinkTableModel::Others).data().toDouble(), 538.5, 0.5);
  EXPECT_GT(table.index(4, LinkTableModel::Times).data().toDouble(), 5.0);
  EXPECT_NEAR(table.index(4, LinkTableModel::Loop).data().toDouble(), 538.5, 0.5);
  EXPECT_TRUE(table.index(0, LinkTableModel::Without).data().toString().isEmpty());
}

TEST_F(SiteModelsTest, WhatIfSaysWhatTheOthersSayAndChangesNothing) {
  LinkTableModel table(workspace);
  SiteMapModel map(workspace);
  const auto revision = snapshot().revision();
  EXPECT_FALSE(table.ask({}));
  EXPECT_FALSE(table.ask({4711}));
  must(table.ask({link(4)}));
  ASSERT_TRUE(table.whatIf());
  EXPECT_EQ(table.leftOut(), std::vector<LinkId>{link(4)});
  EXPECT_EQ(table.index(4, LinkTableModel::State).data().toString(), "left out");
  EXPECT_NEAR(table.index(4, LinkTableModel::Without).data().toDouble(), 538.5, 0.2)
      << "the others put it where it was";
  EXPECT_LT(table.index(0, LinkTableModel::Without).data().toDouble(), 0.5);
  EXPECT_GT(table.index(0, LinkTableModel::With).data().toDouble(), 10.0);
  EXPECT_TRUE(table.whatIfSentence().contains("contradicts"));
  EXPECT_TRUE(map.stops()[2].ghost_m);
  EXPECT_TRUE(map.links()[4].left_out);
  EXPECT_EQ(snapshot().revision(), revision);
  table.endAsking();
  EXPECT_FALSE(table.whatIf());
  must(table.ask({link(0)}));
  must(workspace.session().apply(linkStateEdit(link(4), LinkState::Disabled)));
  EXPECT_FALSE(table.whatIf()) << "an edit ends the question";
  EXPECT_FALSE(map.stops()[2].ghost_m);
  EXPECT_EQ(table.summary(), "5 links: 4 good, 1 disabled");
}

TEST_F(SiteModelsTest, LinksAreHeldAgainstEachOtherOnlyWhenTheyChange) {
  LinkTableModel table(workspace);
  SiteMapModel map(workspace);
  const int first = workspace.linkOpinions().computed();
  workspace.display().setStage(Stage::Odometry);
  must(workspace.session().apply(renameEdit(id(0), "yard")));
  EXPECT_EQ(workspace.linkOpinions().computed(), first) << "nothing that concerns them";
  EXPECT_EQ(map.links()[4].quality, LinkQuality::Bad);
  must(workspace.session().apply(linkStateEdit(link(3), LinkState::Disabled)));
  EXPECT_EQ(workspace.linkOpinions().computed(), first + 1);
  must(workspace.session().apply(linkStateEdit(link(3), LinkState::Active)));
  must(workspace.session().apply(
      ProjectEdit{"forget", {SetLinkJudgements{{{link(0), nullptr}}}}, nullptr, {}, {}}));
  EXPECT_EQ(workspace.linkOpinions().computed(), first + 3);
  EXPECT_EQ(map.links()[0].quality, LinkQuality::NotJudged);
  EXPECT_EQ(table.index(0, LinkTableModel::Overlap).data().toString(), "–");
}

TEST_F(SiteModelsTest, AQuestionEndsWithTheTableThatAskedIt) {
  auto table = std::make_unique<LinkTableModel>(workspace);
  must(table->ask({link(4)}));
  EXPECT_FALSE(workspace.display().ghosts().empty());
  table.reset();
  EXPECT_TRUE(workspace.display().ghosts().empty());
  EXPECT_TRUE(workspace.display().leftOut().empty());
}

}  // namespace tiltmap::test
