// Words of another colour than the look's.
#pragma once

#include <QColor>
#include <QLabel>

namespace tiltmap::ui {

// An invalid colour: that of the look again. By a style sheet, because where one stands above (the docks have
// one) a widget's own palette is forgotten when the look changes. The selector leaves the tooltip as it is.
inline void setTextColour(QLabel* label, const QColor& colour) {
  const QString sheet =
      colour.isValid()
          ? QString("*[objectName=\"%1\"] { color: %2; }").arg(label->objectName(), colour.name())
          : QString();
  if (label->styleSheet() != sheet) label->setStyleSheet(sheet);
}

}  // namespace tiltmap::ui
