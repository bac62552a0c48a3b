// What must hold for every control and every text of the window; used over all panels, forms and dialogs.
#pragma once

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QAccessible>
#include <QComboBox>
#include <QFileDialog>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QPlainTextEdit>
#include <QScrollBar>
#include <QStyle>
#include <QStyleOptionButton>
#include <QTabBar>
#include <QTextEdit>
#include <QToolButton>
#include <string>
#include <vector>

namespace tiltmap::test {

// Made by Qt or the docking system inside of something else.
inline bool isForeign(const QWidget& widget) {
  const std::string type = widget.metaObject()->className();
  const QString name = widget.objectName();
  if (type.starts_with("ads::") || name.startsWith("qt_") || type.starts_with("QComboBoxPrivate") ||
      type == "QComboBoxListView" || type == "QLineEditIconButton" || type == "QTableCornerButton" ||
      type == "QToolBarExtension")
    return true;
  for (const QWidget* parent = widget.parentWidget(); parent; parent = parent->parentWidget()) {
    const std::string above = parent->metaObject()->className();
    if (qobject_cast<const QTabBar*>(parent) || qobject_cast<const QComboBox*>(parent) ||
        qobject_cast<const QAbstractSpinBox*>(parent) || qobject_cast<const QFileDialog*>(parent) ||
        above == "ads::CDockAreaTitleBar" || above == "ads::CDockWidgetTab")
      return true;
    if (qobject_cast<const QAbstractItemView*>(parent) && !qobject_cast<const QAbstractItemView*>(&widget))
      return true;
  }
  return false;
}

inline bool isControl(const QWidget& widget) {
  if (qobject_cast<const QHeaderView*>(&widget) || qobject_cast<const QScrollBar*>(&widget) ||
      qobject_cast<const QTabBar*>(&widget))
    return false;
  return qobject_cast<const QAbstractButton*>(&widget) || qobject_cast<const QComboBox*>(&widget) ||
         qobject_cast<const QLineEdit*>(&widget) || qobject_cast<const QAbstractSpinBox*>(&widget) ||
         qobject_cast<const QAbstractItemView*>(&widget) || qobject_cast<const QPlainTextEdit*>(&widget) ||
         qobject_cast<const QTextEdit*>(&widget) || qobject_cast<const QAbstractSlider*>(&widget);
}

// For people: its type, name and where it is.
inline std::string placeOf(const QWidget& widget) {
  std::string place;
  for (const QWidget* at = &widget; at; at = at->parentWidget())
    if (at == &widget || !at->objectName().isEmpty())
      place += std::string(place.empty() ? "" : " in ") + at->metaObject()->className() + " \"" +
               at->objectName().toStdString() + "\"";
  if (const auto* button = qobject_cast<const QAbstractButton*>(&widget))
    place = "\"" + button->text().toStdString() + "\" " + place;
  return place;
}

inline std::vector<const QWidget*> controlsOf(const QWidget& root) {
  std::vector<const QWidget*> controls;
  for (const QWidget* widget : root.findChildren<QWidget*>())
    if (isControl(*widget) && !isForeign(*widget)) controls.push_back(widget);
  return controls;
}

inline std::string spokenName(const QWidget& widget) {
  QAccessibleInterface* spoken = QAccessible::queryAccessibleInterface(const_cast<QWidget*>(&widget));
  return spoken ? spoken->text(QAccessible::Name).toStdString() : std::string();
}

// Text that is cut off, of what can be seen under `root`. Widgets that give way by intention (size policy
// Ignored, word wrap) and tables that scroll are left out.
inline std::vector<std::string> cutOff(const QWidget& root) {
  std::vector<std::string> found;
  const auto tell = [&](const QWidget& widget, const std::string& what) {
    found.push_back(what + ": " + placeOf(widget));
  };
  for (const QWidget* widget : root.findChildren<QWidget*>()) {
    if (!widget->isVisibleTo(&root) || widget->visibleRegion().isEmpty()) continue;
    const std::string type = widget->metaObject()->className();
    if (const auto* label = qobject_cast<const QLabel*>(widget)) {
      if (label->text().isEmpty() || label->wordWrap() || type == "ads::CElidingLabel" ||
          label->sizePolicy().horizontalPolicy() == QSizePolicy::Ignored)
        continue;
      if (label->width() < label->minimumSizeHint().width() ||
          label->height() < label->minimumSizeHint().height())
        tell(*widget, "label \"" + label->text().toStdString() + "\"");
    } else if (const auto* button = qobject_cast<const QAbstractButton*>(widget);
               button && !button->text().isEmpty()) {
      if (isForeign(*widget)) continue;
      const auto* tool = qobject_cast<const QToolButton*>(button);
      if (tool && tool->toolButtonStyle() == Qt::ToolButtonIconOnly && !tool->icon().isNull()) continue;
      if (button->width() < button->minimumSizeHint().width() && button->width() < button->sizeHint().width())
        tell(*widget, "button");
    } else if (const auto* box = qobject_cast<const QComboBox*>(widget)) {
      if (box->fontMetrics().horizontalAdvance(box->currentText()) > box->width()) tell(*widget, "choice");
    } else if (const auto* header = qobject_cast<const QHeaderView*>(widget)) {
      if (header->orientation() != Qt::Horizontal || !header->model()) continue;
      for (int section = 0; section < header->count(); ++section) {
        const QString text = header->model()->headerData(section, Qt::Horizontal).toString();
        if (!header->isSectionHidden(section) &&
            header->fontMetrics().horizontalAdvance(text) > header->sectionSize(section))
          tell(*widget, "column \"" + text.toStdString() + "\"");
      }
    }
    // A control outside of what its parent shows.
    if (isControl(*widget) && !isForeign(*widget) && widget->parentWidget() &&
        !qobject_cast<const QAbstractItemView*>(widget->parentWidget())) {
      const QRect inside = widget->parentWidget()->rect();
      bool scrolled = false;
      for (const QWidget* at = widget->parentWidget(); at; at = at->parentWidget())
        scrolled |= at->inherits("QAbstractScrollArea");
      if (!scrolled && !inside.contains(widget->geometry())) tell(*widget, "outside of its place");
    }
  }
  return found;
}

}  // namespace tiltmap::test
