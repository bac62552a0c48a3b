// A whole session by mouse and keyboard, whose project is the one that the command line makes.
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QToolButton>

#include <gtest/gtest.h>

#include "core/registration/pair_judgement.h"
#include "tests/support/program.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/models/parameter_model.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/stepper_model.h"
#include "ui/panels/depth_image_panel.h"
#include "ui/panels/links_panel.h"
#include "ui/panels/table_view.h"
#include "ui/window/operation_dialog.h"

namespace tiltmap::test {
namespace {

using namespace ui;

// What a project says but for the clock: when, and how long it took.
std::string timeless(const ProjectSnapshot& snapshot) {
  std::ostringstream out;
  for (const ScanEntry& scan : snapshot.scans()) {
    out << scan.id << " " << scan.name << " " << scan.note << " " << scan.valid_cells << "\n";
    for (const auto& [stage, pose] : scan.poses) out << stageName(stage) << " " << text(pose) << "\n";
    const RangeImagePtr image = must(scan.image());
    for (std::size_t i = 0; i < image->cells(); i += 97)
      out << image->code(i) << ":" << image->range(i) << " ";
    out << "\n";
  }
  for (const Link& link : snapshot.links()) {
    out << link.fixed << "-" << link.moving << " " << text(link.fixed_from_moving) << link.iterations << " "
        << link.correspondences << " " << text(link.rms_m) << " " << text(link.overlap) << " "
        << link.stop_reason << link.succeeded << linkOriginName(link.origin) << linkStateName(link.state);
    if (link.judgement)
      out << " " << verdictName(link.judgement->verdict) << " " << link.judgement->reason << " "
          << text(link.judgement->residual_m) << " " << text(link.judgement->moved.translation_m);
    if (link.information)
      for (int i = 0; i < 36; ++i) out << " " << text(link.information->data()[i]);
    out << "\n";
  }
  for (const JobRecord& job : snapshot.jobs())
    out << job.operation << " " << job.preset << " " << parametersToJson(job.values) << " "
        << jobStateName(job.state) << "\n";
  out << snapshot.survey().site;
  return out.str();
}

class WholeSessionTest : public WindowTest {
 protected:
  bool proposed() {
    const bool came = waitUntil([&] { return workspace().relaxation().isProposal(); });
    settle();
    return came;
  }
  bool shortcut(const char* keys) {
    press(QKeySequence(keys));
    return true;
  }
};

TEST_F(WholeSessionTest, MakesTheSameProjectAsTheCommandLine) {
  // The demo, from the start page.
  click("start:file.demo");
  ASSERT_TRUE(waitForJobs());
  ASSERT_EQ(snapshot().scans().size(), 14U);
  ASSERT_TRUE(snapshot().hasStage(Stage::Pairwise));

  // The filter compared: raw beside what the median changed.
  ASSERT_TRUE(trigger("perspective.inspect"));
  auto* depth = qobject_cast<DepthImagePanel*>(window->docks().panel("depth-image"));
  ASSERT_NE(depth, nullptr);
  window->showPanel("depth-image");
  workspace().selection().setCurrentScan(id(3));
  settle();
  click("depth-two");
  auto* quantity = find<QComboBox>("depth-quantity-1");
  quantity->setFocus();
  quantity->setCurrentIndex(quantity->findData("changed"));
  settle();
  ASSERT_NE(depth->view(1).image(), nullptr);
  EXPECT_EQ(depth->view(1).image()->quantity, DepthQuantity::Changed);
  const std::string looked = timeless(snapshot());

  // A pair by steps: forward, back, forward, to the end; accepted, undone and done again.
  press(QKeySequence("Ctrl+Shift+I"));
  ASSERT_EQ(window->perspective(), Perspective::Register);
  StepperModel& stepper = workspace().stepper();
  stepper.setPace(0);
  auto* moving = find<QComboBox>("stepper-moving");
  moving->setFocus();
  QTest::keyClick(moving, Qt::Key_Down);
  ASSERT_EQ(stepper.fixed(), id(0));
  ASSERT_EQ(stepper.moving(), id(2)) << "two stops that the demo has no link between";
  for (int k = 1; k <= 3; ++k) {
    press(QKeySequence(Qt::Key_F8));
    ASSERT_TRUE(waitUntil([&] { return stepper.position() == k; }));
  }
  const QString third = find<QLabel>("stepper-rms")->text();
  press(QKeySequence("Shift+F8"));
  EXPECT_EQ(stepper.position(), 2);
  EXPECT_NE(find<QLabel>("stepper-rms")->text(), third);
  click("stepper-step");
  EXPECT_EQ(find<QLabel>("stepper-rms")->text(), third) << "as it was";
  click("stepper-back");
  click("stepper-back");
  press(QKeySequence(Qt::Key_F9));
  ASSERT_TRUE(waitUntil([&] { return stepper.isEnded(); }));
  settle();
  EXPECT_TRUE(find<QLabel>("stepper-state")->text().startsWith("Ended after"));
  EXPECT_EQ(timeless(snapshot()), looked) << "nothing is stored before Accept";
  click("stepper-accept");
  ASSERT_EQ(snapshot().links().size(), 14U);
  const std::string stepped = timeless(snapshot());
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(timeless(snapshot()), looked);
  press(QKeySequence("Ctrl+Shift+Z"));
  EXPECT_EQ(timeless(snapshot()), stepped);

  // Relaxed, paused on the way, looked at before and after, discarded once.
  ASSERT_TRUE(trigger("perspective.relax"));
  // Scan by scan, which takes its time; then all at once, as the command does.
  find<QComboBox>("relax-preset")->setCurrentText("thesis");
  // Held in its second step, however busy the machine is.
  workspace().relaxation().holdNextAt(2);
  QTest::mouseClick(find("relax-run"), Qt::LeftButton);
  workspace().relaxation().holdNextAt(0);
  ASSERT_TRUE(waitUntil([&] { return workspace().relaxation().isHolding(); }))
      << find<QLabel>("relax-state")->text().toStdString() << "; "
      << find<QLabel>("relax-doing")->text().toStdString();
  EXPECT_EQ(timeless(snapshot()), stepped);
  settle();
  click("relax-step");
  QTest::mouseClick(find("relax-pause"), Qt::LeftButton);
  workspace().jobs().cancelAll();
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(timeless(snapshot()), stepped) << "cancelled without a trace";
  find<QComboBox>("relax-preset")->setCurrentText("default");
  click("relax-run");
  ASSERT_TRUE(proposed());
  click("relax-before");
  click("relax-wipe");
  click("relax-blink");
  click("relax-discard");
  EXPECT_EQ(timeless(snapshot()), stepped) << "discarded without a trace";
  click("relax-run");
  ASSERT_TRUE(proposed());
  click("relax-accept");
  ASSERT_TRUE(snapshot().hasStage(Stage::Relaxed));
  const std::string relaxed = timeless(snapshot());

  // Undo and redo by keyboard, to the last bit.
  shortcut("Ctrl+Z");
  EXPECT_EQ(timeless(snapshot()), stepped);
  shortcut("Ctrl+Shift+Z");
  EXPECT_EQ(timeless(snapshot()), relaxed);

  // A link disabled and enabled again leaves no difference either.
  window->showPanel("links");
  auto* links = qobject_cast<LinksPanel*>(window->docks().panel("links"));
  ASSERT_NE(links, nullptr);
  const LinkId first = snapshot().links().front().id;
  clickIndex(links->view(), links->indexOf(first));
  click("links-state");
  EXPECT_EQ(snapshot().findLink(first)->state, LinkState::Disabled);
  click("links-state");

  // Exported by the form.
  shortcut("Ctrl+E");
  auto* dialog = window->operationDialog("export");
  ASSERT_NE(dialog, nullptr);
  dialog->setValues({{"file", (folder / "window.ply").string()}});
  settle();
  QTest::mouseClick(find<QPushButton>("run", dialog), Qt::LeftButton);
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(timeless(snapshot()), relaxed);

  // The command line, from nothing.
  const auto run = [&](const std::vector<std::string>& words) {
    const ProgramRun done = tiltmap(words, folder.path());
    ASSERT_EQ(done.exit_code, 0) << done.err;
  };
  run({"new", "cli.tiltmap"});
  run({"survey", "cli.tiltmap", "--site", "Tiltmap demo"});
  run({"simulate", "cli.tiltmap", "--experiment", "exp2fixed", "--seed", "1"});
  run({"register", "cli.tiltmap"});
  run({"register", "cli.tiltmap", "--pairs", "0:2"});
  run({"relax", "cli.tiltmap"});
  run({"export", "cli.tiltmap", "cli.ply"});
  const auto cli = must(Project::open(folder / "cli.tiltmap", Access::ReadOnly));
  EXPECT_EQ(timeless(*cli->snapshot()), relaxed);
  EXPECT_EQ(fileText(folder / "cli.ply"), fileText(folder / "window.ply"));
  EXPECT_FALSE(fileText(folder / "cli.ply").empty());
}

}  // namespace
}  // namespace tiltmap::test
