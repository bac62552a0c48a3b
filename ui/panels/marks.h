// How the quality of links and the sets of a relaxation look: the same in map, tables and legend, and never
// by colour alone.
#pragma once

#include <QIcon>
#include <QPen>

#include "core/project/link_quality.h"
#include "ui/look/theme.h"
#include "ui/models/scan_display.h"

class QPainter;
class QToolButton;
class QWidget;

namespace tiltmap::ui {

QPen qualityPen(LinkQuality quality, const ThemeColours& colours);
QIcon qualityIcon(LinkQuality quality, const ThemeColours& colours, qreal ratio);

QColor roleColour(RelaxationRole role, const ThemeColours& colours);
// A stop of that role: square where it never moves, hollow in the static set, ringed in the queue, with two
// rings while it is aligned. `fill`: the scan's own colour.
void drawStop(QPainter& painter, const QPointF& at, double radius, RelaxationRole role, const QColor& fill,
              const ThemeColours& colours);
QIcon roleIcon(RelaxationRole role, const ThemeColours& colours, qreal ratio);

// A button of a panel's bar, with everything that names it set.
QToolButton* barButton(const QString& object_name, const QString& icon_name, const QString& text,
                       const QString& help, QWidget* parent);

}  // namespace tiltmap::ui
