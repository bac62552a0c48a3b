#include "ui/look/style.h"

#include <QPainter>
#include <QStyleFactory>
#include <QStyleOption>
#include <algorithm>

namespace tiltmap::ui {

namespace {

constexpr int kLargeControl_px = 36;
constexpr int kLargeRow_px = 30;

// Between the ground and the text; 42 % is about 3 : 1 to the ground, light or dark.
QColor frameColour(const QPalette& palette, int percent = 42) {
  const QColor a = palette.color(QPalette::Base), b = palette.color(QPalette::Text);
  const auto between = [percent](int from, int to) { return (from * (100 - percent) + to * percent) / 100; };
  return {between(a.red(), b.red()), between(a.green(), b.green()), between(a.blue(), b.blue())};
}

void drawFrame(const QStyleOption& option, QPainter& painter) {
  const bool focus = option.state & QStyle::State_HasFocus;
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(focus ? option.palette.color(QPalette::Link) : frameColour(option.palette, 25),
                      focus ? 1.5 : 1.0));
  painter.drawRoundedRect(QRectF(option.rect).adjusted(0.5, 0.5, -0.5, -0.5), 2.0, 2.0);
  painter.restore();
}

void drawCheck(const QStyleOption& option, QPainter& painter) {
  const bool on = option.state & QStyle::State_On, part = option.state & QStyle::State_NoChange;
  const bool enabled = option.state & QStyle::State_Enabled;
  const bool focus = option.state & QStyle::State_HasFocus;
  const QRectF box = QRectF(option.rect).adjusted(0.5, 0.5, -0.5, -0.5);
  const QPalette& p = option.palette;
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setBrush((on || part) && enabled ? p.color(QPalette::Highlight) : p.color(QPalette::Base));
  painter.setPen(focus ? p.color(QPalette::Link) : frameColour(p));
  painter.drawRoundedRect(box, 2.5, 2.5);
  const double w = box.width(), h = box.height();
  const QColor mark =
      enabled ? p.color(QPalette::HighlightedText) : p.color(QPalette::Disabled, QPalette::Text);
  painter.setPen(QPen(mark, w * 0.14, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  painter.setBrush(Qt::NoBrush);
  const auto at = [&](double x, double y) { return box.topLeft() + QPointF(x * w, y * h); };
  if (on) painter.drawPolyline(QPolygonF({at(0.24, 0.54), at(0.42, 0.72), at(0.77, 0.30)}));
  if (part) painter.drawLine(at(0.26, 0.5), at(0.74, 0.5));
  painter.restore();
}

}  // namespace

Style::Style(bool large) : QProxyStyle(QStyleFactory::create("Fusion")), large_(large) {}

int Style::pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const {
  const int usual = QProxyStyle::pixelMetric(metric, option, widget);
  if (!large_) return usual;
  switch (metric) {
    case PM_IndicatorWidth:
    case PM_IndicatorHeight:
    case PM_ExclusiveIndicatorWidth:
    case PM_ExclusiveIndicatorHeight:
    case PM_ScrollBarExtent:
    case PM_SmallIconSize:
    case PM_ButtonIconSize:
      return std::max(usual, 22);
    case PM_SplitterWidth:
      return std::max(usual, 8);
    default:
      return usual;
  }
}

QSize Style::sizeFromContents(ContentsType type, const QStyleOption* option, const QSize& contents,
                              const QWidget* widget) const {
  QSize size = QProxyStyle::sizeFromContents(type, option, contents, widget);
  if (!large_) return size;
  switch (type) {
    case CT_PushButton:
    case CT_ToolButton:
    case CT_ComboBox:
    case CT_LineEdit:
    case CT_SpinBox:
      size.setHeight(std::max(size.height(), kLargeControl_px));
      break;
    case CT_MenuItem:
    case CT_ItemViewItem:
      size.setHeight(std::max(size.height(), kLargeRow_px));
      break;
    case CT_MenuBarItem:
      size.setHeight(std::max(size.height(), kLargeRow_px));
      break;
    default:
      break;
  }
  return size;
}

void Style::drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                          const QWidget* widget) const {
  if (element == PE_IndicatorCheckBox || element == PE_IndicatorItemViewItemCheck)
    return drawCheck(*option, *painter);
  QProxyStyle::drawPrimitive(element, option, painter, widget);
  if (element == PE_FrameLineEdit) drawFrame(*option, *painter);
}

int Style::styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget,
                     QStyleHintReturn* result) const {
  if (hint == SH_DialogButtonBox_ButtonsHaveIcons || hint == SH_EtchDisabledText) return 0;
  return QProxyStyle::styleHint(hint, option, widget, result);
}

}  // namespace tiltmap::ui
