// Fusion with frames that can be seen on a dark ground: its own are always darker than the window.
#pragma once

#include <QProxyStyle>

namespace tiltmap::ui {

class Style : public QProxyStyle {
  Q_OBJECT

 public:
  // Large: controls that a gloved finger hits.
  explicit Style(bool large = false);

  void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                     const QWidget* widget) const override;
  int pixelMetric(PixelMetric metric, const QStyleOption* option, const QWidget* widget) const override;
  QSize sizeFromContents(ContentsType type, const QStyleOption* option, const QSize& contents,
                         const QWidget* widget) const override;
  int styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget,
                QStyleHintReturn* result) const override;

 private:
  bool large_;
};

}  // namespace tiltmap::ui
