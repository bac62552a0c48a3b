// Every control of every panel, form and dialog: a tooltip, a name for those who cannot see, reached by
// keyboard; and no text cut off on a small screen.
#include <QRegularExpression>
#include <QSpinBox>

#include "tests/ui/support/widget_rules.h"
#include "tests/ui/support/window_fixture.h"
#include "ui/window/operation_dialog.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::test {

using namespace ui;

class EveryWidget : public WindowTest {
 protected:
  // Everything that has controls, open at once.
  void openAll() {
    makeProject(3, true);
    workspace().selection().setCurrentScan(id(1));
    for (const char* dialog :
         {"edit.preferences", "help.about", "help.shortcuts", "edit.colour", "edit.survey"})
      ASSERT_TRUE(trigger(dialog));
    for (const Operation* operation : operations().all()) window->showOperation(qt(operation->id()));
    for (const PanelInfo& panel : panels()) window->showPanel(panel.id);
    workspace().messages().error({"something broke", "here", "mend it"});
    settle();
  }
};

TEST_F(EveryWidget, HasATipANameAndIsReachedByKeyboard) {
  openAll();
  const auto controls = controlsOf(*window);
  EXPECT_GT(controls.size(), 150U);
  for (const QWidget* widget : controls) {
    const bool read_only_text = qobject_cast<const QTextEdit*>(widget);
    EXPECT_TRUE(read_only_text || !widget->toolTip().isEmpty()) << "no tooltip: " << placeOf(*widget);
    EXPECT_NE(spokenName(*widget), "") << "no accessible name: " << placeOf(*widget);
    const auto* list = qobject_cast<const QAbstractItemView*>(widget);
    const bool driven_by_its_line = list && list->objectName() == "palette-list";
    EXPECT_TRUE(driven_by_its_line || (widget->focusPolicy() & Qt::TabFocus))
        << "not reached by keyboard: " << placeOf(*widget);
  }
}

TEST_F(EveryWidget, NumbersSayTheirUnitOrRange) {
  openAll();
  for (const QWidget* widget : controlsOf(*window)) {
    if (!qobject_cast<const QAbstractSpinBox*>(widget)) continue;
    const QString tip = widget->toolTip() + " " + widget->accessibleName();
    EXPECT_TRUE(tip.contains(QRegularExpression("[0-9]|unit| px| m\\b|°|scale|range|colour bar")))
        << tip.toStdString() << " of " << placeOf(*widget);
  }
}

TEST_F(EveryWidget, TabGoesThroughAllOfADialogAndComesBack) {
  makeProject(2);
  ASSERT_TRUE(trigger("edit.survey"));
  auto* dialog = find("survey");
  dialog->activateWindow();
  QApplication::setActiveWindow(dialog);
  auto* site = find("survey-site", dialog);
  site->setFocus();
  std::vector<QString> visited;
  for (int step = 0; step < 12; ++step) {
    const QWidget* at = QApplication::focusWidget();
    ASSERT_NE(at, nullptr);
    if (!visited.empty() && at == site) break;
    visited.push_back(at->objectName());
    QTest::keyClick(QApplication::focusWidget(), Qt::Key_Tab);
  }
  ASSERT_GE(visited.size(), 5U);
  EXPECT_EQ(visited[1], "survey-operator");
  EXPECT_EQ(visited[2], "survey-device");
  EXPECT_EQ(visited[3], "survey-date");
  EXPECT_EQ(QApplication::focusWidget(), site) << "and round again";
}

TEST_F(EveryWidget, TabGoesDownAFormAndEndsAtItsButton) {
  makeProject(2);
  ASSERT_TRUE(trigger("op.register"));
  OperationDialog* dialog = window->operationDialog("register");
  dialog->activateWindow();
  QApplication::setActiveWindow(dialog);
  find("preset", dialog)->setFocus();
  int lowest = -1;
  QStringList visited;
  for (int step = 0; step < 100; ++step) {
    QTest::keyClick(QApplication::focusWidget(), Qt::Key_Tab);
    const QWidget* at = QApplication::focusWidget();
    visited << at->objectName();
    if (at->objectName() == "run") break;
    if (!at->objectName().startsWith("field:")) continue;
    const int inside = at->mapTo(&dialog->form(), QPoint()).y();
    EXPECT_GT(inside, lowest) << at->objectName().toStdString();
    lowest = inside;
  }
  EXPECT_EQ(visited.first(), "parameter-filter");
  EXPECT_EQ(visited.last(), "run");
  EXPECT_GT(visited.filter("field:").size(), 10);
}

TEST(CutOff, IsFound) {
  QWidget root;
  root.resize(600, 200);
  auto* label = new QLabel("a text that is far longer than its label", &root);
  auto* button = new QToolButton(&root);
  button->setText("a text that is far longer than its button");
  auto* outside = new QLineEdit(&root);
  label->setGeometry(0, 0, 40, 20);
  button->setGeometry(0, 30, 40, 20);
  outside->setGeometry(550, 60, 100, 20);
  root.show();
  EXPECT_EQ(cutOff(root).size(), 3U);
  label->resize(label->sizeHint());
  button->resize(button->sizeHint());
  outside->setGeometry(0, 60, 100, 20);
  EXPECT_TRUE(cutOff(root).empty()) << cutOff(root).front();
}

class SmallScreen : public WindowTest, public ::testing::WithParamInterface<QSize> {};

TEST_P(SmallScreen, NothingIsCutOffInAnyPerspective) {
  makeProject(14, true);
  workspace().selection().setCurrentScan(id(1));
  for (const Perspective perspective : kPerspectives) {
    window->setPerspective(perspective);
    window->resize(GetParam());
    settle();
    SCOPED_TRACE(perspectiveName(perspective).toStdString());
    EXPECT_EQ(window->size(), GetParam());
    EXPECT_LE(window->minimumSizeHint().width(), GetParam().width());
    EXPECT_LE(window->minimumSizeHint().height(), GetParam().height());
    for (const std::string& text : cutOff(*window)) ADD_FAILURE() << "cut off: " << text;
  }
}

TEST_P(SmallScreen, DialogsFitAndShowAllTheirText) {
  makeProject(3, true);
  workspace().selection().setCurrentScan(id(1));
  for (const char* dialog :
       {"edit.preferences", "help.about", "help.shortcuts", "edit.colour", "edit.survey"})
    ASSERT_TRUE(trigger(dialog));
  for (const Operation* operation : operations().all()) window->showOperation(qt(operation->id()));
  settle();
  int dialogs = 0;
  for (const QDialog* dialog : window->findChildren<QDialog*>()) {
    if (!dialog->isVisible()) continue;
    ++dialogs;
    SCOPED_TRACE(dialog->objectName().toStdString());
    EXPECT_LE(dialog->width(), GetParam().width());
    EXPECT_LE(dialog->height(), GetParam().height() - 40);
    for (const std::string& text : cutOff(*dialog)) ADD_FAILURE() << "cut off: " << text;
  }
  EXPECT_GE(dialogs, 11);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SmallScreen, ::testing::Values(QSize(1366, 768), QSize(1280, 720)),
                         [](const auto& size) {
                           return std::to_string(size.param.width()) + "x" +
                                  std::to_string(size.param.height());
                         });

TEST_F(EveryWidget, LargeControlsOfTheHighContrastThemeFitTheCapturePerspective) {
  preferences.setTheme(ThemeChoice::HighContrast);
  makeProject(3);
  window->setPerspective(Perspective::Capture);
  window->resize(1366, 768);
  settle();
  EXPECT_LE(window->minimumSizeHint().width(), 1366);
  EXPECT_LE(window->minimumSizeHint().height(), 768);
  for (const std::string& text : cutOff(*window)) ADD_FAILURE() << "cut off: " << text;
  int buttons = 0;
  for (const auto* button : window->findChildren<QToolButton*>())
    if (button->isVisible() && !isForeign(*button) && button->objectName() != "message-close") {
      EXPECT_GE(button->height(), 30) << placeOf(*button);
      ++buttons;
    }
  EXPECT_GT(buttons, 8);
  preferences.setTheme(ThemeChoice::Light);
  settle();
}

}  // namespace tiltmap::test
