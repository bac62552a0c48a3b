// Forms made from parameter descriptions, filled in by keyboard and mouse.
#include "ui/window/operation_dialog.h"

#include <QCheckBox>
#include <QComboBox>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QPushButton>

#include "tests/ui/support/window_fixture.h"
#include "ui/models/parameter_model.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::test {

using namespace ui;

class OperationDialogTest : public WindowTest {
 protected:
  OperationDialog* open(const QString& operation) {
    EXPECT_TRUE(trigger("op." + operation));
    OperationDialog* dialog = window->operationDialog(operation);
    EXPECT_NE(dialog, nullptr);
    EXPECT_FALSE(dialog->isModal());
    return dialog;
  }
  void type(OperationDialog* dialog, const QString& parameter, const QString& text) {
    auto* field = qobject_cast<QLineEdit*>(dialog->form().editor(parameter));
    ASSERT_NE(field, nullptr) << parameter.toStdString();
    field->setFocus();
    field->selectAll();
    QTest::keyClick(field, Qt::Key_Backspace);
    QTest::keyClicks(field, text);
    settle();
  }
};

TEST_F(OperationDialogTest, EveryFieldHasANameATipAndItsUnit) {
  makeProject(1);
  for (const Operation* operation : operations().all()) {
    window->showOperation(qt(operation->id()));
    OperationDialog* dialog = window->operationDialog(qt(operation->id()));
    ASSERT_NE(dialog, nullptr) << operation->id();
    for (const ParameterInfo& info : operation->parameters()) {
      const QWidget* field = dialog->form().editor(qt(info.name));
      ASSERT_NE(field, nullptr) << operation->id() << " " << info.name;
      EXPECT_FALSE(field->accessibleName().isEmpty());
      EXPECT_TRUE(field->toolTip().contains("--" + qt(info.name)));
      if (!info.unit.empty()) {
        EXPECT_TRUE(field->accessibleName().endsWith(qt(info.unit)));
      }
    }
    dialog->close();
    settle();
  }
}

TEST_F(OperationDialogTest, SimulatesAndRegistersFromTheForms) {
  makeProject(0);
  OperationDialog* simulate = open("simulate");
  simulate->setValues({{"experiment", std::string("exp1")}});
  click("run", simulate);
  ASSERT_TRUE(waitForJobs());
  ASSERT_GT(snapshot().scans().size(), 1U);
  EXPECT_FALSE(snapshot().hasStage(Stage::Pairwise));
  OperationDialog* registering = open("register");
  type(registering, "pairs", "0:1");
  click("run", registering);
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().links().size(), 1U);
  EXPECT_TRUE(snapshot().hasStage(Stage::Pairwise));
  EXPECT_EQ(preferences.lastParameters("register").values.size(), 1U);
  EXPECT_EQ(open("register")->model().valueText("pairs"), "0:1") << "last used";
}

TEST_F(OperationDialogTest, SaysWhatIsWrongWhereItIs) {
  makeProject(2);
  OperationDialog* dialog = open("register");
  auto* run = find<QPushButton>("run", dialog);
  EXPECT_TRUE(run->isEnabled());
  type(dialog, "threads", "x");
  EXPECT_FALSE(run->isEnabled());
  auto* error = find<QLabel>("error:threads", dialog);
  EXPECT_TRUE(error->isVisible());
  EXPECT_TRUE(error->text().contains("whole number"));
  click("reset:threads", dialog);
  EXPECT_TRUE(run->isEnabled());
  EXPECT_FALSE(error->isVisible());
  type(dialog, "pairs", "0:7");
  EXPECT_FALSE(run->isEnabled());
  EXPECT_TRUE(find<QLabel>("check", dialog)->isVisible());
}

TEST_F(OperationDialogTest, PresetsSetEveryValueAndTheFilterFindsOne) {
  makeProject(2);
  OperationDialog* dialog = open("register");
  auto* preset = find<QComboBox>("preset", dialog);
  preset->setFocus();
  QTest::keyClicks(preset, "thesis");
  settle();
  EXPECT_EQ(dialog->model().preset(), "thesis");
  EXPECT_EQ(dialog->model().changedCount(), 0);
  auto* filter = find<QLineEdit>("parameter-filter", dialog);
  QTest::keyClicks(filter, "max-angle");
  settle();
  EXPECT_TRUE(dialog->form().editor("max-angle")->isVisible());
  EXPECT_FALSE(dialog->form().editor("threads")->isVisible());
}

TEST_F(OperationDialogTest, ExportsAFile) {
  makeProject(2);
  OperationDialog* dialog = open("export");
  EXPECT_FALSE(find<QPushButton>("run", dialog)->isEnabled()) << "no file is named yet";
  type(dialog, "file", qt(folder / "map.xyz"));
  click("run", dialog);
  ASSERT_TRUE(waitForJobs());
  EXPECT_GT(std::filesystem::file_size(folder / "map.xyz"), 100U);
}

TEST_F(OperationDialogTest, ImportsWhatWasExported) {
  makeProject(1);
  OperationDialog* writing = open("export");
  type(writing, "file", qt(folder / "scan.ptx"));
  click("run", writing);
  ASSERT_TRUE(waitForJobs());
  OperationDialog* reading = open("import");
  auto* files = qobject_cast<QPlainTextEdit*>(reading->form().editor("files"));
  ASSERT_NE(files, nullptr);
  files->setFocus();
  QTest::keyClicks(files, qt(folder / "scan.ptx"));
  settle();
  click("run", reading);
  ASSERT_TRUE(waitForJobs());
  EXPECT_EQ(snapshot().scans().size(), 2U);
  press(QKeySequence("Ctrl+Z"));
  EXPECT_EQ(snapshot().scans().size(), 1U);
}

}  // namespace tiltmap::test
