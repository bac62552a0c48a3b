// The form that tells where a new stop is, driven by mouse and keyboard.
#pragma once

#include <QApplication>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QTest>
#include <QToolButton>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "ui/look/theme.h"
#include "ui/models/strings.h"
#include "ui/panels/odometry_form.h"

namespace tiltmap::test {

class OdometryFormTest : public ::testing::Test {
 protected:
  OdometryFormTest() : preferences(ui::qt(folder / "settings.ini")), theme(preferences) {
    preferences.setTheme(ui::ThemeChoice::Light);
    form = std::make_unique<ui::OdometryForm>(theme, preferences);
    show();
  }
  void show() {
    form->resize(340, 560);
    form->show();
    QApplication::setActiveWindow(form.get());
    (void)QTest::qWaitForWindowExposed(form.get());
    QCoreApplication::processEvents();
  }
  template <class Widget = QWidget>
  Widget* find(const QString& name) {
    auto* found = form->findChild<Widget*>(name);
    if (!found) throw std::logic_error("there is no " + name.toStdString());
    return found;
  }
  void click(const QString& name) {
    auto* button = find<QAbstractButton>(name);
    ASSERT_TRUE(button->isVisible()) << name.toStdString();
    ASSERT_TRUE(button->isEnabled()) << name.toStdString();
    QTest::mouseClick(button, Qt::LeftButton);
    QCoreApplication::processEvents();
  }
  void type(const QString& name, const QString& text) {
    auto* field = find<QLineEdit>(name);
    ASSERT_TRUE(field->isVisible() && field->isEnabled()) << name.toStdString();
    field->setFocus();
    QTest::keyClick(field, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClick(field, Qt::Key_Delete);
    QTest::keyClicks(field, text);
    QCoreApplication::processEvents();
  }
  void choose(const QString& name, int index) {
    auto* box = find<QComboBox>(name);
    ASSERT_TRUE(box->isVisible() && box->isEnabled());
    box->setFocus();
    QTest::keyClick(box, index > box->currentIndex() ? Qt::Key_Down : Qt::Key_Up);
    QCoreApplication::processEvents();
    ASSERT_EQ(box->currentIndex(), index);
  }
  QString sentence() { return find<QLabel>("odometry-sentence")->text(); }
  ::testing::AssertionResult tells(const Pose& step) {
    const auto told = form->lastFromNext();
    if (!told) return ::testing::AssertionFailure() << "no step: " << form->missing().toStdString();
    const PoseDifference off = difference(*told, step);
    if (off.translation_m < 1e-6 && off.rotation_rad < 1e-6) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "another step: " << form->sentence().toStdString();
  }
  ::testing::AssertionResult misses(const QString& what) {
    if (form->lastFromNext())
      return ::testing::AssertionFailure() << "a step: " << form->sentence().toStdString();
    if (form->missing().indexOf(what) < 0 || form->missing() != sentence())
      return ::testing::AssertionFailure()
             << form->missing().toStdString() << " / " << sentence().toStdString();
    return ::testing::AssertionSuccess();
  }

  TemporaryFolder folder;
  ui::Preferences preferences;
  ui::Theme theme;
  std::unique_ptr<ui::OdometryForm> form;
};

}  // namespace tiltmap::test
