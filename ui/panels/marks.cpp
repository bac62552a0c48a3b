#include "ui/panels/marks.h"

#include <QPainter>
#include <QPixmap>
#include <QToolButton>

#include "ui/look/icons.h"

namespace tiltmap::ui {

namespace {

constexpr int kIcon_px = 16;

QPixmap emptyPixmap(int width, qreal ratio) {
  QPixmap pixmap(QSize(width, kIcon_px) * ratio);
  pixmap.setDevicePixelRatio(ratio);
  pixmap.fill(Qt::transparent);
  return pixmap;
}

}  // namespace

QPen qualityPen(LinkQuality quality, const ThemeColours& colours) {
  QPen pen;
  pen.setCapStyle(Qt::FlatCap);
  switch (quality) {
    case LinkQuality::Good:
      pen.setColor(colours.good);
      pen.setWidthF(1.5);
      break;
    case LinkQuality::Doubtful:
      pen.setColor(colours.warning);
      pen.setWidthF(2.0);
      pen.setDashPattern({5.0, 1.5});
      break;
    case LinkQuality::Bad:
      pen.setColor(colours.error);
      pen.setWidthF(2.5);
      pen.setDashPattern({2.5, 2.0});
      break;
    case LinkQuality::NotJudged:
      pen.setColor(colours.muted);
      pen.setWidthF(1.5);
      break;
    case LinkQuality::Failed:
      pen.setColor(colours.error);
      pen.setWidthF(1.5);
      pen.setDashPattern({1.0, 2.5});
      break;
    case LinkQuality::Disabled:
      pen.setColor(colours.muted);
      pen.setWidthF(1.0);
      pen.setDashPattern({1.0, 4.0});
      break;
  }
  return pen;
}

QIcon qualityIcon(LinkQuality quality, const ThemeColours& colours, qreal ratio) {
  QPixmap pixmap = emptyPixmap(kIcon_px, ratio);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(qualityPen(quality, colours));
  painter.drawLine(QPointF(1, 8), QPointF(15, 8));
  return pixmap;
}

QColor roleColour(RelaxationRole role, const ThemeColours& colours) {
  switch (role) {
    case RelaxationRole::Aligning:
      return colours.warning;
    case RelaxationRole::Queued:
      return colours.accent;
    case RelaxationRole::Active:
      return colours.good;
    case RelaxationRole::Held:
    case RelaxationRole::Waiting:
    case RelaxationRole::None:
      break;
  }
  return colours.muted;
}

void drawStop(QPainter& painter, const QPointF& at, double radius, RelaxationRole role, const QColor& fill,
              const ThemeColours& colours) {
  const QColor ring = role == RelaxationRole::None ? fill.darker(140) : roleColour(role, colours);
  painter.setPen(QPen(ring, 1.5));
  painter.setBrush(role == RelaxationRole::Waiting ? QBrush(Qt::NoBrush) : QBrush(fill));
  if (role == RelaxationRole::Held)
    painter.drawRect(QRectF(at.x() - radius, at.y() - radius, 2 * radius, 2 * radius));
  else
    painter.drawEllipse(at, radius, radius);
  painter.setBrush(Qt::NoBrush);
  if (role == RelaxationRole::Queued || role == RelaxationRole::Aligning) {
    painter.setPen(QPen(ring, 2.0));
    painter.drawEllipse(at, radius + 3, radius + 3);
  }
  if (role == RelaxationRole::Aligning) painter.drawEllipse(at, radius + 7, radius + 7);
}

QIcon roleIcon(RelaxationRole role, const ThemeColours& colours, qreal ratio) {
  if (role == RelaxationRole::None) return {};
  QPixmap pixmap = emptyPixmap(kIcon_px, ratio);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  // Small enough for both rings.
  painter.translate(8, 8);
  painter.scale(0.65, 0.65);
  drawStop(painter, {}, 4.5, role, roleColour(role, colours), colours);
  return pixmap;
}

QToolButton* barButton(const QString& object_name, const QString& icon_name, const QString& text,
                       const QString& help, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setObjectName(object_name);
  button->setText(text);
  button->setToolTip(help);
  button->setAccessibleName(QString(text).remove("…"));
  button->setAccessibleDescription(help);
  button->setAutoRaise(true);
  button->setFocusPolicy(Qt::StrongFocus);
  if (icon_name.isEmpty()) return button;
  button->setIcon(icon(icon_name));
  button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  return button;
}

}  // namespace tiltmap::ui
